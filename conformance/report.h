// SPDX-License-Identifier: Apache-2.0
/// What our decoder says about a stream file, in the words of the testee contract (conformance/README.md).
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>

#include <tactus/base/result.h>
#include <tactus/client/replica.h>

namespace tactus::conformance {

/// Decode a whole stream file and write one JSON line for the header, for every packet and for the end.
/// in  replica  also run a client of this kind: adds the hashes of the poses it shows
///     device   the first moving object is that client's device
/// err  the rule that the file breaks; the lines written before it stand.
Result<void> report(std::span<const std::uint8_t> file, std::optional<Interpolation> replica, bool device, std::ostream& out);

/// The line that ends the output for a rejected file.
void report_error(const char* errc, const char* rule, std::ostream& out);

}  // namespace tactus::conformance
