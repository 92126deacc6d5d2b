// SPDX-License-Identifier: Apache-2.0
// Khronos, "glTF 2.0 Specification" (2021): 3.5 scenes, 3.7 meshes, morph targets and skins, 3.11 and appendix C animations.
#include <tactus/sim/surface/gltf_scene.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace tactus::sim {
namespace {

using Read = tl::expected<void, Diagnostic>;

constexpr std::size_t kMostNames = 8;  // that an error lists

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNames); ++i)
    out += (i > 0 ? ", '" : "'") + names[i].substr(0, 60) + '\'';
  return names.size() > kMostNames ? out + " ..." : out;
}

/// On the shorter arc from a to b, both of length 1.
Quat between(const Quat& a, Quat b, double fraction) {
  double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  if (cosine < 0) {
    b = {-b.w, -b.x, -b.y, -b.z};
    cosine = -cosine;
  }
  const double angle = std::acos(std::min(cosine, 1.0)), sine = std::sin(angle);
  const double p = sine < 1e-9 ? 1 - fraction : std::sin((1 - fraction) * angle) / sine;
  const double q = sine < 1e-9 ? fraction : std::sin(fraction * angle) / sine;
  return {p * a.w + q * b.w, p * a.x + q * b.x, p * a.y + q * b.y, p * a.z + q * b.z};
}

Quat unit(const std::vector<double>& v) {
  const double length = std::hypot(std::hypot(v[0], v[1]), std::hypot(v[2], v[3]));
  if (!(length > 0)) return {};
  return {v[3] / length, v[0] / length, v[1] / length, v[2] / length};
}

std::size_t width_of(GltfPath path) noexcept { return path == GltfPath::rotation ? 4 : path == GltfPath::weights ? 0 : 3; }

template <class Affine>
Vec3 moved(const Affine& m, const Vec3& p) noexcept {
  return {dot(m[0].linear, p) + m[0].offset, dot(m[1].linear, p) + m[1].offset, dot(m[2].linear, p) + m[2].offset};
}

template <class Affine>
Affine product(const Affine& a, const Affine& b) noexcept {
  Affine out;
  for (std::size_t r = 0; r < 3; ++r) {
    const Vec3& row = a[r].linear;
    out[r].linear = row.x * b[0].linear + row.y * b[1].linear + row.z * b[2].linear;
    out[r].offset = row.x * b[0].offset + row.y * b[1].offset + row.z * b[2].offset + a[r].offset;
  }
  return out;
}

/// From 16 numbers, column by column.
template <class Affine>
Affine affine_of(const double* m) noexcept {
  Affine out;
  for (std::size_t r = 0; r < 3; ++r) out[r] = {{m[r], m[4 + r], m[8 + r]}, m[12 + r]};
  return out;
}

}  // namespace

// ==== what is taken ====

Read GltfScene::choose_nodes(const std::string& name) {
  const std::size_t nodes = file_.nodes.size(), shown = file_.roots.size();
  parent_.assign(nodes, nodes);
  chosen_.assign(nodes, false);
  for (std::size_t i = 0; i < nodes; ++i)
    for (const std::size_t child : file_.nodes[i].children) parent_[child] = i;
  order_ = file_.roots;
  std::vector<bool> is_root(nodes, false), is_shown(nodes, false);
  for (const std::size_t root : file_.roots) is_root[root] = true;
  for (std::size_t i = 0; i < nodes; ++i)
    if (parent_[i] == nodes && !is_root[i]) order_.push_back(i);  // in no scene that is shown: joints may be there
  for (std::size_t i = 0; i < order_.size(); ++i) {               // trees: each node comes once
    const std::size_t node = order_[i];
    const bool hangs = parent_[node] != nodes;
    is_shown[node] = hangs ? is_shown[parent_[node]] : i < shown;
    chosen_[node] = is_shown[node] && (name.empty() || file_.nodes[node].name == name || (hangs && chosen_[parent_[node]]));
    order_.insert(order_.end(), file_.nodes[node].children.begin(), file_.nodes[node].children.end());
  }
  if (order_.size() != nodes) return broken(Errc::malformed, "R-SRF-4", "nodes hang on one another in a ring");
  std::vector<std::string> named;
  std::size_t meshes = 0;
  for (const std::size_t node : order_) {
    if (!file_.nodes[node].mesh || !is_shown[node]) continue;
    if (chosen_[node]) ++meshes;
    if (!file_.nodes[node].name.empty()) named.push_back(file_.nodes[node].name);
  }
  if (meshes == 0 && !name.empty())
    return broken(Errc::invalid, "R-SEQ-6",
                  "no mesh hangs on a node '" + name + "'; there is " + (named.empty() ? "none" : listed(named)));
  if (meshes > 1)
    rest_.notes.add("", std::to_string(meshes) + " meshes are read as one: " + listed(named) + " (--node takes one)");
  return {};
}

