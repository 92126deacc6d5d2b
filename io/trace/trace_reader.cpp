// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/rule.h>
#include <tactus/trace/frame_assembler.h>
#include <tactus/trace/trace_bounds.h>
#include <tactus/trace/trace_capture.h>
#include <tactus/trace/trace_file.h>

namespace tactus {
namespace {

Result<Preamble> read_preamble(mcap::Reader& mcap) {
  Preamble preamble;
  while (true) {
    TACTUS_TRY(preamble.item, mcap.next());
    switch (preamble.item) {
      case mcap::Item::metadata:
        if (mcap.metadata().name == "tactus") preamble.tactus = mcap.metadata().entries;
        if (mcap.metadata().name == kBoundsMetadata) preamble.bounds = mcap.metadata().entries;
        if (mcap.metadata().name == kCaptureMetadata) preamble.capture = mcap.metadata().entries;
        break;
      case mcap::Item::attachment: {
        const mcap::Attachment& attachment = mcap.attachment();
        if (attachment.name == "scene.toml") preamble.scene.assign(attachment.data.begin(), attachment.data.end());
        break;
      }
      case mcap::Item::message:
      case mcap::Item::end:
        return preamble;
    }
  }
}

}  // namespace

bool carries(const mcap::Reader& mcap, const mcap::Channel& channel, std::string_view schema) {
  const auto found = mcap.schemas().find(channel.schema_id);
  return channel.message_encoding == "cdr" && found != mcap.schemas().end() && found->second.name == schema;
}

struct TraceReader::Impl {
  template <class Open>
  static tl::expected<TraceReader, Diagnostic> open(const Open& source, const ReadOptions& options);

  mcap::Reader mcap;
  std::optional<mcap::Statistics> statistics;
  std::unique_ptr<FrameAssembler> assembler;
};

namespace {

template <class T>
tl::expected<T, Diagnostic> told(Result<T> result) {
  if (!result) return tl::unexpected(Diagnostic{.error = result.error()});
  return std::move(*result);
}

}  // namespace

/// in  source  opens the bytes; twice, if they can be read twice
template <class Open>
tl::expected<TraceReader, Diagnostic> TraceReader::Impl::open(const Open& source, const ReadOptions& options) try {
  TACTUS_TRY(ByteSource bytes, told(source()));
  const bool is_rereadable = bytes.size().has_value();
  TACTUS_TRY(auto mcap, told(mcap::Reader::open(std::move(bytes))));
  auto statistics = mcap.statistics();
  TACTUS_TRY(const Preamble preamble, told(read_preamble(mcap)));
  std::unique_ptr<FrameAssembler> assembler;
  if (preamble.tactus) {
    TACTUS_TRY(assembler, told(assemble_tactus(mcap, preamble)));
  } else {
    std::optional<mcap::Reader> ahead;
    if (is_rereadable) {
      TACTUS_TRY(ByteSource again, told(source()));
      TACTUS_TRY(ahead, told(mcap::Reader::open(std::move(again))));
    }
    TACTUS_TRY(assembler, assemble_ros(mcap, std::move(ahead), preamble, options));
  }
  return TraceReader(std::make_unique<Impl>(Impl{std::move(mcap), std::move(statistics), std::move(assembler)}));
} catch (const std::bad_alloc&) {
  return tl::unexpected(Diagnostic{.error = out_of_memory().value()});
}

tl::expected<TraceReader, Diagnostic> TraceReader::open(const std::string& path, const ReadOptions& options) {
  auto reader = Impl::open([&] { return ByteSource::open_file(path); }, options);
  if (!reader && reader.error().file.empty()) reader.error().file = path;
  return reader;
}

Result<TraceReader> TraceReader::open(const std::string& path) try {
  auto reader = Impl::open([&] { return ByteSource::open_file(path); }, {});
  if (!reader) return tl::unexpected(reader.error().error);
  return std::move(*reader);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<TraceReader> TraceReader::open_memory(std::span<const std::uint8_t> bytes) {
  auto reader = Impl::open([&]() -> Result<ByteSource> { return ByteSource::over_memory(bytes); }, {});
  if (!reader) return tl::unexpected(reader.error().error);
  return std::move(*reader);
}

const std::vector<ReadNote>& TraceReader::notes() const noexcept {
  static const std::vector<ReadNote> none;
  const ReadNotes* notes = impl_->assembler->notes();
  return notes == nullptr ? none : notes->all();
}

Diagnostic TraceReader::explain(const Error& error) const { return {.error = error, .detail = impl_->assembler->detail()}; }

const TraceInfo& TraceReader::info() const noexcept { return impl_->assembler->info(); }

std::optional<std::uint64_t> TraceReader::frame_count() const noexcept {
  const auto channel = impl_->assembler->frame_channel();
  if (!channel || !impl_->statistics) return std::nullopt;
  const auto& counts = impl_->statistics->channel_message_counts;
  const auto found = counts.find(*channel);
  return found == counts.end() ? std::nullopt : std::optional(found->second);
}

Result<bool> TraceReader::next(TraceFrame& frame) try {
  return impl_->assembler->next(impl_->mcap, frame);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

bool TraceReader::cut_short() const noexcept { return impl_->mcap.cut_short(); }

TraceReader::TraceReader(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
TraceReader::TraceReader(TraceReader&&) noexcept = default;
TraceReader& TraceReader::operator=(TraceReader&&) noexcept = default;
TraceReader::~TraceReader() = default;

}  // namespace tactus
