# SPDX-License-Identifier: Apache-2.0
"""A world of many users and objects on several servers, in virtual time: who walks where, what moves, what is sent to each user, which server
owns it, and what that costs by the unit costs of world_costs. One step is 200 ms, the time in which an encoder looks at all objects anew."""
import dataclasses

import numpy

from studies.world_costs import HYSTERESIS, LODS, OUT, level_limits, levels_at

STEP, TICKS = 0.2, 200  # [s], in ticks of 1 ms
WALK = 1.4  # [m/s]
WARM_UP = 5.0  # [s] before anything counts
UNEVEN_STEPS = 5  # in a row, before regions are split anew
PARTS = ("physics", "truth", "sessions", "looks", "tells", "packets")  # of a tick of a server


@dataclasses.dataclass(frozen=True)
class Setting:
    objects: int = 100_000
    users: int = 1000
    servers: int = 8
    seed: int = 1
    side: float = 400      # [m]
    full: float = 2        # [m] interest
    reach: float = 16      # [m]
    seconds: float = 10
    hot_spots: int = 20    # where 80 % of users and half of the objects are, 12 m around each
    stirred: int = 8       # objects within 1 m that a user keeps moving, at most
    restless: float = 0.005  # fraction of objects that move without a user
    margin: float = 1      # [m] beyond a border before what crosses it changes its owner
    uneven: float = 1.3    # regions are split anew when the fullest server has so many times the mean load


class Regions:
    """Boxes that fill the world, one for each server, of about the same cost: k-d split."""

    def __init__(self, setting, positions, weights):
        self.low = numpy.zeros((setting.servers, 2))
        self.high = numpy.full((setting.servers, 2), float(setting.side))
        self._split(positions, weights, 0, setting.servers)

    def _split(self, positions, weights, first, count):
        if count == 1:
            return
        left = count // 2
        extent = self.high[first] - self.low[first]
        axis = int(extent[1] > extent[0])
        order = numpy.argsort(positions[:, axis], kind="stable")
        sums = numpy.cumsum(weights[order])
        cut = self.low[first, axis] + extent[axis] / 2
        if len(sums) and sums[-1] > 0:
            at = min(int(numpy.searchsorted(sums, sums[-1] * left / count, "right")), len(order) - 1)
            cut = positions[order[at], axis]
        self.high[first:first + left, axis] = cut
        self.low[first + left:first + count, axis] = cut
        below = positions[:, axis] < cut
        self._split(positions[below], weights[below], first, left)
        self._split(positions[~below], weights[~below], first + left, count - left)

    def distance(self, positions, server):
        """[m] from each position to a server's region, 0 inside."""
        outside = numpy.maximum(self.low[server] - positions, positions - self.high[server])
        return numpy.hypot(*numpy.maximum(outside, 0).T)

    def of(self, positions):
        out = numpy.zeros(len(positions), numpy.int16)
        for server in range(len(self.low)):
            out[numpy.all((positions >= self.low[server]) & (positions < self.high[server]), axis=1)] = server
        return out

    def owners(self, positions, before, margin):
        """Who owned it before goes on until it is farther than the margin from the region."""
        departed = self.distance(positions, before) > margin
        out = before.copy()
        out[departed] = self.of(positions[departed])
        return out


