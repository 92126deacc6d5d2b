// SPDX-License-Identifier: Apache-2.0
/// Assembles messages into frames: one assembler for our own files, one for foreign ones.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <tactus/base/diagnostic.h>
#include <tactus/base/result.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/mcap_reader.h>
#include <tactus/trace/read_notes.h>
#include <tactus/trace/trace_file.h>

namespace tactus {

class FrameAssembler {
 public:
  virtual ~FrameAssembler() = default;
  virtual Result<bool> next(mcap::Reader& mcap, TraceFrame& frame) = 0;
  virtual const TraceInfo& info() const noexcept = 0;
  /// The channel that has one message per frame, if there is one.
  virtual std::optional<std::uint16_t> frame_channel() const noexcept = 0;
  /// What was decided so far; none: nothing ever is.
  virtual const ReadNotes* notes() const noexcept { return nullptr; }
  /// Words of the last error; null: its location in the file says all.
  virtual const Diagnostic* refused() const noexcept { return nullptr; }
};

/// What a file holds ahead of its first message.
struct Preamble {
  mcap::Item item = mcap::Item::end;     ///< current item of the reader: a message, or the end
  std::optional<mcap::TextMap> tactus;   ///< our metadata record
  std::optional<mcap::TextMap> bounds;   ///< metadata record of the bounds
  std::optional<mcap::TextMap> capture;  ///< and of the capture
  std::string scene;
};

/// For files with our metadata record.   err  R-TRC-3, 7, 12; next(): R-TRC-7, 13, 14, 15
Result<std::unique_ptr<FrameAssembler>> assemble_tactus(mcap::Reader& mcap, const Preamble& preamble);

/// For other files. `ahead` reads the same bytes from the front, for a look at all of them before the first frame; without it, as of a
/// pipe, the look goes a bounded way.   err  R-TRC-16, and of its samples, if none is fit or all must be, R-TRC-7, 13, 14, 15;
///      next(): R-TRC-15, 18
tl::expected<std::unique_ptr<FrameAssembler>, Diagnostic> assemble_ros(mcap::Reader& mcap, std::optional<mcap::Reader> ahead,
                                                                       const Preamble& preamble, const ReadOptions& options);

/// Whether a channel carries messages of this type in CDR.
bool carries(const mcap::Reader& mcap, const mcap::Channel& channel, std::string_view schema);

}  // namespace tactus
