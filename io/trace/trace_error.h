// SPDX-License-Identifier: Apache-2.0
/// An error of a recording with what its reader knows of the place and the cause.
#pragma once

#include <string>

#include <tactus/base/result.h>

namespace tactus {

/// An Error that says more; where an Error is wanted, it is one.
struct TraceError : Error {
  TraceError() = default;
  TraceError(const Error& error) : Error(error) {}  // NOLINT(google-explicit-constructor): every error can be said with less
  TraceError(const Error& error, std::string what_, std::string remedy_)
      : Error(error), what(std::move(what_)), remedy(std::move(remedy_)) {}

  std::string place{};   ///< beside bit_offset: "bag_1.mcap, chunk 3, /cup/pose at 3.021 s"; may be empty
  std::string what{};    ///< the cause in place of the rule's general sentence; may be empty
  std::string remedy{};  ///< what mends it in place of the rule's general one; may be empty
};

template <class T>
using TraceResult = tl::expected<T, TraceError>;

}  // namespace tactus
