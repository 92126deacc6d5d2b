// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/scene/scene.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <span>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/sim/scene/deformable_reader.h>
#include <tactus/sim/scene/object_surface.h>
#include <tactus/sim/scene/toml_reader.h>

namespace tactus::sim {
namespace {

constexpr std::size_t kMostSceneBytes = std::size_t{4} << 20;
constexpr double kFarthest = 500;                                   // [m] inside the codec's default grid, with 12 m to move
constexpr double kLargest = 100;                                    // [m] of an object
constexpr std::size_t kMostObjects = 4096, kMostDeformables = 255;  // limits of a stream
constexpr std::size_t kMostUsers = 64;
constexpr double kLongest = 24 * 3600.0;                                           // [s]
constexpr std::array<std::string_view, 6> kAxes{"x", "y", "z", "rx", "ry", "rz"};  // order of the bits in Dof
constexpr Range kPosition{-kFarthest, kFarthest};
constexpr Range kWorld{1e-3, 1e6};

std::uint8_t read_axes(TomlReader& in, const toml::table& table, const std::string& path, std::string_view key,
                       std::uint8_t fallback) {
  const toml::node* node = table.get(key);
  if (!node) return fallback;
  const toml::array* array = node->as_array();
  if (!array) {
    in.fail_at(node->source(), Errc::invalid, "R-SCN-5", TomlReader::join(path, key), "write an array such as [\"x\", \"rz\"]");
    return fallback;
  }
  unsigned axes = 0;
  for (const auto& element : *array) {
    const auto name = element.value_or(std::string_view{});
    const auto found = std::find(kAxes.begin(), kAxes.end(), name);
    if (found == kAxes.end())
      in.fail_at(element.source(), Errc::invalid, "R-SCN-7", TomlReader::join(path, key), "use x, y, z, rx, ry, rz");
    else axes |= 1u << (found - kAxes.begin());
  }
  const unsigned turns = axes & ~static_cast<unsigned>(Dof::translation);
  if (const int count = std::popcount(turns); count == 2)
    in.fail_at(node->source(), Errc::invalid, "R-SCN-6", TomlReader::join(path, key),
               "turn about no axis, one axis or all three");
  return static_cast<std::uint8_t>(axes);
}

Quat read_rotation(TomlReader& in, const toml::table& table, const std::string& path) {
  const toml::node* node = table.get("rotation");
  if (!node) return {};
  const auto [w, x, y, z] = in.numbers<4>(*node, path + ".rotation", {-1, 1});
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  if (std::abs(length - 1) > 1e-3) {
    in.fail_at(node->source(), Errc::invalid, "R-SCN-6", path + ".rotation", "write a unit quaternion w, x, y, z");
    return {};
  }
  return {w / length, x / length, y / length, z / length};
}

/// Read the surface and shift it so that its centre of mass is the object's origin. The object's position is adjusted accordingly.
void read_surface(TomlReader& in, const toml::table& table, const std::filesystem::path& folder, SceneObject& object) {
  const toml::node& node = *table.get("surface");
  if (const toml::node* size = table.get("size"))
    in.fail_at(size->source(), Errc::invalid, "R-SCN-4", "object.size", "say either size (a box) or surface (a file)");
  const std::string file = (folder / in.text(table, "object", "surface")).string();
  if (in.failed()) return;
  if (is_special_file(file))
    return in.fail_at(node.source(), Errc::invalid, "R-SCN-8", "object.surface", file + ": name a regular file");
  auto read = read_object_surface(file);
  if (!read) return in.fail_at(node.source(), read.error().error.code, "R-SCN-8", "object.surface", to_string(read.error()));
  object.surface = std::move(read->mesh);
  object.pose.position = to_world(object.pose, read->centre);
  Vec3 low, high;
  for (Vec3& v : object.surface.vertices) {
    v = v - read->centre;
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  object.size = high - low;
  if (!(norm(object.size) <= kLargest))
    in.fail_at(node.source(), Errc::invalid, "R-SCN-6", "object.surface",
               "scale it: coordinates are metres, it is over 100 m long");
}

/// in  free  bits of the axes along or about which the object moves
Vec3 read_motion(TomlReader& in, const toml::table& table, std::string_view key, Range range, unsigned free) {
  const toml::node* node = table.get(key);
  if (!node) return {};
  const std::string path = TomlReader::join("object", key);
  const auto [x, y, z] = in.numbers<3>(*node, path, range);
  if ((x != 0 && !(free & 1)) || (y != 0 && !(free & 2)) || (z != 0 && !(free & 4)))
    in.fail_at(node->source(), Errc::invalid, "R-SCN-6", path, "write 0 for axes that are not in dof");
  return {x, y, z};
}

SceneObject read_object(TomlReader& in, const toml::table& table, const std::filesystem::path& folder) {
  const std::string path = "object";
  in.allow(
      table, path,
      {"name", "size", "surface", "mass", "friction", "damping", "dof", "position", "rotation", "velocity", "angular_velocity"});
  SceneObject object;
  object.name = in.name(table, path);
  if (!table.contains("surface")) object.size = in.vector(table, path, "size", {1e-4, kLargest});
  object.dof = read_axes(in, table, path, "dof", Dof::all);
  object.mass = in.number(table, path, "mass", {1e-6, 1e6});
  object.friction = in.number(table, path, "friction", {0, 100});
  object.damping = in.number(table, path, "damping", {0, 1}, 1.0);
  object.pose.position = in.vector(table, path, "position", kPosition);
  object.pose.rotation = read_rotation(in, table, path);
  object.velocity = read_motion(in, table, "velocity", {-1000, 1000}, object.dof & 7u);
  object.angular_velocity = read_motion(in, table, "angular_velocity", {-1000, 1000}, object.dof >> 3);
  if (table.contains("surface")) read_surface(in, table, folder, object);
  return object;
}

SceneMsd read_msd(TomlReader& in, const toml::table& table) {
  const std::string path = "msd";
  in.allow(table, path, {"name", "stiffness", "damping", "mass", "position", "faces", "touch_damping", "rate"});
  SceneMsd msd;
  msd.name = in.name(table, path);
  msd.object.stiffness = in.number(table, path, "stiffness", {0, 1e9});
  msd.object.damping = in.number(table, path, "damping", {0, 1e6});
  msd.object.mass = in.number(table, path, "mass", {1e-6, 1e6});
  msd.position = in.vector(table, path, "position", kPosition);
  const std::size_t side = in.word(table, path, "faces", {"x", "-x", "y", "-y", "z", "-z"}, "z");
  msd.axis = static_cast<unsigned>(side / 2);
  const double sign = side % 2 == 0 ? 1 : -1;
  msd.normal = sign * Vec3{msd.axis == 0 ? 1.0 : 0, msd.axis == 1 ? 1.0 : 0, msd.axis == 2 ? 1.0 : 0};
  msd.touch_damping = in.number(table, path, "touch_damping", {0, 1e4}, 0.0);
  msd.rate = in.whole(table, path, "rate", {1, 1000}, 1);
  return msd;
}

SceneTouch read_touch(TomlReader& in, const toml::table& table) {
  const std::string path = "touch";
  in.allow(table, path, {"stiffness", "friction", "lift_stiffness", "max_damping"});
  return {.stiffness = in.number(table, path, "stiffness", {1, 1e5}),
          .friction = in.number(table, path, "friction", {0, 100}),
          .lift_stiffness = in.number(table, path, "lift_stiffness", {1, 1e5}),
          .max_damping = in.number(table, path, "max_damping", {0, 1000}, 0)};
}

SceneCompensation read_compensation(TomlReader& in, const toml::table& table) {
  const std::string path = "compensation";
  in.allow(table, path, {"method", "filter"});
  SceneCompensation out;
  out.method = static_cast<CompensationMethod>(
      in.word(table, path, "method", {"stiffness", "stiffness-thesis", "simulation"}, "stiffness"));
  if (table.contains("filter")) out.filter = in.number(table, path, "filter", {1e-6, 1});
  return out;
}

SceneInterest read_interest(TomlReader& in, const toml::table& table) {
  const std::string path = "interest";
  in.allow(table, path, {"full", "reach"});
  SceneInterest out;
  out.full = in.number(table, path, "full", {1e-3, kLargest});
  out.reach = in.number(table, path, "reach", {std::max(1e-3, out.full), 4 * kLargest});
  return out;
}

SceneDevice read_device(TomlReader& in, const toml::table& table) {
  const std::string path = "user.device";
  in.allow(table, path, {"scale", "max_force", "resolution", "filter", "axes"});
  SceneDevice device;
  device.scale = in.number(table, path, "scale", {kLeastDeviceScale, kLargestDeviceScale}, device.scale);
  device.max_force = device.scale * in.number(table, path, "max_force", {0.01, 1000}, device.max_force);
  device.resolution = device.scale * in.number(table, path, "resolution", {1e-9, 0.1}, device.resolution);
  device.filter = in.whole(table, path, "filter", {1, 1000}, device.filter);
  device.axes = read_axes(in, table, path, "axes", device.axes) & Dof::translation;
  return device;
}

PathPhase read_phase(TomlReader& in, const toml::table& table) {
  const std::string path = "user.path";
  in.allow(table, path, {"name", "frame", "to", "duration", "button", "turns", "centre"});
  PathPhase phase;
  phase.name = in.text(table, path, "name");
  phase.frame =
      static_cast<PathFrame>(in.word(table, path, "frame", {"world", "hand", "object", "toward_goal", "at_goal"}, "world"));
  phase.to = in.vector(table, path, "to", kPosition);
  phase.duration = in.number(table, path, "duration", {kTick, kLongest});
  phase.button = in.flag(table, path, "button", false);
  phase.turns = in.number(table, path, "turns", {-1e4, 1e4}, 0.0);
  if (phase.turns != 0) phase.centre = in.vector(table, path, "centre", kPosition);
  else if (const toml::node* centre = table.get("centre"))
    in.fail_at(centre->source(), Errc::invalid, "R-SCN-4", path + ".turns", "say how many turns round this centre");
  return phase;
}

std::uint32_t read_watched(TomlReader& in, const toml::table& table, const Scene& scene) {
  const std::string name = in.text(table, "user", "object");
  std::uint32_t index = 0;
  const auto is_among = [&](const auto& objects) {
    for (const auto& object : objects) {
      if (object.name == name) return true;
      ++index;
    }
    return false;
  };
  if (is_among(scene.objects) || is_among(scene.msds) || is_among(scene.deformables)) return index;
  in.fail_at(table.source(), Errc::invalid, "R-SCN-7", "user.object", "name an object of this scene");
  return 0;
}

SceneUser read_user(TomlReader& in, const toml::table& table, const Scene& scene) {
  const std::string path = "user";
  in.allow(table, path,
           {"name", "grip", "duration_scale", "tremor", "variation", "scatter", "object", "goal", "start", "device", "path"});
  SceneUser user;
  user.name = in.name(table, path);
  user.grip = static_cast<Grip>(in.word(table, path, "grip", {"loose", "normal", "firm"}, "normal"));
  user.duration_scale = in.number(table, path, "duration_scale", {0.1, 10}, 1.0);
  user.tremor = in.number(table, path, "tremor", {0, 0.01}, 0.0);
  user.variation = in.number(table, path, "variation", {0, 0.5}, 0.0);
  user.scatter = in.number(table, path, "scatter", {0, 0.1}, 0.0);
  user.object = read_watched(in, table, scene);
  user.start = in.vector(table, path, "start", kPosition);
  user.goal = in.vector(table, path, "goal", kPosition, Vec3{});
  if (const toml::table* device = in.table(table, path, "device")) user.device = read_device(in, *device);
  user.tremor *= user.device.scale;
  for (const toml::table* phase : in.tables(table, path, "path")) user.path.push_back(read_phase(in, *phase));
  return user;
}

/// Limit the memory and time that a few bytes of text can demand.
void limit(TomlReader& in, const toml::table& root, std::string_view key, std::size_t most) {
  const std::size_t count = in.tables(root, "", key).size();
  if (count > most)
    in.fail_at(root.get(key)->source(), Errc::invalid, "R-SCN-6", std::string(key),
               "a scene has at most " + std::to_string(most) + " of these, this one has " + std::to_string(count));
}

void read_scene(TomlReader& in, const toml::table& root, const std::filesystem::path& folder, Scene& scene) {
  in.allow(root, "",
           {"name", "gravity", "duration", "world_size", "floor", "touch", "compensation", "interest", "object", "msd",
            "deformable", "user"});
  scene.name = in.text(root, "", "name");
  scene.gravity = in.vector(root, "", "gravity", {-1000, 1000});
  scene.duration = in.number(root, "", "duration", {kTick, kLongest});
  if (root.contains("world_size")) scene.world_size = in.number(root, "", "world_size", kWorld);
  if (root.contains("floor")) scene.floor = in.number(root, "", "floor", kPosition);
  if (const toml::table* touch = in.table(root, "", "touch")) scene.touch = read_touch(in, *touch);
  if (const toml::table* asked = in.table(root, "", "compensation")) scene.compensation = read_compensation(in, *asked);
  if (const toml::table* asked = in.table(root, "", "interest")) scene.interest = read_interest(in, *asked);

  limit(in, root, "object", kMostObjects);
  limit(in, root, "msd", kMostObjects);
  limit(in, root, "deformable", kMostDeformables);
  limit(in, root, "user", kMostUsers);
  if (in.failed()) return;
  std::set<std::string> names;
  for (const toml::table* table : in.tables(root, "", "object")) {
    scene.objects.push_back(read_object(in, *table, folder));
    if (!names.insert(scene.objects.back().name).second)
      in.fail_at(table->source(), Errc::invalid, "R-SCN-7", "object.name", "give every object a name of its own");
  }
  for (const toml::table* table : in.tables(root, "", "msd")) {
    scene.msds.push_back(read_msd(in, *table));
    if (!names.insert(scene.msds.back().name).second)
      in.fail_at(table->source(), Errc::invalid, "R-SCN-7", "msd.name", "give every object a name of its own");
  }
  std::uint64_t tets = 0;
  for (const toml::table* table : in.tables(root, "", "deformable")) {
    scene.deformables.push_back(read_deformable(in, *table, folder, scene.touch.value_or(SceneTouch{})));
    if (tets += scene.deformables.back().mesh.tets.size(); !affords_tets(in, *table, "deformable", tets)) return;
    if (!names.insert(scene.deformables.back().name).second)
      in.fail_at(table->source(), Errc::invalid, "R-SCN-7", "deformable.name", "give every object a name of its own");
  }
  for (const toml::table* table : in.tables(root, "", "user")) {
    scene.users.push_back(read_user(in, *table, scene));
    if (!names.insert(scene.users.back().name).second)
      in.fail_at(table->source(), Errc::invalid, "R-SCN-7", "user.name", "give every user a name of its own");
  }
  if (scene.objects.empty() && scene.msds.empty() && scene.deformables.empty())
    in.fail_at(root.source(), Errc::invalid, "R-SCN-4", "object", "add at least one [[object]], [[msd]] or [[deformable]]");
  if (!scene.users.empty() && !scene.touch)
    in.fail_at(root.source(), Errc::invalid, "R-SCN-4", "touch", "users need a [touch] table that says what they feel");
}

/// Files that the scene names are looked for in `folder`, once `check` has found nothing.
template <class Check>
tl::expected<Scene, Diagnostic> parse_beside(std::string_view text, std::string_view file, const std::filesystem::path& folder,
                                             Check check) {
  TomlReader in(file);
  Scene scene;
  scene.text = text;
  in.parse(text, kMostSceneBytes, [&](const toml::table& root) {
    check(in, root);
    if (!in.failed()) read_scene(in, root, folder, scene);
  });
  if (in.failed()) return tl::unexpected(in.error());
  return scene;
}

void refuse_paths(TomlReader& in, const toml::table& root) {
  constexpr std::pair<const char*, const char*> kNamingFiles[] = {{"object", "surface"}, {"deformable", "mesh"}};
  for (const auto& [list, key] : kNamingFiles)
    for (const toml::table* table : in.tables(root, "", list))
      if (const toml::node* node = table->get(key);
          node && node->value_or(std::string_view()).find('/') != std::string_view::npos)
        in.fail_at(node->source(), Errc::invalid, "R-SCN-8", TomlReader::join(list, key),
                   "the scene in a trace names only files that come with Tactus; give the scene itself");
}

}  // namespace

tl::expected<Scene, Diagnostic> parse_scene(std::string_view text, std::string_view file) {
  return parse_beside(text, file, std::filesystem::path(file).parent_path(), [](TomlReader&, const toml::table&) {});
}

std::uint64_t fingerprint(const Scene& scene) noexcept {
  Fnv1a hash;
  for (const char c : scene.text)
    if (c != '\r') hash.add_byte(static_cast<std::uint8_t>(c));
  const auto add = [&](std::span<const Vec3> points) {
    for (const Vec3& point : points)
      for (const double x : {point.x, point.y, point.z}) hash.add64(std::bit_cast<std::uint64_t>(x));
  };
  for (const SceneObject& object : scene.objects) add(object.surface.vertices);
  for (const SceneDeformable& object : scene.deformables) add(object.mesh.vertices);
  return hash.value() == 0 ? 1 : hash.value();
}

tl::expected<Scene, Diagnostic> load_scene(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMostSceneBytes + 1, '\0');  // one more, so that parse_scene() can refuse a longer one
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad() || !(file.good() || file.eof()))
    return tl::unexpected(Diagnostic{.error = fail(Errc::io, "R-SCN-1").value(), .file = path});
  return parse_scene(text, path);
}

