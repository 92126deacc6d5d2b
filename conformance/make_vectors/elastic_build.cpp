// SPDX-License-Identifier: Apache-2.0
#include "conformance/make_vectors/elastic_build.h"

#include <algorithm>
#include <bit>
#include <map>

namespace tactus::conformance {
namespace {

void append(Bytes& to, const Bytes& bytes) { to.insert(to.end(), bytes.begin(), bytes.end()); }

/// Six times the volume, exact for differences of 20 bits.
std::int64_t six_volumes(const Block& of, const Corners& tet) {
  std::array<std::array<std::int64_t, 3>, 3> e{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) e[i][axis] = std::int64_t{of.rest(tet[i + 1])[axis]} - of.rest(tet[0])[axis];
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

}  // namespace

Bytes RawBody::bytes() const {
  Bytes out;
  ByteWriter w(out);
  w.u8(has_body);
  for (const double c : constants) w.u64(std::bit_cast<std::uint64_t>(c));
  w.u8(material_count.value_or(static_cast<std::uint8_t>(materials.size())));
  for (const auto& material : materials)
    for (const double c : material) w.u64(std::bit_cast<std::uint64_t>(c));
  w.bytes(inner_count.value_or(varint(inner.size())));
  w.bytes(tet_count.value_or(varint(tets.size())));
  std::array<std::int64_t, 3> place{};
  for (const Vec3i& p : inner) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      append(out, zigzag_varint(p[axis] - place[axis]));
      place[axis] = p[axis];
    }
  }
  std::int64_t first = 0;
  for (const Corners& tet : tets) {
    std::int64_t last = first;
    for (const std::uint32_t corner : tet) {
      append(out, zigzag_varint(corner - last));
      last = corner;
    }
    first = tet[0];
  }
  for (const auto& [length, material] : lengths) append(out, varint(length) + Bytes{material});
  append(out, run_count.value_or(varint(runs.size())));
  for (const auto& [gap, more] : runs) append(out, varint(gap) + varint(more));
  return out;
}

Block block(int nx, int ny, int nz, std::int32_t size) {
  Block out{.shape = box(nx, ny, nz, size)};
  std::map<Vec3i, std::uint32_t> numbers;
  for (const Vec3i& p : out.shape.rest) numbers.try_emplace(p, static_cast<std::uint32_t>(numbers.size()));
  const auto number = [&](const Vec3i& cell) {
    const Vec3i p{cell[0] * size, cell[1] * size, cell[2] * size};
    const auto [at, added] = numbers.try_emplace(p, static_cast<std::uint32_t>(numbers.size()));
    if (added) out.inner.push_back(p);
    return at->second;
  };
  constexpr std::array<std::array<std::size_t, 3>, 6> kWays{{{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      for (int z = 0; z < nz; ++z) {
        for (const auto& way : kWays) {  // along the edges from one corner to the one opposite
          Vec3i at{x, y, z};
          Corners tet{number(at)};
          for (std::size_t i = 0; i < 3; ++i) {
            ++at[way[i]];
            tet[i + 1] = number(at);
          }
          const bool is_left_handed = way[1] != (way[0] + 1) % 3;
          if (is_left_handed) std::swap(tet[1], tet[2]);
          out.tets.push_back(tet);
        }
      }
    }
  }
  return out;
}

Block tangle(std::uint32_t vertices, std::uint32_t tets, std::uint64_t seed) {
  Random random(seed);
  Block out;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const auto any = [&] { return static_cast<std::int32_t>(random.below(4096)); };
    const std::int32_t x = any(), y = any(), z = any();
    out.shape.rest.push_back({x, y, z});
  }
  while (out.tets.size() < tets) {
    Corners tet{};
    for (std::uint32_t& corner : tet) corner = random.below(vertices);
    const std::int64_t six = six_volumes(out, tet);
    if (six < 0) std::swap(tet[0], tet[1]);
    if (six != 0) out.tets.push_back(tet);
  }
  return out;
}

ElasticItem heaviest(std::uint32_t tets) {
  const Block any = tangle(500, tets, 3);
  return {{.shape = any.shape}, loose(any)};
}

