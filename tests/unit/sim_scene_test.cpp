// SPDX-License-Identifier: Apache-2.0
/// Files of scenes.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include <tactus/sim/scene/scene.h>
#include <tactus/sim/scene/toml_reader.h>
#include "tests/unit/rule_fixture.h"

namespace tactus::sim {
namespace {

// ==== sim scene ====

const std::string kHead =
    "name = \"test\"\n"
    "duration = 1.0\n"
    "gravity = [0, 0, -9.81]\n";  // lines 1 to 3
const std::string kCube =
    "[[object]]\n"
    "name = \"cube\"\n"
    "size = [0.04, 0.05, 0.06]\n"
    "mass = 0.15\n"
    "friction = 0.7\n"
    "position = [1, 2, 3]\n";  // lines 4 to 9

TEST(Scene, DefaultsAreWhatTheHeaderSays) {
  const auto scene = parse_scene(kHead + kCube, "t.toml");
  ASSERT_TRUE(scene) << to_string(scene.error());
  EXPECT_EQ(scene->name, "test");
  EXPECT_EQ(scene->text, kHead + kCube);
  EXPECT_FALSE(scene->floor);
  EXPECT_FALSE(scene->touch);
  EXPECT_TRUE(scene->users.empty());
  ASSERT_EQ(scene->objects.size(), 1u);
  const SceneObject& cube = scene->objects[0];
  EXPECT_EQ(cube.size, (Vec3{0.04, 0.05, 0.06}));
  EXPECT_EQ(cube.pose.position, (Vec3{1, 2, 3}));
  EXPECT_EQ(cube.pose.rotation, Quat{});
  EXPECT_EQ(cube.dof, Dof::all);
  EXPECT_EQ(cube.damping, 1.0);
}

TEST(Scene, AxesBecomeBits) {
  const auto axes = [](const std::string& list) {
    const auto scene = parse_scene(kHead + kCube + "dof = " + list + "\n", "t.toml");
    return scene ? scene->objects[0].dof : 0xFF;
  };
  EXPECT_EQ(axes("[]"), Dof::none);
  EXPECT_EQ(axes("[\"x\"]"), Dof::x);
  EXPECT_EQ(axes("[\"x\", \"y\", \"rz\"]"), Dof::x | Dof::y | Dof::rz);
  EXPECT_EQ(axes("[\"rz\", \"ry\", \"rx\", \"z\", \"y\", \"x\"]"), Dof::all);
}

struct Broken {
  const char* why;
  std::string text;
  const char* rule;
  std::uint32_t line;
  const char* key;
};

const std::string kUser =
    "[[user]]\n"
    "name = \"hand\"\n"
    "object = \"cube\"\n"
    "start = [0, 0, 0]\n";                                                // lines 13 to 16 after kTouch
const std::string kTouch = "[touch]\nstiffness = 630\nfriction = 0.5\n";  // lines 10 to 12, incomplete

const std::vector<Broken>& broken() {
  static const std::vector<Broken> cases{
      {"not TOML", kHead + "floor = = 1\n", "R-SCN-2", 4, ""},
      {"unknown key", "colour = \"red\"\n" + kHead + kCube, "R-SCN-3", 1, "colour"},
      {"unknown key of an object", kHead + kCube + "masss = 1\n", "R-SCN-3", 10, "object.masss"},
      {"no name", kHead.substr(kHead.find('\n') + 1) + kCube, "R-SCN-4", 1, "name"},
      {"no object", kHead, "R-SCN-4", 1, "object"},
      {"object without mass", kHead + "[[object]]\nname = \"c\"\nsize = [1, 1, 1]\n", "R-SCN-4", 4, "object.mass"},
      {"touch without lift", kHead + kCube + kTouch, "R-SCN-4", 10, "touch.lift_stiffness"},
      {"users without touch", kHead + kCube + kUser, "R-SCN-4", 1, "touch"},
      {"number as text", "floor = \"0\"\n" + kHead + kCube, "R-SCN-5", 1, "floor"},
      {"vector of two", "floor = 0\nduration = 1\nname = \"x\"\ngravity = [0, 1]\n" + kCube, "R-SCN-5", 4, "gravity"},
      {"axes as text", kHead + kCube + "dof = \"x\"\n", "R-SCN-5", 10, "object.dof"},
      {"object as a table", kHead + "[object]\nname = \"c\"\n", "R-SCN-5", 4, "object"},
      {"not a number", "floor = nan\n" + kHead + kCube, "R-SCN-6", 1, "floor"},
      {"infinite", "floor = -inf\n" + kHead + kCube, "R-SCN-6", 1, "floor"},
      {"a world of no size", "world_size = 0\n" + kHead + kCube, "R-SCN-6", 1, "world_size"},
      {"negative damping", kHead + kCube + "damping = -0.1\n", "R-SCN-6", 10, "object.damping"},
      {"turn about two axes", kHead + kCube + "dof = [\"rx\", \"rz\"]\n", "R-SCN-6", 10, "object.dof"},
      {"long quaternion", kHead + kCube + "rotation = [1, 1, 0, 0]\n", "R-SCN-6", 10, "object.rotation"},
      {"unknown axis", kHead + kCube + "dof = [\"w\"]\n", "R-SCN-7", 10, "object.dof"},
      {"two of one name", kHead + kCube + kCube, "R-SCN-7", 10, "object.name"},
      {"unknown watched object",
       kHead + kCube + kTouch + "lift_stiffness = 68\n[[user]]\nname = \"u\"\nobject = \"ball\"\nstart = [0, 0, 0]\n", "R-SCN-7",
       14, "user.object"},
      {"a filter that never follows", kHead + "[compensation]\nfilter = 0\n" + kCube, "R-SCN-6", 5, "compensation.filter"},
      {"interest without reach", kHead + "[interest]\nfull = 1\n" + kCube, "R-SCN-4", 4, "interest.reach"},
      {"interest that reaches less far than full", kHead + "[interest]\nfull = 2\nreach = 1\n" + kCube, "R-SCN-6", 6,
       "interest.reach"},
      {"an unknown method", kHead + "[compensation]\nmethod = \"magic\"\n" + kCube, "R-SCN-7", 5, "compensation.method"},
      {"unknown grip", kHead + kCube + kTouch + "lift_stiffness = 68\n" + kUser + "grip = \"iron\"\n", "R-SCN-7", 18,
       "user.grip"},
      {"a duration that never ends", kHead + kCube + kTouch + "lift_stiffness = 68\n" + kUser + "duration_scale = 0\n", "R-SCN-6",
       18, "user.duration_scale"},
      {"half a filter step", kHead + kCube + kTouch + "lift_stiffness = 68\n" + kUser + "[user.device]\nfilter = 2.5\n",
       "R-SCN-5", 19, "user.device.filter"},
      {"instant movement",
       kHead + kCube + kTouch + "lift_stiffness = 68\n" + kUser + "[[user.path]]\nname = \"a\"\nto = [0, 0, 0]\nduration = 0\n",
       "R-SCN-6", 21, "user.path.duration"},
  };
  return cases;
}

TEST(Scene, EveryRuleNamesItsLocation) {
  std::set<std::string> rules;
  for (const Broken& c : broken()) {
    const auto scene = parse_scene(c.text, "t.toml");
    ASSERT_FALSE(scene) << c.why;
    EXPECT_STREQ(scene.error().error.rule, c.rule) << c.why;
    EXPECT_EQ(scene.error().line, c.line) << c.why;
    EXPECT_EQ(scene.error().detail, c.key) << c.why;
    EXPECT_EQ(scene.error().file, "t.toml") << c.why;
    EXPECT_FALSE(scene.error().remedy.empty()) << c.why;
    rules.insert(c.rule);
  }
  EXPECT_EQ(rules.size(), 6u);  // R-SCN-2 to R-SCN-7
}

TEST(Scene, CompensationIsThereWhenAskedFor) {
  EXPECT_FALSE(parse_scene(kHead + kCube, "test").value().compensation);
  const Scene usual = parse_scene(kHead + "[compensation]\n" + kCube, "test").value();
  ASSERT_TRUE(usual.compensation);
  EXPECT_FALSE(usual.compensation->filter) << "it goes by what is touched";
  EXPECT_EQ(usual.compensation->method, CompensationMethod::stiffness);
  const Scene simulated = parse_scene(kHead + "[compensation]\nmethod = \"simulation\"\n" + kCube, "test").value();
  EXPECT_EQ(simulated.compensation->method, CompensationMethod::simulation);
  EXPECT_FALSE(sends_loads(usual)) << "nobody is there who could push";
  const Scene asked =
      parse_scene(kHead + "[compensation]\nfilter = 0.5\n" + kCube + kTouch + "lift_stiffness = 68\nmax_damping = 20\n" + kUser,
                  "test")
          .value();
  EXPECT_EQ(asked.compensation->filter, 0.5);
  EXPECT_EQ(asked.touch->max_damping, 20);
  EXPECT_TRUE(sends_loads(asked));
}

TEST(Scene, DurationScaleAndTremorAreThoseOfEveryHand) {
  Scene scene = parse_scene(kHead + kCube + kTouch + "lift_stiffness = 68\n" + kUser + "duration_scale = 2\n", "t.toml").value();
  EXPECT_EQ(scene.users[0].duration_scale, 2);
  EXPECT_EQ(scene.duration, 1) << "a file says how long its scene lasts";
  scale_durations(scene, 0.5);
  set_tremor(scene, 4e-4);
  EXPECT_EQ(scene.users[0].duration_scale, 0.5 * 2);
  EXPECT_EQ(scene.users[0].tremor, 4e-4);
  EXPECT_EQ(scene.duration, 0.5);
}

TEST(Scene, AProbeMovesFartherThanItsDeviceByItsScale) {
  const std::string head = kHead + kCube + kTouch + "lift_stiffness = 68\n" + kUser +
                           "tremor = 1e-4\n[user.device]\nmax_force = 3\nresolution = 1e-5\n";
  const Scene plain = parse_scene(head, "t.toml").value();
  EXPECT_EQ(plain.users[0].device.scale, 1);
  Scene scaled = parse_scene(head + "scale = 4\n", "t.toml").value();
  const SceneUser& user = scaled.users[0];
  EXPECT_EQ(user.device.scale, 4);
  EXPECT_EQ(user.device.max_force, 4 * plain.users[0].device.max_force);
  EXPECT_EQ(user.device.resolution, 4 * plain.users[0].device.resolution);
  EXPECT_EQ(user.tremor, 4 * plain.users[0].tremor);
  EXPECT_EQ(user.start, plain.users[0].start);
  set_tremor(scaled, 1e-3);
  EXPECT_EQ(user.tremor, 4 * 1e-3);
  for (const char* wrong : {"0", "-1", "1e-4", "1001", "nan"})
    EXPECT_FALSE(parse_scene(head + "scale = " + wrong + "\n", "t.toml")) << wrong;
}

TEST(Scene, MissingFileIsAnError) {
  const auto scene = load_scene("no/such/scene.toml");
  ASSERT_FALSE(scene);
  EXPECT_STREQ(scene.error().error.rule, "R-SCN-1");
  EXPECT_EQ(scene.error().file, "no/such/scene.toml");
  ASSERT_FALSE(find_scene("no-such-scene"));
  EXPECT_STREQ(find_scene("no-such-scene").error().error.rule, "R-SCN-1");
}

TEST(Scene, EveryPrefixOfAFileIsASceneOrAnError) {
  const auto whole = load_scene(*find_scene("push-1dof"));
  ASSERT_TRUE(whole);
  std::size_t refused = 0;
  for (std::size_t n = 0; n < whole->text.size(); ++n) {
    const auto scene = parse_scene(std::string_view(whole->text).substr(0, n), "t.toml");
    if (!scene) {
      EXPECT_EQ(std::string_view(scene.error().error.rule).substr(0, 6), "R-SCN-");
      ++refused;
    }
  }
  EXPECT_GT(refused, whole->text.size() / 2);
}

TEST(Scene, ASurfaceFileThatCannotBeReadSaysWhy) {
  const auto scene = parse_scene(
      "name = \"t\"\nduration = 1.0\ngravity = [0, 0, 0]\n[[object]]\nname = \"o\"\nmass = 1\nfriction = 0\nposition = [0, 0, "
      "0]\n"
      "surface = \"no-such.obj\"\n",
      "t.toml");
  ASSERT_FALSE(scene);
  EXPECT_STREQ(scene.error().error.rule, "R-SCN-8");
  EXPECT_EQ(scene.error().line, 9u);
  const bool left_out = scene.error().error.code == Errc::unsupported;  // the component SURFACE
  EXPECT_NE(scene.error().remedy.find(left_out ? "TACTUS_WITH_SURFACE=ON" : "R-SRF-1"), std::string::npos)
      << scene.error().remedy;
  EXPECT_NE(scene.error().remedy.find("no-such.obj"), std::string::npos);
}

TEST(Scene, EveryShippedSceneLoadsByItsName) {
  const auto first = find_scene("push-1dof");
  ASSERT_TRUE(first) << to_string(first.error());
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(*first).parent_path())) {
    if (entry.path().extension() != ".toml") continue;
    const auto path = find_scene(entry.path().stem().string());
    ASSERT_TRUE(path);
    const auto scene = load_scene(*path);
    if (!scene && scene.error().error.code == Errc::unsupported) continue;  // a component is left out
    ASSERT_TRUE(scene) << to_string(scene.error());
    EXPECT_EQ(scene->name, entry.path().stem().string());
    names.insert(scene->name);
  }
  for (const char* wanted : {"push-1dof", "rotate-6dof", "rotate-push-lift"}) EXPECT_TRUE(names.contains(wanted)) << wanted;
}