Read GltfScene::choose_animation(const GltfOptions& options) {
  std::vector<std::string> names;
  for (const GltfAnimation& a : file_.animations) names.push_back(a.name);
  if (!options.moves) {
    if (!names.empty()) rest_.notes.add("", "animations are left out: the shape is that of the scene at rest");
    return {};
  }
  const auto found = options.animation.empty() ? names.begin() : std::find(names.begin(), names.end(), options.animation);
  const bool is_open = options.animation.empty() && names.size() > 1;
  if (is_open || (found == names.end() && !options.animation.empty())) {
    auto refused =
        broken(Errc::invalid, "R-SEQ-6",
               is_open ? std::to_string(names.size()) + " animations: " + listed(names)
                       : "no animation '" + options.animation + "'; there is " + (names.empty() ? "none" : listed(names)));
    if (is_open) refused.value().remedy = "Choose one of them with --animation '" + names[0] + "'.";
    return refused;
  }
  if (found == names.end()) {
    rest_.notes.add("", "no animation in it: one frame");
    return {};
  }
  for (const GltfChannel& channel : file_.animations[static_cast<std::size_t>(found - names.begin())].channels)
    TACTUS_CHECK(add_track(channel));
  return {};
}

Read GltfScene::add_track(const GltfChannel& channel) {
  const GltfNode& node = file_.nodes[channel.node];
  const std::string name = "the animation of nodes[" + std::to_string(channel.node) + ']';
  const auto refused = [&](const std::string& why) { return broken(Errc::malformed, "R-SRF-4", name + ": " + why); };
  for (const Track& other : tracks_)
    if (other.node == channel.node && other.path == channel.path) return refused("two channels move one thing");
  Track track{.node = channel.node, .path = channel.path, .interpolation = channel.interpolation, .times = {}, .values = {}};
  TACTUS_TRY(track.times, read_accessor(file_, channel.input, 1, budget_));
  TACTUS_TRY(track.values,
             read_accessor(file_, channel.output, channel.path == GltfPath::weights ? 1 : width_of(channel.path), budget_));
  for (std::size_t k = 0; k < track.times.size(); ++k)
    if (!(track.times[k] >= 0 && track.times[k] <= 1e9) || (k > 0 && !(track.times[k] > track.times[k - 1])))
      return refused("time " + std::to_string(k) + " is negative, too large or not after the one before");
  if (!std::all_of(track.values.begin(), track.values.end(), [](double v) { return std::isfinite(v); }))
    return refused("a value is NaN or infinite");
  if (node.matrix && channel.path != GltfPath::weights) return refused("the node has a matrix, which nothing can move");
  const std::size_t keys = track.times.size() * (channel.interpolation == GltfInterpolation::cubic_spline ? 3 : 1);
  track.width = track.values.size() / keys;
  if (track.width == 0 || track.width * keys != track.values.size() ||
      (channel.path != GltfPath::weights && track.width != width_of(channel.path)))
    return refused(std::to_string(track.values.size()) + " values for " + std::to_string(track.times.size()) + " times");
  duration_ = std::max(duration_, track.times.back());
  tracks_.push_back(std::move(track));
  return {};
}

// ==== meshes ====

tl::expected<std::vector<Vec3>, Diagnostic> GltfScene::read_positions(std::size_t accessor) {
  TACTUS_TRY(const auto numbers, read_accessor(file_, accessor, 3, budget_));
  std::vector<Vec3> out(numbers.size() / 3);
  for (std::size_t v = 0; v < out.size(); ++v) out[v] = {numbers[3 * v], numbers[3 * v + 1], numbers[3 * v + 2]};
  return out;
}

