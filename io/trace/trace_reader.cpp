// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/trace/file_kind.h>
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

constexpr const char* kReadTypes[] = {"geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TwistStamped",
                                      "nav_msgs/msg/Odometry",         "geometry_msgs/msg/WrenchStamped",
                                      "tf2_msgs/msg/TFMessage",        "geometry_msgs/msg/TransformStamped"};

}  // namespace

bool carries(const mcap::Reader& mcap, const mcap::Channel& channel, std::string_view schema) {
  const auto found = mcap.schemas().find(channel.schema_id);
  return channel.message_encoding == "cdr" && found != mcap.schemas().end() && found->second.name == schema;
}

struct TraceReader::Impl {
  static tl::expected<TraceReader, Diagnostic> open(const RecordingFiles& files, const ReadOptions& options);

  mcap::Reader mcap;
  std::optional<mcap::Statistics> statistics;
  std::unique_ptr<FrameAssembler> assembler;
};

namespace {

/// Why no trace can be made of a foreign file: when there is nothing of use in it, what there is.
Diagnostic refused_foreign(const mcap::Reader& mcap, Diagnostic error) {
  const auto is_of_use = [&](const auto& entry) {
    return std::ranges::any_of(kReadTypes, [&](const char* type) { return carries(mcap, entry.second, type); });
  };
  if (error.error.rule != std::string_view("R-TRC-16") || std::ranges::any_of(mcap.channels(), is_of_use)) return error;
  return nothing_of_use(mcap.schemas(), mcap.channels(), mcap.files().paths.empty() ? "" : mcap.files().paths.front());
}

}  // namespace

tl::expected<TraceReader, Diagnostic> TraceReader::Impl::open(const RecordingFiles& files, const ReadOptions& options) {
  TACTUS_TRY(auto mcap, mcap::Reader::open(files, options.on_damage));
  auto statistics = mcap.statistics();
  const auto preamble = read_preamble(mcap);
  if (!preamble) return tl::unexpected(mcap.explain(preamble.error()));
  std::unique_ptr<FrameAssembler> assembler;
  if (preamble->tactus) {
    auto made = assemble_tactus(mcap, *preamble);
    if (!made) return tl::unexpected(mcap.explain(made.error()));
    assembler = *std::move(made);
  } else {
    std::optional<mcap::Reader> ahead;
    if (const auto bytes = files.bytes()) {
      TACTUS_TRY(ahead, mcap::Reader::open(files, options.on_damage));
      ahead->watch(options.watcher, *bytes);
    }
    auto made = assemble_ros(mcap, std::move(ahead), *preamble, options);
    if (!made) return tl::unexpected(refused_foreign(mcap, std::move(made).error()));
    assembler = *std::move(made);
  }
  return TraceReader(std::make_unique<Impl>(Impl{std::move(mcap), std::move(statistics), std::move(assembler)}));
}

tl::expected<TraceReader, Diagnostic> TraceReader::open(const std::string& path, const ReadOptions& options) try {
  auto reader = files_of(path, options.on_damage == OnDamage::skip ? MissingFiles::leave_out : MissingFiles::refuse)
                    .and_then([&](const RecordingFiles& files) { return Impl::open(files, options); });
  if (!reader) reader.error().file = path;
  return reader;
} catch (const std::bad_alloc&) {
  return tl::unexpected(Diagnostic{.error = out_of_memory().value()});
}

Result<TraceReader> TraceReader::open(const std::string& path) {
  return open(path, {}).map_error([](const Diagnostic& error) { return error.error; });
}

tl::expected<TraceReader, Diagnostic> TraceReader::open_memory(std::span<const std::uint8_t> bytes,
                                                               const ReadOptions& options) try {
  return Impl::open({.memory = bytes}, options);
} catch (const std::bad_alloc&) {
  return tl::unexpected(Diagnostic{.error = out_of_memory().value()});
}

Result<TraceReader> TraceReader::open_memory(std::span<const std::uint8_t> bytes) {
  return open_memory(bytes, {}).map_error([](const Diagnostic& error) { return error.error; });
}

std::vector<ReadNote> TraceReader::notes() const {
  std::vector<ReadNote> all = impl_->mcap.notes().all();
  if (const ReadNotes* notes = impl_->assembler->notes()) all.insert(all.end(), notes->all().begin(), notes->all().end());
  return all;
}

const std::vector<ReadLoss>& TraceReader::losses() const noexcept { return impl_->mcap.losses(); }

Diagnostic TraceReader::explain(const Error& error) const {
  if (const Diagnostic* refused = impl_->assembler->refused()) return *refused;
  return impl_->mcap.explain(error);
}

std::vector<TraceTopic> TraceReader::topics() const {
  std::vector<TraceTopic> topics;
  for (const auto& [id, channel] : impl_->mcap.channels()) {
    const auto schema = impl_->mcap.schemas().find(channel.schema_id);
    topics.push_back(
        {channel.topic, schema == impl_->mcap.schemas().end() ? "" : schema->second.name, impl_->mcap.messages_of(id)});
  }
  return topics;
}

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

TraceReader::Bytes TraceReader::bytes() const { return {impl_->mcap.bytes_read(), impl_->mcap.files().bytes()}; }

bool TraceReader::cut_short() const noexcept { return impl_->mcap.cut_short(); }

TraceReader::TraceReader(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
TraceReader::TraceReader(TraceReader&&) noexcept = default;
TraceReader& TraceReader::operator=(TraceReader&&) noexcept = default;
TraceReader::~TraceReader() = default;

}  // namespace tactus
