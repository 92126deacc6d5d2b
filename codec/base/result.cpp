// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/result.h>

#include <algorithm>
#include <iterator>
#include <string_view>

namespace tactus {

// ==== result ====

namespace {

struct Action {
  std::string_view rule;
  Advice advice;
};

#define TACTUS_RULE(name, action, fault, remedy) {name, Advice::action},
constexpr Action kActions[] = {
#include <tactus_rules.inc>
};
#undef TACTUS_RULE

}  // namespace

Advice advice(const Error& error) noexcept {
  for (const Action& action : kActions)
    if (action.rule == error.rule) return action.advice;
  return Advice::none;
}

const char* errc_name(Errc code) noexcept {
  switch (code) {
    case Errc::truncated:
      return "truncated";
    case Errc::malformed:
      return "malformed";
    case Errc::invalid:
      return "invalid";
    case Errc::unsupported:
      return "unsupported";
    case Errc::limit_exceeded:
      return "limit_exceeded";
    case Errc::checksum:
      return "checksum";
    case Errc::state:
      return "state";
    case Errc::invalid_argument:
      return "invalid_argument";
    case Errc::io:
      return "io";
    case Errc::internal:
      return "internal";
  }
  return "unknown";
}

#ifdef TACTUS_BREAK_ON_ERROR
void break_on_error() noexcept { asm volatile(""); }
#endif

// ==== rule texts ====

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