std::vector<std::array<std::uint64_t, 2>> runs_of(const std::vector<std::uint32_t>& vertices) {
  std::vector<std::array<std::uint64_t, 2>> out;
  std::uint32_t end = 0;  // of the run before
  for (const std::uint32_t v : vertices) {
    if (!out.empty() && v == end) ++out.back()[1];
    else out.push_back({v - end, 0});
    end = v + 1;
  }
  return out;
}

RawBody loose(const Block& block) {
  RawBody out;
  out.inner = block.inner;
  out.tets = block.tets;
  return out;
}

RawBody standing(const Block& block) {
  RawBody out = loose(block);
  std::vector<std::uint32_t> fixed;
  for (std::uint32_t v = 0; v < block.shape.rest.size(); ++v)
    if (block.shape.rest[v][2] == 0) fixed.push_back(v);
  out.runs = runs_of(fixed);
  return out;
}

RawHeader with_elastic(RawHeader header, const std::vector<ElasticItem>& items) {
  std::vector<RawDeformable> objects;
  objects.reserve(items.size());
  for (const ElasticItem& item : items) objects.push_back(item.object);
  const std::uint16_t flags = header.flags;
  header = with_deformables(std::move(header), objects);
  header.flags = flags | 33;
  for (const ElasticItem& item : items) append(header.elastic, item.body ? item.body->bytes() : Bytes{0});
  return header;
}

RawHeader only(const ElasticItem& item) {
  RawHeader header;
  header.objects.clear();
  return with_elastic(std::move(header), {item});
}

ElasticItem cube() {
  const Block one = block(1, 1, 1);
  return {{.shape = one.shape}, standing(one)};
}

ElasticStream::ElasticStream(const RawHeader& header) : stream_(header) {
  has_device_ = !stream_.header().moving().empty();
  for (std::size_t i = 0; i < stream_.header().deformables.size(); ++i) composers_.emplace_back(stream_.header(), i);
}

Bytes ElasticStream::of_substream(std::size_t number, const Bytes& packet) const {
  const bool several = composers_.size() + (has_device_ ? 1 : 0) > 1;
  return several ? Bytes{static_cast<std::uint8_t>(number)} + packet : packet;
}

ElasticStream& ElasticStream::device(std::int64_t tick, const Vec3i& place, const Vec3i& velocity) {
  return add_device({.tick = tick, .updates = {{.residual = {{place, velocity}}}}, .key = true});
}

ElasticStream& ElasticStream::add(std::size_t object, const MainStep& step) {
  stream_.add_packet(step.at.tick, of_substream(object + 1, composers_[object].packet(step)), step.at.key);
  return *this;
}

RawHeader scene(const ElasticItem& item, std::uint32_t ticks, bool has_device) {
  RawHeader header;
  if (has_device) header.objects = {{"device"}};
  else header.objects.clear();
  ElasticItem own = item;
  own.object.frame_period = 256 * ticks;
  return with_elastic(header, {own});
}

Bytes played(const RawHeader& header, const std::vector<Move>& moves, const std::vector<Told>& told, std::int64_t end,
             std::uint64_t seed) {
  ElasticStream stream(header);
  Random random(seed);
  auto move = moves.begin();
  const auto move_until = [&](std::int64_t tick) {
    for (; move != moves.end() && move->tick <= tick; ++move) stream.device(move->tick, move->place, move->velocity);
  };
  for (const auto& [tick, following, width] : told) {
    move_until(tick);
    MainStep step{.at = {.tick = tick, .key = &told[0].tick == &tick}, .following = following};
    if (width > 0) step.residuals = random_residuals(random, width, 120);
    stream.add(0, step);
  }
  move_until(end);
  MainStep last{.at = {.tick = end}, .following = told.empty() ? Following::none : told.back().following};
  last.at.key = told.empty();
  return stream.add(0, last).finished();
}

ElasticItem pad(int nx, int ny, int nz) {
  const Block mesh = block(nx, ny, nz, kSize);
  return {{.shape = mesh.shape}, standing(mesh)};
}
void add_device(Catalogue& c, const std::string& name, const char* what, Bytes bytes) {
  c.valid(name, what, std::move(bytes), {}, "device");
}

}  // namespace tactus::conformance
