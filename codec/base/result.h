// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <tl/expected.hpp>
#include <utility>

namespace tactus {

/// Error classes. Names and values are normative (spec/registry.md); the same input yields the same class and rule in every build.
enum class Errc : std::uint8_t {
  truncated = 2,          ///< the input ends inside an element
  malformed = 3,          ///< syntax: a reserved bit is set, an encoding is not the shortest, bytes trail
  invalid = 4,            ///< semantics: a value outside its declared range
  unsupported = 5,        ///< a version, profile or required feature this build does not know
  limit_exceeded = 6,     ///< valid, but larger than the caller's limits
  checksum = 7,           ///< a check value does not match
  state = 8,              ///< protocol order: baseline not held, packet stale
  invalid_argument = 10,  ///< an argument of an API call is not finite or out of range
  io = 11,                ///< the operating system refused to read or write
  internal = 12,          ///< a defect of this library
};

/// Name of an error class as the specification writes it ("malformed").
const char* errc_name(Errc code) noexcept;

/// What went wrong, where, and which rule of the specification says so. No allocation; `rule` points to static text.
struct Error {
  Errc code = Errc::internal;
  const char* rule = "";         ///< name in spec/rules.csv, such as "R-STR-4"
  std::uint64_t bit_offset = 0;  ///< position in the input where the rule was broken, in bits; 0 when there is none
};

/// The error in words: "the check value of a record does not match". Static text, like all of spec/rules.csv.
const char* describe(const Error& error) noexcept;
/// A sentence on how to fix it. Empty for a rule that is not in spec/rules.csv.
const char* remedy(const Error& error) noexcept;

/// How a receiver reacts to a packet or a scene declaration that it cannot decode (spec/95-security.md, section 5).
enum class Advice : std::uint8_t {
  none,         ///< the rule concerns calls or files, not received data
  drop,         ///< ignore the packet: it is damaged, late, or a copy; the receiver's state is unchanged
  request_key,  ///< ask the sender for a key packet: the baseline is not held
  close,        ///< neither the scene declaration nor the packets after it can be used
};
Advice advice(const Error& error) noexcept;

template <class T>
using Result = tl::expected<T, Error>;

#ifdef TACTUS_BREAK_ON_ERROR
[[gnu::noinline]] void break_on_error() noexcept;  ///< set a debugger breakpoint here to stop where an error is created
#endif

}  // namespace tactus

#define TACTUS_CONCAT_(a, b) a##b
#define TACTUS_CONCAT(a, b) TACTUS_CONCAT_(a, b)
#define TACTUS_TRY_(tmp, lhs, ...)                                \
  auto tmp = (__VA_ARGS__);                                       \
  if (!tmp) return ::tl::make_unexpected(std::move(tmp).error()); \
  lhs = *std::move(tmp)
/// `TACTUS_TRY(auto x, f());` binds the value of f() or returns its error, whatever its type. The only other error macro:
#define TACTUS_TRY(lhs, ...) TACTUS_TRY_(TACTUS_CONCAT(tactus_try_, __LINE__), lhs, __VA_ARGS__)
/// `TACTUS_CHECK(f());` returns the error of f(); its value, if any, is discarded.
#define TACTUS_CHECK(...)                                                                                                \
  do {                                                                                                                   \
    if (auto tactus_check = (__VA_ARGS__); !tactus_check) return ::tl::make_unexpected(std::move(tactus_check).error()); \
  } while (false)
