// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_recorder.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>

namespace tactus {
namespace {

constexpr std::size_t kMostFrames = std::size_t{1} << 20;
constexpr std::size_t kMostMarker = 255, kMostMarkers = 4096;  // [bytes]
constexpr auto kNap = std::chrono::milliseconds(2);            // of the writing thread, when nothing waits: nobody has to wake it

/// Without what only the writing thread may touch.
void copy(const TraceFrame& from, TraceFrame& to) noexcept {
  to.tick = from.tick;
  to.shown = from.shown;
  std::ranges::copy(from.objects, to.objects.begin());
  std::ranges::copy(from.users, to.users.begin());
}

bool fits(const TraceFrame& a, const TraceFrame& b) noexcept {
  const auto size = [](const DeformableSample& mesh) { return mesh.displacements.size(); };
  const auto has_room = [](const UserSample& user) {
    return user.reports.sizes.size() <= kMostReports && user.reports.bytes.size() <= kMostReportBytes;
  };
  return a.objects.size() == b.objects.size() && a.users.size() == b.users.size() &&
         std::ranges::equal(a.meshes, b.meshes, {}, size, size) && std::ranges::all_of(a.users, has_room);
}

/// Without a part of a UTF-8 character at the end.
std::string_view whole_characters(std::string_view text) noexcept {
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; };
  std::size_t begin = text.size();
  while (begin > 0 && continues(text[begin - 1])) --begin;
  if (begin > 0 && is_utf8(text.substr(begin - 1))) return text;
  return text.substr(0, begin > 0 ? begin - 1 : 0);
}

}  // namespace

