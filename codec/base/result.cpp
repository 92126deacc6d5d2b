// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/result.h>

#include <string_view>

namespace tactus {

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

}  // namespace tactus
