// SPDX-License-Identifier: Apache-2.0
/// Formulas over named numbers: + - * / and parentheses.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace tactus::cli {

class Formula {
 public:
  /// "force_rms_N / force_mean_N * 100". A name begins with a letter and has letters, digits, '_' and '.'.
  /// err  what is wrong and where, as a sentence without an end
  static tl::expected<Formula, std::string> parse(std::string_view text);

  std::vector<std::string> names() const;  ///< that it uses; one may stand there twice
  double value(const std::function<double(const std::string&)>& of_name) const;

 private:
  struct Step {
    enum class Kind { number, name, negate, add, subtract, multiply, divide } kind;
    double number = 0;
    std::string name{};
  };
  friend class FormulaParser;

  std::vector<Step> steps_;  // in the order of a stack machine
};

}  // namespace tactus::cli