struct TraceRecorder::Impl {
  Impl(TraceWriter trace, const TraceInfo& info, const TraceFrame& like, const TraceRecorderOptions& options)
      : writer(std::move(trace)),
        ring(options.frames, like),
        missed_shapes(like.meshes.size()),
        only_meshes(like.objects.empty() && like.users.empty()) {
    for (TraceFrame& slot : ring)
      for (std::size_t i = 0; i < slot.users.size(); ++i)
        if (info.users[i].report_descriptor) reserve(slot.users[i].reports);
  }
  ~Impl() { stop(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  bool offer(const TraceFrame& frame) noexcept;
  bool lose(const TraceFrame& frame) noexcept;
  void run();
  void write(TraceFrame& frame);
  void stop();

  TraceWriter writer;  // of the writing thread, as long as that runs
  std::vector<TraceFrame> ring;
  std::atomic<std::uint64_t> put{0}, taken{0};  // frames, each written by one thread
  std::vector<bool> missed_shapes;              // of frames that were lost
  bool only_meshes;                             // they have the ticks, too
  std::atomic<std::uint64_t> lost{0}, most_waiting{0};
  std::atomic<std::int64_t> last_written{-1};
  Error error{};
  int cause = 0;                        // errno
  std::atomic<bool> has_failed{false};  // `error` is written before
  std::atomic<bool> ends{false};
  std::mutex marking;
  std::string marker;  // under `marking`
  std::atomic<bool> is_marked{false};
  std::thread thread;
};

bool TraceRecorder::Impl::lose(const TraceFrame& frame) noexcept {
  for (std::size_t i = 0; i < std::min(frame.meshes.size(), missed_shapes.size()); ++i)
    missed_shapes[i] = missed_shapes[i] || frame.meshes[i].updated;
  lost.fetch_add(1, std::memory_order_relaxed);
  return false;
}

bool TraceRecorder::Impl::offer(const TraceFrame& frame) noexcept {
  const std::uint64_t here = put.load(std::memory_order_relaxed);
  const std::uint64_t waiting = here - taken.load(std::memory_order_acquire);
  TraceFrame& slot = ring[here % ring.size()];
  if (waiting == ring.size() || has_failed.load(std::memory_order_acquire) || !fits(frame, slot)) return lose(frame);
  copy(frame, slot);
  for (std::size_t i = 0; i < frame.meshes.size(); ++i) {
    slot.meshes[i].updated = frame.meshes[i].updated || missed_shapes[i];
    if (slot.meshes[i].updated || only_meshes)
      std::ranges::copy(frame.meshes[i].displacements, slot.meshes[i].displacements.begin());
    missed_shapes[i] = false;
  }
  most_waiting.store(std::max(most_waiting.load(std::memory_order_relaxed), waiting + 1), std::memory_order_relaxed);
  put.store(here + 1, std::memory_order_release);
  return true;
}

void TraceRecorder::Impl::write(TraceFrame& frame) {
  if (has_failed.load(std::memory_order_relaxed)) {
    lost.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  frame.marker.clear();
  if (is_marked.load(std::memory_order_acquire)) {
    const std::scoped_lock lock(marking);
    frame.marker = std::exchange(marker, {});
    is_marked = false;
  }
  if (const auto written = writer.write(frame); !written) {
    error = written.error();
    cause = errno;
    has_failed.store(true, std::memory_order_release);
    lost.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  last_written.store(frame.tick, std::memory_order_relaxed);
}

void TraceRecorder::Impl::run() {
  for (;;) {
    const bool is_last = ends.load(std::memory_order_acquire);
    const std::uint64_t until = put.load(std::memory_order_acquire);
    for (std::uint64_t here = taken.load(std::memory_order_relaxed); here != until; ++here) {
      write(ring[here % ring.size()]);
      taken.store(here + 1, std::memory_order_release);
    }
    if (is_last) return;
    std::this_thread::sleep_for(kNap);
  }
}

void TraceRecorder::Impl::stop() {
  ends.store(true, std::memory_order_release);
  if (thread.joinable()) thread.join();
}

Result<TraceRecorder> TraceRecorder::create(const std::string& path, const TraceInfo& info, const TraceFrame& like,
                                            const TraceRecorderOptions& options) try {
  if (options.frames < 2 || options.frames > kMostFrames) return fail(Errc::invalid_argument, "R-API-4");
  const bool has_sizes = like.objects.size() == info.objects.size() && like.users.size() == info.users.size() &&
                         std::ranges::equal(like.meshes, info.meshes, [](const auto& mesh, const auto& declared) {
                           return mesh.displacements.size() == 3 * declared.rest.vertices.size();
                         });
  if (!has_sizes) return fail(Errc::invalid_argument, "R-API-5");
  TACTUS_TRY(auto writer, TraceWriter::create(path, info, {.chunk_time = options.chunk_time}));
  TraceRecorder recorder(std::make_unique<Impl>(std::move(writer), info, like, options));
  recorder.impl_->thread = std::thread([impl = recorder.impl_.get()] { impl->run(); });
  return recorder;
} catch (const std::bad_alloc&) {
  return out_of_memory();
} catch (const std::system_error&) {  // no thread
  return out_of_memory();
}

bool TraceRecorder::offer(const TraceFrame& frame) noexcept { return impl_->offer(frame); }

void TraceRecorder::mark(std::string_view text) {
  const std::scoped_lock lock(impl_->marking);
  if (impl_->marker.size() > kMostMarkers) return;
  if (!impl_->marker.empty()) impl_->marker += "; ";
  impl_->marker += whole_characters(text.substr(0, kMostMarker));
  impl_->is_marked.store(true, std::memory_order_release);
}

TraceRecorder::Status TraceRecorder::status() const noexcept {
  const bool has_failed = impl_->has_failed.load(std::memory_order_acquire);
  return {.lost = impl_->lost.load(std::memory_order_relaxed),
          .most_waiting = static_cast<std::size_t>(impl_->most_waiting.load(std::memory_order_relaxed)),
          .error = has_failed ? std::optional(impl_->error) : std::nullopt,
          .cause = has_failed ? impl_->cause : 0,
          .last_written = impl_->last_written.load(std::memory_order_relaxed)};
}

Result<void> TraceRecorder::finish() {
  impl_->stop();
  if (impl_->has_failed) {
    errno = impl_->cause;
    return tl::unexpected(impl_->error);
  }
  return impl_->writer.finish();
}

TraceRecorder::TraceRecorder(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
TraceRecorder::TraceRecorder(TraceRecorder&&) noexcept = default;
TraceRecorder::~TraceRecorder() = default;

}  // namespace tactus
