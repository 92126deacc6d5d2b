// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/scene/toml_reader.h>

#include <gtest/gtest.h>

#include <string>

#include <tactus/sim/scene/scene.h>

#include "tests/unit/rule_fixture.h"

namespace tactus::sim {
namespace {

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