Read GltfScene::add_mesh(std::size_t node) {
  if (const Index skin = file_.nodes[node].skin) {
    Skin& out = skins_.emplace_back();
    out.joints = file_.skins[*skin].joints;
    out.inverse_bind.assign(out.joints.size(),
                            affine_of<Affine>(std::array<double, 16>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}.data()));
    if (const Index matrices = file_.skins[*skin].inverse_bind_matrices) {
      TACTUS_TRY(const auto numbers, read_accessor(file_, *matrices, 16, budget_));
      if (numbers.size() < 16 * out.joints.size())
        return broken(Errc::malformed, "R-SRF-4", "a skin has fewer matrices than joints");
      for (std::size_t j = 0; j < out.joints.size(); ++j) out.inverse_bind[j] = affine_of<Affine>(&numbers[16 * j]);
    }
  }
  for (const GltfPrimitive& primitive : file_.meshes[*file_.nodes[node].mesh].primitives)
    TACTUS_CHECK(add_primitive(node, primitive));
  return {};
}

Read GltfScene::add_primitive(std::size_t node, const GltfPrimitive& primitive) {
  if (primitive.mode < 4 || primitive.mode > 6) {
    rest_.notes.add("", "points and lines are left out");
    return {};
  }
  if (!primitive.position) {
    rest_.notes.add("", "a primitive without positions is left out");
    return {};
  }
  Part part{.node = node, .skin = {}, .base = {}, .targets = {}, .influences = {}};
  TACTUS_TRY(part.base, read_positions(*primitive.position));
  for (const Index target : primitive.targets) {
    std::vector<Vec3>& shifts = part.targets.emplace_back();
    if (!target) continue;  // it moves normals or colours
    TACTUS_TRY(shifts, read_positions(*target));
    if (shifts.size() != part.base.size())
      return broken(Errc::malformed, "R-SRF-4",
                    "a morph target has " + std::to_string(shifts.size()) + " vertices of " + std::to_string(part.base.size()));
  }
  if (file_.nodes[node].skin) TACTUS_CHECK(add_influences(primitive, part));
  vertices_ += part.base.size();
  if (vertices_ > kMaxMeshVertices) return broken(Errc::limit_exceeded, "R-SRF-2", "more than 2^20 vertices");
  const Affine& at = at_rest_[node];
  const bool mirrored = !part.skin && dot(cross(at[0].linear, at[1].linear), at[2].linear) < 0;
  TACTUS_CHECK(add_faces(primitive, part.base.size(), mirrored));
  parts_.push_back(std::move(part));
  return {};
}

/// Which joints move a vertex; weights become 1 in sum.
Read GltfScene::add_influences(const GltfPrimitive& primitive, Part& part) {
  const std::size_t vertices = part.base.size(), sets = primitive.joints.size();
  const Skin& skin = skins_.back();
  if (sets == 0 || skin.joints.empty()) {
    rest_.notes.add("", "a mesh with a skin and without joints stands where its node stands");
    return {};
  }
  part.skin = skins_.size() - 1;
  part.influences.resize(4 * sets * vertices);
  for (std::size_t set = 0; set < sets; ++set) {
    TACTUS_TRY(const auto joints, read_accessor(file_, primitive.joints[set], 4, budget_));
    TACTUS_TRY(const auto weights, read_accessor(file_, primitive.weights[set], 4, budget_));
    if (joints.size() != 4 * vertices || weights.size() != 4 * vertices)
      return broken(Errc::malformed, "R-SRF-4", "joints or weights are not as many as vertices");
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const bool counts = weights[i] > 0 && weights[i] < 1e6;
      if (!counts && weights[i] != 0) return broken(Errc::malformed, "R-SRF-4", "a weight of a joint is negative or no number");
      if (counts && !(joints[i] >= 0 && joints[i] < static_cast<double>(skin.joints.size())))
        return broken(Errc::malformed, "R-SRF-4", "a vertex hangs on a joint that its skin does not have");
      part.influences[(i / 4 * sets + set) * 4 + i % 4] = {counts ? static_cast<std::size_t>(joints[i]) : 0, weights[i]};
    }
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    double sum = 0;
    for (std::size_t k = 0; k < 4 * sets; ++k) sum += part.influences[v * 4 * sets + k].weight;
    if (!(sum > 0)) return broken(Errc::malformed, "R-SRF-4", "vertex " + std::to_string(v) + " hangs on no joint");
    if (std::abs(sum - 1) > 0.02) rest_.notes.add("", "weights of joints are made 1 in sum", "vertex " + std::to_string(v));
    for (std::size_t k = 0; k < 4 * sets; ++k) part.influences[v * 4 * sets + k].weight /= sum;
  }
  return {};
}

