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

/// Why no trace can be made of a file: when there is nothing of use in it, what there is.
TraceError explain(const mcap::Reader& mcap, const Error& error) {
  const std::string& path = mcap.files().paths.empty() ? std::string() : mcap.files().paths.front();
  const auto is_of_use = [&](const auto& entry) {
    return std::any_of(std::begin(kReadTypes), std::end(kReadTypes),
                       [&](const char* type) { return carries(mcap, entry.second, type); });
  };
  const auto& channels = mcap.channels();
  TraceError told = mcap.explain(error);
  if (std::string_view(error.rule) != "R-TRC-16" || std::any_of(channels.begin(), channels.end(), is_of_use)) return told;
  TraceError better = nothing_of_use(mcap.schemas(), channels, path);
  better.place = mcap.files().name(0).empty() ? "" : told.place;
  return better;
}

bool carries(const mcap::Reader& mcap, const mcap::Channel& channel, std::string_view schema) {
  const auto found = mcap.schemas().find(channel.schema_id);
  return channel.message_encoding == "cdr" && found != mcap.schemas().end() && found->second.name == schema;
}

struct TraceReader::Impl {
  static TraceResult<TraceReader> open(RecordingFiles files, OnDamage on_damage);

  mcap::Reader mcap;
  std::optional<mcap::Statistics> statistics;
  std::unique_ptr<FrameAssembler> assembler;
};

TraceResult<TraceReader> TraceReader::Impl::open(RecordingFiles files, OnDamage on_damage) {
  TACTUS_TRY(auto mcap,
             mcap::Reader::open(std::move(files), on_damage == OnDamage::skip ? mcap::OnDamage::skip : mcap::OnDamage::refuse));
  auto statistics = mcap.statistics();
  const auto preamble = read_preamble(mcap);
  if (!preamble) return tl::unexpected(mcap.explain(preamble.error()));
  auto assembler = preamble->tactus ? assemble_tactus(mcap, *preamble) : assemble_ros(mcap, *preamble);
  if (!assembler) return tl::unexpected(explain(mcap, assembler.error()));
  return TraceReader(std::make_unique<Impl>(Impl{std::move(mcap), std::move(statistics), *std::move(assembler)}));
}

TraceResult<TraceReader> TraceReader::open(const std::string& path, OnDamage on_damage) try {
  TACTUS_TRY(auto files, files_of(path, on_damage == OnDamage::skip ? MissingFiles::leave_out : MissingFiles::refuse));
  return Impl::open(std::move(files), on_damage);
} catch (const std::bad_alloc&) {
  return tl::unexpected(TraceError(out_of_memory().value()));
}

TraceResult<TraceReader> TraceReader::open_memory(std::span<const std::uint8_t> bytes) try {
  return Impl::open(RecordingFiles{.memory = bytes}, OnDamage::refuse);
} catch (const std::bad_alloc&) {
  return tl::unexpected(TraceError(out_of_memory().value()));
}

const TraceInfo& TraceReader::info() const noexcept { return impl_->assembler->info(); }

std::optional<std::uint64_t> TraceReader::frame_count() const noexcept {
  const auto channel = impl_->assembler->frame_channel();
  if (!channel || !impl_->statistics) return std::nullopt;
  const auto& counts = impl_->statistics->channel_message_counts;
  const auto found = counts.find(*channel);
  return found == counts.end() ? std::nullopt : std::optional(found->second);
}

TraceResult<bool> TraceReader::next(TraceFrame& frame) try {
  const auto more = impl_->assembler->next(impl_->mcap, frame);
  if (!more) return tl::unexpected(impl_->mcap.explain(more.error()));
  return *more;
} catch (const std::bad_alloc&) {
  return tl::unexpected(TraceError(out_of_memory().value()));
}

TraceReader::Bytes TraceReader::bytes() const { return {impl_->mcap.bytes_read(), impl_->mcap.bytes_in_all()}; }

std::vector<ReadNote> TraceReader::file_notes() const { return impl_->mcap.notes().all(); }

std::vector<TraceLoss> TraceReader::losses() const {
  std::vector<TraceLoss> losses;
  for (const mcap::Loss& loss : impl_->mcap.losses())
    losses.push_back({loss.file, loss.cause, loss.bytes, loss.from, loss.until});
  return losses;
}

bool TraceReader::cut_short() const noexcept { return impl_->mcap.cut_short(); }

TraceReader::TraceReader(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
TraceReader::TraceReader(TraceReader&&) noexcept = default;
TraceReader& TraceReader::operator=(TraceReader&&) noexcept = default;
TraceReader::~TraceReader() = default;

}  // namespace tactus