class World:
    def __init__(self, setting, costs):
        self.setting, self.costs = setting, costs
        self.random = numpy.random.default_rng(setting.seed)
        self.spots = self.random.uniform(0, setting.side, (setting.hot_spots, 2))
        self.objects = self._sites(setting.objects, 0.5)
        self.users = self._sites(setting.users, 0.8)
        self.goals, self.waits = self.users.copy(), self.random.exponential(5, setting.users)
        self.spot_of = numpy.argmin(numpy.hypot(*(self.users[:, None] - self.spots[None]).transpose(2, 0, 1)), axis=1)
        self.carried = numpy.full(setting.users, -1)
        self.awake_until = numpy.zeros(setting.objects)
        self.awake_until[self.random.permutation(setting.objects)[:round(setting.restless * setting.objects)]] = numpy.inf
        self.holder = numpy.full(setting.objects, -1)
        self.levels = numpy.full(setting.users * setting.objects, OUT, numpy.int8)
        self.limits = level_limits(setting.full, setting.reach)
        self.now = 0.0
        self.regions = Regions(setting, self.users, numpy.ones(setting.users))
        self.owner, self.server = self.regions.of(self.objects), self.regions.of(self.users)

    def _sites(self, count, fraction):
        """Of `fraction` of them around hot spots, else anywhere."""
        side = self.setting.side
        out = self.random.uniform(0, side, (count, 2))
        near = self.random.uniform(size=count) < fraction
        out[near] = self.spots[self.random.integers(len(self.spots), size=near.sum())] + self.random.normal(0, 12, (near.sum(), 2))
        return numpy.clip(out, 0, side * (1 - 1e-9))

    def _walk(self):
        """To a goal, there for 5 s on average, then on: 70 % near the same spot, 20 % to another, 10 % anywhere.   out  who leaves"""
        far = self.goals - self.users
        distance = numpy.hypot(*far.T)
        walking = distance > 1e-6
        step = numpy.minimum(1, WALK * STEP / numpy.maximum(distance, 1e-9))
        self.users = self.users + far * step[:, None]
        self.waits[~walking] -= STEP
        leaves = ~walking & (self.waits <= 0)
        count = int(leaves.sum())
        kind = self.random.uniform(size=count)
        spots = numpy.where(kind < 0.7, self.spot_of[leaves], self.random.integers(len(self.spots), size=count))
        goals = self.spots[spots] + self.random.normal(0, 12, (count, 2))
        goals[kind >= 0.9] = self.random.uniform(0, self.setting.side, (int((kind >= 0.9).sum()), 2))
        self.goals[leaves] = numpy.clip(goals, 0, self.setting.side * (1 - 1e-9))
        self.spot_of[leaves], self.waits[leaves] = spots, self.random.exponential(5, count)
        self.carried[~walking & ~leaves] = -1
        return leaves

    def _pairs(self):
        """(user, object, distance) of all that may be in interest, ordered by user."""
        radius = HYSTERESIS * self.setting.reach + 1  # what was in interest has not gone farther since
        cell = radius / 4
        size = int(self.setting.side / cell) + 1
        cells = (self.objects / cell).astype(numpy.int64)
        cells = cells[:, 1] * size + cells[:, 0]
        order = numpy.argsort(cells, kind="stable")
        begins = numpy.searchsorted(cells[order], numpy.arange(size * size + 1))
        low, high = (numpy.clip(((self.users + side) / cell).astype(numpy.int64), 0, size - 1) for side in (-radius, radius))
        rows = low[:, 1:] + numpy.arange(10)  # of cells: a circle touches nine or ten
        user, _ = within = numpy.nonzero(rows <= high[:, 1:])
        rows = rows[within] * size
        first = begins[rows + low[user, 0]]
        counts = begins[rows + high[user, 0] + 1] - first
        users = numpy.repeat(user.astype(numpy.int32), counts)
        at = numpy.arange(len(users)) + numpy.repeat(first - numpy.cumsum(counts) + counts, counts)
        x, y = self.objects[order].T
        squares = (x[at] - self.users[users, 0]) ** 2 + (y[at] - self.users[users, 1]) ** 2
        near = squares < radius * radius
        return users[near], order[at[near]], numpy.sqrt(squares[near])

    def _stir(self, users, objects, distances, leaves):
        """Objects at a user's hand move, until a second later on average; one in ten who leave take one with them."""
        near = distances < 1
        users, objects = users[near], objects[near]
        rank = numpy.arange(len(users)) - numpy.searchsorted(users, users)
        chosen = rank < self.setting.stirred
        self.holder[objects[chosen]] = users[chosen]
        until = self.now + self.random.exponential(1, int(chosen.sum()))
        self.awake_until[objects[chosen]] = numpy.maximum(self.awake_until[objects[chosen]], until)
        takes = (rank == 0) & leaves[users] & (self.random.uniform(size=len(users)) < 0.1)
        self.carried[users[takes]] = objects[takes]
        carriers = numpy.nonzero(self.carried >= 0)[0]
        self.objects[self.carried[carriers]] = self.users[carriers]
        self.awake_until[self.carried[carriers]] = numpy.maximum(self.awake_until[self.carried[carriers]], self.now + 1)
        self.holder[self.carried[carriers]] = carriers

    def _move(self):
        """out  which objects move"""
        moving = numpy.nonzero(self.awake_until > self.now)[0]
        moved = self.objects[moving] + self.random.normal(0, 0.03, (len(moving), 2))
        self.objects[moving] = numpy.clip(moved, 0, self.setting.side * (1 - 1e-9))
        return moving

    def _look(self, users, objects, distances):
        """out  levels of detail of the pairs, and whether they have changed"""
        at = users.astype(numpy.int64) * self.setting.objects + objects
        before = self.levels.take(at)
        now = levels_at(self.limits, distances, before)
        changed = now != before
        self.levels[at[changed]] = now[changed]
        return now, changed

    def _own(self, moving):
        """Users and objects by region and margin; what a user holds belongs to its server.   out  hand-overs of users, of objects"""
        server = self.regions.owners(self.users, self.server, self.setting.margin)
        owner = self.regions.owners(self.objects, self.owner, self.setting.margin)
        held = moving[self.holder[moving] >= 0]
        owner[held] = server[self.holder[held]]
        departed_users, departed_objects = server != self.server, owner != self.owner
        self.server, self.owner = server, owner
        rests = numpy.ones(self.setting.objects, bool)
        rests[moving] = False
        self.holder[rests] = -1
        return departed_users, int(departed_objects.sum())

    def step(self):
        """out  {what: mean of the step}, of users and servers as arrays"""
        self.now += STEP
        leaves = self._walk()
        users, objects, distances = self._pairs()
        self._stir(users, objects, distances, leaves)
        moving = self._move()
        levels, changed = self._look(users, objects, distances)
        departed_users, departed_objects = self._own(moving)
        return self._measure(users, objects, levels, changed, moving, departed_users, departed_objects)

    def _measure(self, users, objects, levels, changed, moving, departed_users, departed_objects):
        setting, costs, each = self.setting, self.costs, self.setting.users
        moves = numpy.zeros(setting.objects, bool)
        moves[moving] = True
        sent = moves[objects] & (levels < OUT)
        lods = numpy.stack([numpy.bincount(users[sent & (levels == level)], minlength=each) for level in range(LODS)])
        members = numpy.bincount(users[levels < OUT], minlength=each)
        # Who comes to another server is sent all in its interest there.
        changes = (numpy.bincount(users[changed], minlength=each) + numpy.where(departed_users, members, 0)) / TICKS
        ghosts = self._ghosts(moving)
        packets = datagrams(costs["updates_per_s"] @ lods + 1000 * changes)
        load = self._load(moving, ghosts.sum(axis=0), lods.sum(axis=0), packets / 1000)
        head = 8 * costs["head_byte"]
        down = costs["idle_bit_per_s"] + costs["bit_per_s"] @ lods + 1000 * costs["change_bit"] * changes + (
            head * (costs["idle_datagrams_per_s"] + packets))
        between = ghosts * costs["bit_per_s"][0] + head * datagrams(ghosts * costs["updates_per_s"][0])
        return {"load": load, "moving": len(moving), "members": members.mean(), "told": lods.sum(axis=0).mean(),
                "changes": 1000 * changes.mean(), "down": down, "between": between.sum(), "ghosts": ghosts.sum(),
                "hand_over_users": int(departed_users.sum()), "hand_over_objects": departed_objects,
                "clients": int(numpy.bincount(self.server, minlength=setting.servers).max())}

    def _load(self, moving, ghosts, sent, packets):
        """[us] of each server in a tick: a row for each of PARTS. Keeps what cost where, for the next split."""
        costs, servers = self.costs, self.setting.servers
        own, clients = (numpy.bincount(of, minlength=servers) for of in (self.owner[moving], self.server))
        looks = costs["look_us"] * (own + ghosts)  # of one client
        truth = costs["truth_us"] + costs["truth_of_1000_us"] * self.setting.objects / 1000
        packets = packets * (costs["packet_us"] + costs["packet_of_1000_us"] * self.setting.objects / 1000)
        self.sites = numpy.concatenate([self.objects[moving], self.users])
        self.weights = numpy.concatenate([numpy.full(len(moving), costs["physics_us"] + truth),
                                          costs["session_us"] + looks[self.server] + costs["tell_us"] * sent + packets])
        return numpy.stack([costs["physics_us"] * own, truth * (own + ghosts), costs["session_us"] * clients, looks * clients,
                            costs["tell_us"] * numpy.bincount(self.server, sent, servers),
                            numpy.bincount(self.server, packets, servers)])

    def _ghosts(self, moving):
        """(owner, server): objects of the one that move within reach of the other's region."""
        servers = self.setting.servers
        out = numpy.zeros((servers, servers))
        for server in range(servers):
            others = moving[self.owner[moving] != server]
            near = others[self.regions.distance(self.objects[others], server) < self.setting.reach]
            out[:, server] = numpy.bincount(self.owner[near], minlength=servers)
        return out

    def split(self):
        """Regions anew.   out  how many objects, users have another server"""
        owner, server = self.owner, self.server
        self.regions = Regions(self.setting, self.sites, self.weights)
        self.owner, self.server = self.regions.of(self.objects), self.regions.of(self.users)
        return int((self.owner != owner).sum()), int((self.server != server).sum())