/// in   mirrored  the node turns inside out what hangs on it: corners go the other way round
Read GltfScene::add_faces(const GltfPrimitive& primitive, std::size_t vertices, bool mirrored) {
  std::vector<double> corners(vertices);
  std::iota(corners.begin(), corners.end(), 0.0);
  if (primitive.indices) {
    TACTUS_TRY(corners, read_accessor(file_, *primitive.indices, 1, budget_));
    for (const double c : corners)
      if (!(c >= 0 && c < static_cast<double>(vertices)))
        return broken(Errc::invalid, "R-SRF-9",
                      "no vertex " + std::to_string(static_cast<std::int64_t>(c)) + " among " + std::to_string(vertices));
  }
  const std::size_t first = vertices_ - vertices, step = primitive.mode == 4 ? 3 : 1;
  for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
    Polygon t;
    for (const std::size_t k : {primitive.mode == 6 ? 0 : i, i + 1, i + 2})
      t.push_back(static_cast<std::uint32_t>(first + static_cast<std::size_t>(corners[k])));
    if ((primitive.mode == 5 && i % 2 == 1) != mirrored) std::swap(t[1], t[2]);
    const bool is_stitch = t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    if (primitive.mode == 5 && is_stitch) continue;
    if (polygons_.size() == kMaxMeshTriangles) return broken(Errc::limit_exceeded, "R-SRF-2", "more than 2^21 triangles");
    polygons_.push_back(std::move(t));
  }
  if (primitive.mode == 4 && corners.size() % 3 != 0) rest_.notes.add("", "corners behind the last whole triangle are left out");
  return {};
}

// ==== one vertex from many ====

/// What makes up a vertex: its node, its position, and what moves it.
template <class Use>
void GltfScene::each_number(const Part& part, std::size_t vertex, Use use) const {
  const auto use_position = [&](const Vec3& p) { use(p.x), use(p.y), use(p.z); };
  use(static_cast<double>(part.node));
  use_position(part.base[vertex]);
  for (const std::vector<Vec3>& target : part.targets) use_position(target.empty() ? Vec3{} : target[vertex]);
  const std::size_t each = part.influences.size() / part.base.size();
  for (std::size_t k = 0; k < each; ++k) {
    use(static_cast<double>(part.influences[vertex * each + k].joint));
    use(part.influences[vertex * each + k].weight);
  }
}

/// For each vertex the first that is like it.
std::vector<std::uint32_t> GltfScene::alike() const {
  struct Key {
    std::uint64_t hash;
    std::uint32_t vertex, part, within;
  };
  std::vector<Key> keys;
  keys.reserve(vertices_);
  for (std::uint32_t p = 0; p < parts_.size(); ++p) {
    for (std::uint32_t v = 0; v < parts_[p].base.size(); ++v) {
      std::uint64_t hash = 14695981039346656037U;
      each_number(parts_[p], v, [&](double x) {
        hash = (hash ^ std::bit_cast<std::uint64_t>(x == 0 ? 0.0 : x)) * 1099511628211U;
        hash ^= hash >> 29;
      });
      keys.push_back({hash, static_cast<std::uint32_t>(keys.size()), p, v});
    }
  }
  const auto numbers = [&](const Key& key) {
    std::vector<double> out;
    each_number(parts_[key.part], key.within, [&](double x) { out.push_back(x); });
    return out;
  };
  std::sort(keys.begin(), keys.end(),
            [](const Key& a, const Key& b) { return a.hash != b.hash ? a.hash < b.hash : a.vertex < b.vertex; });
  std::vector<std::uint32_t> first(keys.size());
  for (std::size_t i = 0, run = 0; i < keys.size(); ++i) {
    if (keys[i].hash != keys[run].hash) run = i;
    const bool same = i > run && numbers(keys[i]) == numbers(keys[run]);
    first[keys[i].vertex] = same ? keys[run].vertex : keys[i].vertex;
  }
  return first;
}

