// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/formula.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>

namespace tactus::cli {
namespace {

constexpr std::size_t kMostText = 255;  // [bytes]
constexpr int kDeepest = 32;            // parentheses and signs inside each other

bool starts_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool goes_on_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }

}  // namespace

/// One function for each level of precedence.
class FormulaParser {
 public:
  explicit FormulaParser(std::string_view text) : text_(text) {}

  tl::expected<Formula, std::string> parse() {
    if (text_.size() > kMostText) return tl::unexpected(fmt::format("it has more than {} bytes", kMostText));
    sum(0);
    if (error_.empty() && peek() != '\0') fail("an operator");
    if (!error_.empty()) return tl::unexpected(error_);
    return std::move(formula_);
  }

 private:
  using Kind = Formula::Step::Kind;

  void fail(const char* wanted) {
    if (error_.empty()) error_ = fmt::format("{} is wanted at character {}", wanted, at_ + 1);
    at_ = text_.size();
  }

  char peek() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }

  void add(Kind kind) { formula_.steps_.push_back({kind}); }

  void sum(int depth) {
    product(depth);
    for (char c = peek(); c == '+' || c == '-'; c = peek()) {
      ++at_;
      product(depth);
      add(c == '+' ? Kind::add : Kind::subtract);
    }
  }

  void product(int depth) {
    factor(depth);
    for (char c = peek(); c == '*' || c == '/'; c = peek()) {
      ++at_;
      factor(depth);
      add(c == '*' ? Kind::multiply : Kind::divide);
    }
  }

  void factor(int depth) {
    const char c = peek();
    if (depth == kDeepest) return fail("an end of the parentheses");
    if (c == '-') {
      ++at_;
      factor(depth + 1);
      add(Kind::negate);
    } else if (c == '(') {
      ++at_;
      sum(depth + 1);
      if (peek() != ')') return fail("a )");
      ++at_;
    } else if (starts_name(c)) {
      const std::size_t begin = at_;
      while (at_ < text_.size() && goes_on_name(text_[at_])) ++at_;
      formula_.steps_.push_back({Kind::name, 0, std::string(text_.substr(begin, at_ - begin))});
    } else {
      number();
    }
  }

  void number() {
    double value = 0;
    const auto read = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (read.ec != std::errc()) return fail("a number or the name of a column");
    at_ = static_cast<std::size_t>(read.ptr - text_.data());
    formula_.steps_.push_back({Kind::number, value});
  }

  std::string_view text_;
  std::size_t at_ = 0;
  Formula formula_;
  std::string error_;
};

tl::expected<Formula, std::string> Formula::parse(std::string_view text) { return FormulaParser(text).parse(); }

std::vector<std::string> Formula::names() const {
  std::vector<std::string> out;
  for (const Step& step : steps_)
    if (step.kind == Step::Kind::name) out.push_back(step.name);
  return out;
}

double Formula::value(const std::function<double(const std::string&)>& of_name) const {
  std::vector<double> stack;
  for (const Step& step : steps_) {
    if (step.kind == Step::Kind::number) {
      stack.push_back(step.number);
    } else if (step.kind == Step::Kind::name) {
      stack.push_back(of_name(step.name));
    } else if (step.kind == Step::Kind::negate) {
      stack.back() = -stack.back();
    } else {
      const double right = stack.back();
      stack.pop_back();
      double& left = stack.back();
      if (step.kind == Step::Kind::add) left += right;
      else if (step.kind == Step::Kind::subtract) left -= right;
      else if (step.kind == Step::Kind::multiply) left *= right;
      else left /= right;
    }
  }
  return stack.back();
}

}  // namespace tactus::cli