/// A few bytes of text must not cost memory that nobody has.
TEST(Scene, WhatWouldTakeTooMuchIsRefusedBeforeItIsMade) {
  const auto error_of = [](const std::string& text) {
    const auto scene = parse_scene(text, "t.toml");
    return scene ? Diagnostic{} : scene.error();
  };
  const std::string slab = "position = [0, 0, 0]\nyoung = 1e4\npoisson = 0.3\ndensity = 1000\n";
  const auto cells = [&](const std::string& n) {
    return "name = \"t\"\nduration = 1\ngravity = [0, 0, 0]\n[[deformable]]\nname = \"d\"\ncell = 0.01\ncells = " + n + "\n" +
           slab;
  };
  EXPECT_STREQ(error_of(cells("[100, 100, 1]")).error.rule, Error{}.rule);
  for (const char* n : {"[300, 300, 1]", "[800, 800, 1]", "[1000, 1000, 1000]"}) {
    const Diagnostic error = error_of(cells(n));
    ASSERT_STREQ(error.error.rule, "R-SCN-6") << n;
    EXPECT_EQ(error.detail, "deformable.cells");
    EXPECT_NE(error.remedy.find("MB of memory"), std::string::npos) << error.remedy;
  }
  std::string several = cells("[140, 140, 1]");
  several += "[[deformable]]\nname = \"e\"\ncell = 0.01\ncells = [100, 100, 1]\n" + slab;
  EXPECT_STREQ(error_of(several).error.rule, "R-SCN-6") << "each alone is affordable";

  std::string objects = "name = \"t\"\nduration = 1\ngravity = [0, 0, 0]\n";
  for (int i = 0; i < 4097; ++i)
    objects +=
        "[[object]]\nname = \"o" + std::to_string(i) + "\"\nsize = [1, 1, 1]\nmass = 1\nfriction = 0\nposition = [0, 0, 0]\n";
  const Diagnostic error = error_of(objects);
  EXPECT_STREQ(error.error.rule, "R-SCN-6");
  EXPECT_EQ(error.detail, "object");
  EXPECT_NE(error.remedy.find("4097"), std::string::npos) << error.remedy;
}

