// SPDX-License-Identifier: Apache-2.0
/// SHA-256 (FIPS 180-4), for the check values of vectors.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace tactus::conformance {

std::string sha256_hex(std::span<const std::uint8_t> data);

}  // namespace tactus::conformance