namespace {

/// Where the scenes are that come with Tactus: from the program that runs, or where the library was installed.
std::filesystem::path scene_folder() {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path folder = (program.parent_path() / TACTUS_SCENES_FROM_PROGRAM).lexically_normal();
  return !program.empty() && fs::is_directory(folder, ignored) ? folder : fs::path(TACTUS_SCENES_INSTALLED);
}

std::string names_of_scenes() {
  std::set<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(scene_folder(), ignored))
    if (entry.path().extension() == ".toml") names.insert(" " + entry.path().stem().string());
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ",") + name;
  return out;
}

}  // namespace

tl::expected<std::string, Diagnostic> find_scene(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::is_regular_file(name, ignored)) return name;
  const fs::path path = scene_folder() / (name + ".toml");
  if (name.find('/') == std::string::npos && fs::is_regular_file(path, ignored)) return path.string();
  const std::string names = names_of_scenes();
  return tl::unexpected(Diagnostic{.error = fail(Errc::io, "R-SCN-1").value(),
                                   .file = name,
                                   .remedy = names.empty()
                                                 ? "no such file; the scenes of Tactus are not in " + scene_folder().string() +
                                                       ": leave the program where it was installed, or name a file"
                                                 : "no such file, nor a scene of that name; name a file, or one of" + names});
}