/// Reading from a pipe or a device would wait for ever, or never end.
TEST(Scene, NamesOnlyRegularFiles) {
  const auto scene = parse_scene(
      "name = \"t\"\nduration = 1\ngravity = [0, 0, 0]\n[[object]]\nname = \"o\"\nsurface = \"/dev/zero\"\nmass = 1\n"
      "friction = 0\nposition = [0, 0, 0]\n",
      "t.toml");
  ASSERT_FALSE(scene);
  EXPECT_STREQ(scene.error().error.rule, "R-SCN-8");
  EXPECT_NE(scene.error().remedy.find("regular file"), std::string::npos) << scene.error().remedy;
  const auto mesh = parse_scene(
      "name = \"t\"\nduration = 1\ngravity = [0, 0, 0]\n[[deformable]]\nname = \"o\"\nmesh = \"/dev/zero\"\nyoung = 1e4\n"
      "poisson = 0.3\ndensity = 1000\nposition = [0, 0, 0]\n",
      "t.toml");
  ASSERT_FALSE(mesh);
  EXPECT_NE(mesh.error().remedy.find("regular file"), std::string::npos) << mesh.error().remedy;
}

/// Who opens a stranger's trace opens no other file of the machine.
TEST(Scene, OfATraceNamesNoPaths) {
  const std::string head = "name = \"t\"\nduration = 1\ngravity = [0, 0, 0]\n";
  const std::string body = "\nyoung = 1e4\npoisson = 0.3\ndensity = 1000\nposition = [0, 0, 0]\n";
  for (const char* file : {"/etc/hostname", "../scenes/bracket.obj", "./x"}) {
    const std::string solid =
        "[[object]]\nname = \"o\"\nsurface = \"" + std::string(file) + "\"\nmass = 1\nfriction = 0\nposition = [0, 0, 0]\n";
    const std::string soft = "[[deformable]]\nname = \"o\"\nmesh = \"" + std::string(file) + "\"" + body;
    for (const std::string& text : {head + solid, head + soft}) {
      const auto scene = parse_attached_scene(text);
      ASSERT_FALSE(scene) << text;
      EXPECT_STREQ(scene.error().error.rule, "R-SCN-8");
      EXPECT_NE(scene.error().remedy.find("come with Tactus"), std::string::npos) << scene.error().remedy;
    }
  }
  EXPECT_TRUE(parse_attached_scene(kHead + kCube));
  const auto shipped = load_scene(find_scene("bracket-and-pad").value());
  if (!shipped) GTEST_SKIP() << "without the components that it needs";
  const auto again = parse_attached_scene(shipped->text);
  ASSERT_TRUE(again) << to_string(again.error());
  EXPECT_EQ(again->objects.at(0).surface.triangles, shipped->objects.at(0).surface.triangles);
}

