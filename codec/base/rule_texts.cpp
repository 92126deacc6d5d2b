// SPDX-License-Identifier: Apache-2.0
/// Sentences of spec/rules.csv. In a file of its own, so that programs that never show them do not link them.
#include <algorithm>
#include <iterator>
#include <string_view>

#include <tactus/base/result.h>

namespace tactus {
namespace {

struct RuleText {
  std::string_view rule;
  const char* fault;
  const char* remedy;
};

#define TACTUS_RULE(name, action, fault, remedy) {name, fault, remedy},
constexpr RuleText kRules[] = {
#include <tactus_rules.inc>
};
#undef TACTUS_RULE

constexpr RuleText kUnknown{"", "it breaks a rule that this version does not know", ""};

const RuleText& text_of(const Error& error) noexcept {
  const auto* found = std::find_if(std::begin(kRules), std::end(kRules), [&](const RuleText& r) { return r.rule == error.rule; });
  return found == std::end(kRules) ? kUnknown : *found;
}

}  // namespace

const char* describe(const Error& error) noexcept { return text_of(error).fault; }
const char* remedy(const Error& error) noexcept { return text_of(error).remedy; }

}  // namespace tactus