Read GltfScene::make_rest(const GltfOptions& options) {
  PolygonSoup soup;
  soup.vertices = all_positions(0);
  soup.polygons = std::move(polygons_);
  soup.first_number = 0;
  if (soup.polygons.empty())
    return broken(Errc::invalid, "R-SRF-7",
                  vertices_ > 0 ? "primitives without corners" : "no primitive of triangles in the scene");
  PolygonSoup merged = soup;
  const std::vector<std::uint32_t> first = alike();
  for (Polygon& polygon : merged.polygons)
    for (std::uint32_t& corner : polygon) corner = first[corner];
  ReadNotes notes = std::move(rest_.notes);
  auto made = make_surface(std::move(merged), {.drop_degenerate = options.drop_degenerate});
  if (!made) {
    const std::string_view rule = made.error().error.rule;
    if (rule != "R-SRF-11" && rule != "R-SRF-12" && rule != "R-SRF-13") return tl::unexpected(made.error());
    auto apart = make_surface(std::move(soup), {.drop_degenerate = options.drop_degenerate});
    if (!apart) return tl::unexpected(made.error());
    notes.add("", "vertices at one position are kept apart, as the file has them: joined, they would break " + std::string(rule));
    made = std::move(apart);
  }
  rest_ = std::move(*made);
  rest_.unused_vertices = 0;  // of vertices that were joined
  for (const ReadNote& note : rest_.notes.all()) notes.add(note);
  rest_.notes = std::move(notes);
  return {};
}

tl::expected<GltfScene, Diagnostic> GltfScene::open(std::string bytes, const std::string& folder, const GltfOptions& options) {
  GltfScene out;
  TACTUS_TRY(out.file_, parse_gltf(std::move(bytes), folder));
  out.rest_.notes = std::move(out.file_.notes);
  out.turns_ = options.axes != Axes::z_up;
  TACTUS_CHECK(out.choose_nodes(options.node));
  TACTUS_CHECK(out.choose_animation(options));
  out.at_rest_ = out.world(out.posed(0));
  for (const std::size_t node : out.order_)
    if (out.chosen_[node] && out.file_.nodes[node].mesh) TACTUS_CHECK(out.add_mesh(node));
  for (const Track& track : out.tracks_) {
    const Index mesh = out.file_.nodes[track.node].mesh;
    for (const Part& part : out.parts_)
      if (track.path == GltfPath::weights && mesh && part.node == track.node && track.width != part.targets.size())
        return broken(Errc::malformed, "R-SRF-4",
                      "an animation has " + std::to_string(track.width) + " weights for " + std::to_string(part.targets.size()) +
                          " morph targets");
  }
  if (out.turns_)
    out.rest_.notes.add("",
                        "y is up in glTF, z in a trace: turned, x, y, z are the file's x, -z, y (--axes z-up keeps the file's)");
  TACTUS_CHECK(out.make_rest(options));
  out.file_.views.clear();  // all that is needed is read
  out.file_.held.clear();
  for (GltfNode& node : out.file_.nodes) node.name.clear(), node.children.clear();
  return out;
}

// ==== motion ====

GltfScene::Affine GltfScene::local(const GltfNode& node) const {
  if (node.matrix) return affine_of<Affine>(node.matrix->data());
  const Quat& q = node.pose.rotation;
  const Vec3 x = node.scale.x * rotate(q, {1, 0, 0}), y = node.scale.y * rotate(q, {0, 1, 0}),
             z = node.scale.z * rotate(q, {0, 0, 1});
  const Vec3& t = node.pose.position;
  return {{{{x.x, y.x, z.x}, t.x}, {{x.y, y.y, z.y}, t.y}, {{x.z, y.z, z.z}, t.z}}};
}