TEST(Scene, AWorldHasASize) {
  const auto grid = [](const std::string& text) {
    return scene_builder(parse_scene(text, "t.toml").value()).build().value()->grid.position;
  };
  EXPECT_EQ(grid(kHead + kCube), 22);
  EXPECT_EQ(grid("world_size = 5000\n" + kHead + kCube), 18);
}

TEST(Scene, ItsStreamStartsFromTheFirstPoses) {
  const auto scene = parse_scene(kHead + kCube + "dof = [\"x\", \"rz\"]\n", "t.toml");
  ASSERT_TRUE(scene);
  const auto built = scene_builder(*scene).build();
  ASSERT_TRUE(built);
  const SharedScene& declared = *built;
  EXPECT_EQ(declared->tick_rate, kTickRate);
  ASSERT_EQ(declared->objects.size(), 1u);
  EXPECT_EQ(declared->objects[0].name, "cube");
  EXPECT_EQ(declared->objects[0].dof, Dof::x | Dof::rz);
  EXPECT_EQ(declared->objects[0].initial.position, (std::array<std::int32_t, 3>{1 << 22, 2 << 22, 3 << 22}));
}

// ==== toml text ====

std::string repeated(const std::string& text, std::size_t times) {
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += text;
  return out;
}

TEST(TomlText, OrdinaryFilesAreNotNested) {
  EXPECT_FALSE(too_nested_line(""));
  EXPECT_FALSE(too_nested_line("a = 1.5\n[b.c]\nd = [[1.0, 2.0], [3.0]]\n"));
  EXPECT_FALSE(too_nested_line("a = \"" + repeated(".", 100) + "\" # " + repeated(".[", 100)));
  EXPECT_FALSE(too_nested_line("a = '''\n" + repeated(".[", 100) + "\n'''\nb = \"\"\"" + repeated("{.", 100) + "\\\"\"\"\"\n"));
  EXPECT_FALSE(too_nested_line(repeated("a = [1.5, 2.5]\n", 1000)));
}