tl::expected<Scene, Diagnostic> parse_attached_scene(std::string_view text) {
  return parse_beside(text, "scene of the trace", scene_folder(), refuse_paths);
}

void scale_durations(Scene& scene, double factor) noexcept {
  for (SceneUser& user : scene.users) user.duration_scale *= factor;
  scene.duration *= factor;
}

void set_tremor(Scene& scene, double rms) noexcept {
  for (SceneUser& user : scene.users) user.tremor = user.device.scale * rms;
}

bool sends_loads(const Scene& scene) noexcept {
  return scene.compensation && !scene.users.empty() &&
         std::ranges::any_of(scene.objects, [](const SceneObject& object) { return object.dof != Dof::none; });
}

SceneBuilder scene_builder(const Scene& scene, std::span<const std::optional<DrivenPhysics>> driven) {
  SceneBuilder out(kTickRate);
  if (scene.world_size) out.world_size(*scene.world_size);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    out.rigid(object.name, object.pose, {.dof = object.dof, .driven = i < driven.size() ? driven[i] : std::nullopt});
  }
  for (const SceneMsd& msd : scene.msds) out.rigid(msd.name, {msd.position, {}}, {.dof = msd.dof()});
  if (sends_loads(scene)) out.loads({.users = static_cast<std::uint8_t>(scene.users.size())});
  return out;
}

}  // namespace tactus::sim