/// Appendix C; before the first key and behind the last that key holds.
std::vector<double> GltfScene::value_at(const Track& track, double time) const {
  const bool cubic = track.interpolation == GltfInterpolation::cubic_spline;
  const auto at = [&](std::size_t key, std::size_t of_three) {
    return track.values.begin() + static_cast<std::ptrdiff_t>((cubic ? 3 * key + of_three : key) * track.width);
  };
  const auto held = [&](std::size_t key) {
    return std::vector<double>(at(key, 1), at(key, 1) + static_cast<std::ptrdiff_t>(track.width));
  };
  const auto after = std::upper_bound(track.times.begin(), track.times.end(), time);
  if (after == track.times.begin()) return held(0);
  const auto key = static_cast<std::size_t>(after - track.times.begin()) - 1;
  if (after == track.times.end() || track.interpolation == GltfInterpolation::step) return held(key);
  const double length = track.times[key + 1] - track.times[key], t = (time - track.times[key]) / length;
  std::vector<double> out = held(key), next = held(key + 1);
  if (track.path == GltfPath::rotation && !cubic) {
    const Quat q = between(unit(out), unit(next), t);
    return {q.x, q.y, q.z, q.w};
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto k = static_cast<std::ptrdiff_t>(i);
    out[i] = cubic ? (2 * t * t * t - 3 * t * t + 1) * out[i] + length * (t * t * t - 2 * t * t + t) * at(key, 2)[k] +
                         (-2 * t * t * t + 3 * t * t) * next[i] + length * (t * t * t - t * t) * at(key + 1, 0)[k]
                   : (1 - t) * out[i] + t * next[i];
  }
  return out;
}

std::vector<GltfNode> GltfScene::posed(double time) const {
  std::vector<GltfNode> nodes = file_.nodes;
  for (const Track& track : tracks_) {
    const std::vector<double> v = value_at(track, time);
    GltfNode& node = nodes[track.node];
    switch (track.path) {
      case GltfPath::translation:
        node.pose.position = {v[0], v[1], v[2]};
        break;
      case GltfPath::rotation:
        node.pose.rotation = unit(v);
        break;
      case GltfPath::scale:
        node.scale = {v[0], v[1], v[2]};
        break;
      case GltfPath::weights:
        node.weights = v;
        break;
    }
  }
  return nodes;
}

std::vector<GltfScene::Affine> GltfScene::world(const std::vector<GltfNode>& nodes) const {
  std::vector<Affine> out(nodes.size());
  for (const std::size_t node : order_) {
    const Affine own = local(nodes[node]);
    out[node] = parent_[node] == nodes.size() ? own : product(out[parent_[node]], own);
  }
  return out;
}

std::vector<Vec3> GltfScene::all_positions(double time) const {
  const std::vector<GltfNode> nodes = posed(time);
  const std::vector<Affine> at = world(nodes);
  std::vector<Vec3> out;
  out.reserve(vertices_);
  for (const Part& part : parts_) {
    const GltfNode& node = nodes[part.node];
    const std::vector<double>& weights = node.weights.empty() ? file_.meshes[*node.mesh].weights : node.weights;
    std::vector<Affine> joints;
    if (part.skin)
      for (std::size_t j = 0; j < skins_[*part.skin].joints.size(); ++j)
        joints.push_back(product(at[skins_[*part.skin].joints[j]], skins_[*part.skin].inverse_bind[j]));
    const std::size_t each = part.influences.size() / part.base.size();
    for (std::size_t v = 0; v < part.base.size(); ++v) {
      Vec3 p = part.base[v];
      for (std::size_t k = 0; k < std::min(weights.size(), part.targets.size()); ++k)
        if (!part.targets[k].empty()) p = p + weights[k] * part.targets[k][v];
      Vec3 q = part.skin ? Vec3{} : moved(at[part.node], p);
      for (std::size_t k = 0; k < each; ++k) {
        const Influence& i = part.influences[v * each + k];
        if (i.weight > 0) q = q + i.weight * moved(joints[i.joint], p);
      }
      out.push_back(turns_ ? turned_up(q) : q);
    }
  }
  return out;
}

std::vector<Vec3> GltfScene::positions(double time) const {
  const std::vector<Vec3> all = all_positions(time);
  std::vector<Vec3> out;
  out.reserve(rest_.vertex.size());
  for (const std::uint32_t v : rest_.vertex) out.push_back(all[v]);
  return out;
}

}  // namespace tactus::sim