TEST(TomlText, DottedKeysAndBracketsCount) {
  EXPECT_FALSE(too_nested_line("[" + repeated("a.", kMostTomlNesting - 1) + "a]"));
  EXPECT_EQ(too_nested_line("x = 1\n[" + repeated("a.", kMostTomlNesting) + "a]"), 2u);
  EXPECT_EQ(too_nested_line(repeated("\"a\" . ", kMostTomlNesting) + "a = 1"), 1u);
  EXPECT_EQ(too_nested_line("\n\nx = " + repeated("[", kMostTomlNesting + 1)), 3u);
  EXPECT_EQ(too_nested_line("x = " + repeated("{a = ", kMostTomlNesting + 1)), 1u);
}

TEST(TomlText, NothingHidesBehindAString) {
  const std::string deep = repeated("a.", 100) + "a = 1}";
  EXPECT_TRUE(too_nested_line("s = {k = \"\"\"x\"\"\"\", " + deep)) << "a quote before the last three belongs to the string";
  EXPECT_TRUE(too_nested_line("s = {k = '''x''''', " + deep));
  EXPECT_TRUE(too_nested_line("s = {k = \"x\\\"\", " + deep));
  EXPECT_TRUE(too_nested_line("s = {k = 'x\\', " + deep));
  EXPECT_TRUE(too_nested_line("s = {k = \"\", " + deep));
}

TEST(TomlText, ScenesAreRefusedBeforeTheyAreParsed) {
  const auto rule_of = [](const std::string& text) { return std::string(parse_scene(text, "s.toml").error().error.rule); };
  EXPECT_EQ(rule_of(repeated("a.", 31000) + "a = 1"), "R-SCN-9");
  EXPECT_EQ(rule_of("[" + repeated("a.", 31000) + "a]"), "R-SCN-9");
  EXPECT_EQ(rule_of("#" + std::string(std::size_t{4} << 20, 'x')), "R-SCN-9");
  EXPECT_EQ(rule_of("a = "), "R-SCN-2");
}

TEST(TomlText, TheTableOfRulesNamesItsLimit) {
  tactus::testing::expect_limits("R-SCN-9", {std::to_string(kMostTomlNesting) + " deep"});
}

}  // namespace
}  // namespace tactus::sim
