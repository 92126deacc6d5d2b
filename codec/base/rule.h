// SPDX-License-Identifier: Apache-2.0
/// Creates errors. A rule name that is not in spec/rules.csv does not compile. Internal to the libraries.
#pragma once

#include <new>
#include <string_view>

#include <tactus/base/result.h>

#ifdef __FAST_MATH__
#error "Compile the sources of Tactus without -ffast-math: both ends compute the same bits, and NaN is refused."
#endif

namespace tactus {

// ==== rule ====
// Creates errors. A rule name that is not in spec/rules.csv does not compile.

namespace detail {

#define TACTUS_RULE(name, action, fault, remedy) name,
inline constexpr std::string_view kRuleNames[] = {
#include <tactus_rules.inc>
};
#undef TACTUS_RULE

void not_in_rules_csv();  // not constexpr: calling it stops the compiler

}  // namespace detail

/// Name of a rule, such as "R-STR-4", or none (false).
class RuleName {
 public:
  constexpr RuleName() = default;
  consteval RuleName(const char* name) : name_(name) {  // not explicit: a literal is a rule
    for (const std::string_view known : detail::kRuleNames)
      if (known == name) return;
    detail::not_in_rules_csv();
  }
  constexpr operator const char*() const noexcept { return name_; }  // as Error::rule

 private:
  const char* name_ = nullptr;
};

/// Make the unexpected value of any Result.   pre  `rule` is not none
inline tl::unexpected<Error> fail(Errc code, RuleName rule, std::uint64_t bit_offset = 0) noexcept {
#ifdef TACTUS_BREAK_ON_ERROR
  break_on_error();
#endif
  return tl::unexpected<Error>(Error{code, rule, bit_offset});
}

/// The same error at another position of the input.
inline tl::unexpected<Error> fail_at(const Error& error, std::uint64_t bit_offset) noexcept {
  return tl::unexpected<Error>(Error{error.code, error.rule, bit_offset});
}

// ==== out of memory ====
// Allocation failure as an error. Functions that return a Result never throw: those that allocate catch std::bad_alloc and
// return this error. They leak nothing and leave existing objects unchanged. Constructors, copies and functions with any other
// return type throw.

inline tl::unexpected<Error> out_of_memory() noexcept { return fail(Errc::limit_exceeded, "R-API-11"); }

}  // namespace tactus
