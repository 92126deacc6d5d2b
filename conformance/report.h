// SPDX-License-Identifier: Apache-2.0
/// What our decoder says about a stream file, in the words of the testee contract (conformance/README.md).
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>

#include <tactus/base/result.h>
#include <tactus/client/replica.h>
#include <tactus/thesis/if_built.h>

namespace tactus::conformance {

struct TesteeOptions {
  std::optional<Interpolation> replica;               ///< also run a client of this kind: adds the hashes of the poses it shows
  bool device = false;                                ///< the first moving object is that client's device
  const ThesisComponent* thesis = thesis_if_built();  ///< null: a decoder without it
};

/// Decode a whole stream file and write one JSON line for the header, for every packet and for the end.
/// err  the rule that the file breaks; the lines written before it stand.
Result<void> report(std::span<const std::uint8_t> file, const TesteeOptions& options, std::ostream& out);

/// The line that ends the output for a rejected file.
void report_error(const char* errc, const char* rule, std::ostream& out);

}  // namespace tactus::conformance
