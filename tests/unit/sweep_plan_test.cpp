// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/sweep_plan.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/unit/temp_file.h"

namespace tactus::cli {
namespace {

/// A plan of a command with places for `a`, `b` and `c`, and these tables.
tl::expected<SweepPlan, Failure> plan_with(const std::string& tables) {
  const TempFile file(".toml");
  std::ofstream(file.path()) << "name = \"p\"\ncommand = [\"x\", \"{a}\", \"{b}\", \"{c}\"]\n"
                             << tables << "\n[measure]\nm = \"/m\"\n";
  return load_plan(file.path());
}

std::string error(const std::string& tables) {
  const auto plan = plan_with(tables);
  return plan ? "no error" : plan.error().text.substr(plan.error().text.find("toml:") + 5);
}

constexpr const char* kAxes = "[vary]\na = [\"1\", \"2\"]\n[[zip]]\nb = [\"x\", \"y\", \"z\"]\nc = [\"X\", \"Y\", \"Z\"]\n";

TEST(SweepPlan, ZippedParametersChangeTogether) {
  const auto plan = plan_with(kAxes);
  ASSERT_TRUE(plan) << plan.error().text;
  ASSERT_EQ(plan->points(), 6u);
  EXPECT_EQ(plan->values(0), (std::vector<std::string>{"1", "x", "X"}));
  EXPECT_EQ(plan->values(2), (std::vector<std::string>{"1", "z", "Z"}));
  EXPECT_EQ(plan->values(4), (std::vector<std::string>{"2", "y", "Y"}));
  EXPECT_NE(error("[vary]\na = [\"1\"]\n[[zip]]\nb = [\"x\", \"y\"]\nc = [\"X\"]\n").find("equally many"), std::string::npos);
}

TEST(SweepPlan, RangesKeepTheirUnit) {
  const auto plan = plan_with(
      "[vary]\na = { from = \"0.1mm\", to = \"10mm\", count = 3, scale = \"log\" }\nb = { from = \"0\", to = \"-1\", count = 5 "
      "}\nc = [\"1\"]\n");
  ASSERT_TRUE(plan) << plan.error().text;
  EXPECT_EQ(plan->parameters[0].values, (std::vector<std::string>{"0.1mm", "1mm", "10mm"}));
  EXPECT_EQ(plan->parameters[1].values, (std::vector<std::string>{"0", "-0.25", "-0.5", "-0.75", "-1"}));
  const auto range = [](const std::string& text) { return error("[vary]\na = { " + text + " }\nb = [\"1\"]\nc = [\"1\"]\n"); };
  EXPECT_NE(range("from = \"1mm\", to = \"1cm\", count = 2").find("one unit"), std::string::npos);
  EXPECT_NE(range("from = \"0\", to = \"1\", count = 2, scale = \"log\"").find("above 0"), std::string::npos);
  EXPECT_NE(range("from = \"mm\", to = \"1mm\", count = 2").find("write a number"), std::string::npos);
  EXPECT_NE(range("from = \"1\", to = \"inf\", count = 2").find("write a number"), std::string::npos);
  EXPECT_NE(range("from = \"1\", to = \"2\", count = 1").find("2 to 1000"), std::string::npos);
}

TEST(SweepPlan, ShardsAreAPartition) {
  const auto plan = plan_with(kAxes);
  ASSERT_TRUE(plan);
  for (std::size_t count = 1; count <= 8; ++count)
    for (std::size_t point = 0; point < plan->points(); ++point) {
      int owners = 0;
      for (std::size_t index = 1; index <= count; ++index) owners += plan->is_of(point, {index, count}) ? 1 : 0;
      EXPECT_EQ(owners, 1) << point << " of " << count;
    }
  EXPECT_TRUE(plan->is_of(0, {1, 3}) && plan->is_of(5, {1, 3})) << "each part gets several values of the last axis";
}

TEST(SweepPlan, RepetitionsAreNextToEachOther) {
  const auto plan = plan_with(
      "[[input]]\nname = \"in\"\nfile = \"in-{c}.mcap\"\ncommand = [\"sim\", \"--seed\", \"{c}\", \"-o\", \"{file}\"]\n"
      "[vary]\na = [\"in\", \"other\"]\nb = [\"1\"]\n[repeat]\nc = [\"7\", \"8\"]\n");
  ASSERT_TRUE(plan) << plan.error().text;
  EXPECT_EQ(plan->repetitions(), 2u);
  ASSERT_EQ(plan->files_of(1).size(), 1u);
  EXPECT_EQ(plan->files_of(1)[0].first, "in-8.mcap");
  EXPECT_EQ(plan->words(plan->inputs[0], 1, "made/in"), (std::vector<std::string>{"sim", "--seed", "8", "-o", "made/in"}));
  EXPECT_TRUE(plan->files_of(2).empty());
  EXPECT_EQ(plan->words(1, [](const std::string& file) { return "there/" + file; }),
            (std::vector<std::string>{"x", "there/in-8.mcap", "1", "8"}));
  EXPECT_NE(error("[vary]\na = [\"1\"]\n[repeat]\nb = [\"1\"]\nc = [\"1\"]\n").find("one parameter"), std::string::npos);
  EXPECT_NE(
      error("[[input]]\nname = \"in\"\nfile = \"in\"\ncommand = [\"{c}\"]\n[vary]\na = [\"in\"]\nb = [\"1\"]\nc = [\"1\"]\n")
          .find("write {c} into the name"),
      std::string::npos);
  EXPECT_NE(error("[[input]]\nname = \"in\"\nfile = \"in{c}\"\n[vary]\na = [\"in\"]\nb = [\"1\"]\nc = [\"/../x\"]\n")
                .find("letters, digits"),
            std::string::npos);
}

TEST(SweepPlan, DerivedColumnsUseWhatIsMeasured) {
  const std::string vary = "[vary]\na = [\"1\"]\nb = [\"1\"]\nc = [\"1\"]\n";
  const auto plan = plan_with(vary + "[time]\nt = \"/t\"\n[derive]\nd = \"m / a\"\ne = \"seconds + t\"\n");
  ASSERT_TRUE(plan) << plan.error().text;
  EXPECT_FALSE(plan->derived[0].from_times);
  EXPECT_TRUE(plan->derived[1].from_times);
  EXPECT_EQ(plan->all_columns(), (std::vector<std::string>{"a", "b", "c", "m", "host", "seconds", "t", "d", "e"}));
  EXPECT_NE(error(vary + "[derive]\nd = \"e\"\ne = \"m\"\n").find("not e"), std::string::npos);
  EXPECT_NE(error(vary + "[derive]\nd = \"m *\"\n").find("correct the formula"), std::string::npos);
  EXPECT_NE(error(vary + "[derive]\na = \"m\"\n").find("a name of its own"), std::string::npos);
  EXPECT_NE(error(vary + "[time]\nhost = \"/h\"\n").find("a name of its own"), std::string::npos);
}

}  // namespace
}  // namespace tactus::cli
