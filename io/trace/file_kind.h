// SPDX-License-Identifier: Apache-2.0
/// What a file is that is no MCAP file: named from its first bytes, with the command that makes one of it. Internal to the library.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <tactus/base/diagnostic.h>
#include <tactus/trace/mcap.h>

namespace tactus {

inline constexpr std::size_t kKindBytes = 512;  ///< so many show what a file is

// Remedies: what makes MCAP of other bags. FILE stands for the name, NEW for the folder that comes out.
inline constexpr const char* kConvertBag =
    "With the Python package rosbags: `rosbags-convert --src FILE --dst NEW --dst-storage mcap`, then give the folder NEW.";
inline constexpr const char* kConvertDatabase =
    "`ros2 bag convert -i FILE -o mcap.yaml`, where mcap.yaml holds "
    "`output_bags: [{uri: NEW, storage_id: mcap, all_topics: true, all_services: true}]`, then give the folder NEW.";

/// R-TRC-2 or R-TRC-3 for a file that does not begin with MCAP's magic bytes.
///   in  first  its first bytes, up to kKindBytes;  path  may be empty
Diagnostic not_mcap(std::span<const std::uint8_t> first, const std::string& path);

/// R-TRC-16 or R-TRC-7 for a file whose channels hold nothing that a trace can be made of: its topics by encoding.
Diagnostic nothing_of_use(const std::map<std::uint16_t, mcap::Schema>& schemas,
                          const std::map<std::uint16_t, mcap::Channel>& channels, const std::string& path);

}  // namespace tactus
