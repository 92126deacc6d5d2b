// SPDX-License-Identifier: Apache-2.0
/// Which files make up a recording: one file, or those of a bag's folder in order of time. Internal to the library.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/trace/byte_source.h>
#include <tactus/trace/read_notes.h>

namespace tactus {

/// A recording as it lies there. Can be opened again and again, unless it is a pipe.
struct RecordingFiles {
  std::vector<std::string> paths{};  ///< in order; empty: memory
  std::span<const std::uint8_t> memory{};
  bool is_folder = false;
  std::vector<ReadNote> notes{};                      ///< what was decided on the way
  std::optional<std::uint64_t> announced_messages{};  ///< of metadata.yaml

  std::size_t count() const noexcept { return paths.empty() ? 1 : paths.size(); }
  /// Of all files; nothing if one is a pipe: then they cannot be read twice.
  std::optional<std::uint64_t> bytes() const;
  /// "bag_1.mcap" of a folder with several files, else empty.
  std::string name(std::size_t number) const;
  Result<ByteSource> open(std::size_t number) const;
};

enum class MissingFiles : std::uint8_t { refuse, leave_out };

/// The files behind `path`: itself, or, of a folder or its metadata.yaml, what that lists, in order of the times of their first messages
/// where all state them, else as listed. A folder without metadata.yaml: its .mcap files in order of their names and numbers, with a note.
/// err  io R-TRC-1: a file that metadata.yaml lists is missing; unsupported R-TRC-2: no bag, or one of another storage, is in the folder;
///      unsupported R-TRC-7: a compression that is not read; limit_exceeded R-TRC-5: over 16 MiB of metadata.yaml, or 4096 files
tl::expected<RecordingFiles, Diagnostic> files_of(const std::string& path, MissingFiles missing = MissingFiles::refuse);

/// What of metadata.yaml is read; everything else in it is also in the files themselves.
struct BagMetadata {
  std::string storage;                               ///< storage_identifier
  std::string compression_format, compression_mode;  ///< "zstd"; "FILE" or "MESSAGE"; empty: none
  std::vector<std::string> files;                    ///< relative_file_paths
  std::optional<std::uint64_t> message_count;
};
/// The lines of YAML that rosbag2 writes: one key a line, lists with dashes.
BagMetadata parse_bag_metadata(std::string_view yaml);

}  // namespace tactus
