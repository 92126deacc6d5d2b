// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/formula.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace tactus::cli {
namespace {

double value(const char* text) {
  const auto formula = Formula::parse(text);
  EXPECT_TRUE(formula) << text << ": " << formula.error();
  return formula ? formula->value([](const std::string& name) {
    return name == "a" ? 6.0 : name == "b_N.1" ? 0.5 : std::nan("");
  })
                 : 0;
}

TEST(Formula, FollowsPrecedenceFromTheLeft) {
  EXPECT_EQ(value("1 + 2 * 3 - 4 / 2 / 2"), 6);
  EXPECT_EQ(value("10 - 4 - 3"), 3);
  EXPECT_EQ(value("(1 + 2)*(3-4)"), -3);
  EXPECT_EQ(value("--2 * -a"), -12);
  EXPECT_EQ(value("a / b_N.1 * 1e3"), 12000);
  EXPECT_TRUE(std::isinf(value("a / 0")));
  EXPECT_TRUE(std::isnan(value("other + 1")));
}

TEST(Formula, NamesWhatItUses) {
  EXPECT_EQ(Formula::parse("a * (b + a) / 2")->names(), (std::vector<std::string>{"a", "b", "a"}));
}

TEST(Formula, TellsWhereItIsWrong) {
  const auto error = [](const std::string& text) { return Formula::parse(text).error(); };
  EXPECT_EQ(error("a +"), "a number or the name of a column is wanted at character 4");
  EXPECT_EQ(error("(a"), "a ) is wanted at character 3");
  EXPECT_EQ(error("a b"), "an operator is wanted at character 3");
  EXPECT_EQ(error("2a"), "an operator is wanted at character 2");
  EXPECT_EQ(error(""), "a number or the name of a column is wanted at character 1");
  EXPECT_EQ(error("system('x')"), "an operator is wanted at character 7");
  EXPECT_EQ(error(std::string(40, '(') + "1"), "an end of the parentheses is wanted at character 33");
  EXPECT_EQ(error(std::string(256, '1')), "it has more than 255 bytes");
  EXPECT_TRUE(Formula::parse(std::string(31, '(') + "1" + std::string(31, ')')));
}

}  // namespace
}  // namespace tactus::cli