def datagrams(updates):
    """Of so many updates in a second, where those of a tick share one."""
    return 1000 * (1 - numpy.exp(-updates / 1000))


def run(setting, costs):
    """out  what each step after the warm-up measured; [(time, objects, users)] of the splits after it"""
    costs = {name: numpy.asarray(cost) for name, cost in costs.items()}
    world, steps, splits = World(setting, costs), [], []
    uneven = 0
    for number in range(round((WARM_UP + setting.seconds) / STEP)):
        step = world.step()
        time = world.now - WARM_UP
        if time > 1e-9:
            steps.append(step)
        load = step["load"].sum(axis=0)
        uneven = uneven + 1 if load.max() > setting.uneven * load.mean() else 0
        if number == 0 or uneven == UNEVEN_STEPS:
            moved, uneven = world.split(), 0
            if time > 1e-9:
                splits.append((time, *moved))
    return steps, splits


def summary(setting, costs, steps, splits):
    """Numbers of a run, SI units; CPU is of a tick of 1 ms."""
    load = 1e-6 * numpy.array([step["load"] for step in steps])  # step, part, server
    server, down = load.sum(axis=1), numpy.mean([step["down"] for step in steps], axis=0)
    mean = {key: float(numpy.mean([step[key] for step in steps])) for key in ("moving", "members", "told", "ghosts", "between", "clients")}
    per_second = {key: sum(step[key] for step in steps) / setting.seconds for key in ("hand_over_users", "hand_over_objects")}
    return mean | per_second | {
        "changes_per_s": float(numpy.mean([step["changes"] for step in steps])), "down": float(down.mean()), "down_most": float(down.max()),
        "cpu_mean": float(server.mean()), "cpu_fullest": float(server.max(axis=1).mean()), "cpu_worst": float(server.max()),
        "physics": float(load[:, PARTS.index("physics")].mean()), "splits": len(splits),
        "split_objects": float(numpy.mean([objects for _, objects, _ in splits])) if splits else 0.0,
        "memory": costs["memory_byte"] * setting.objects * max(step["clients"] for step in steps)}
