// SPDX-License-Identifier: Apache-2.0
/// Assembles messages into frames: one assembler for our own files, one for foreign ones.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <tactus/base/result.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/mcap_reader.h>

namespace tactus {

class FrameAssembler {
 public:
  virtual ~FrameAssembler() = default;
  virtual Result<bool> next(mcap::Reader& mcap, TraceFrame& frame) = 0;
  virtual const TraceInfo& info() const noexcept = 0;
  /// The channel that has one message per frame, if there is one.
  virtual std::optional<std::uint16_t> frame_channel() const noexcept = 0;
};

/// What a file tells ahead of its first message.
struct Preamble {
  mcap::Item item = mcap::Item::end;     ///< current item of the reader: a message, or the end
  std::optional<mcap::TextMap> tactus;   ///< our metadata record
  std::optional<mcap::TextMap> bounds;   ///< metadata record of the bounds
  std::optional<mcap::TextMap> capture;  ///< and of the capture
  std::string scene;
};

/// For files with our metadata record.   err  R-TRC-3, 7, 12; next(): R-TRC-7, 13, 14, 15
Result<std::unique_ptr<FrameAssembler>> assemble_tactus(mcap::Reader& mcap, const Preamble& preamble);

/// For other files; reads ahead.   err  R-TRC-16; next(): R-TRC-7, 13, 14, 15, 16
Result<std::unique_ptr<FrameAssembler>> assemble_ros(mcap::Reader& mcap, const Preamble& preamble);

/// Whether a channel carries messages of this type in CDR.
bool carries(const mcap::Reader& mcap, const mcap::Channel& channel, std::string_view schema);

}  // namespace tactus
