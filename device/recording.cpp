// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/recording.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/trace/trace_file.h>

namespace tactus::device {

// ==== recording ====

namespace {

constexpr std::size_t kMostSamples = 10'000'000;

Vec3 between(const Vec3& a, const Vec3& b, double fraction) noexcept { return a + fraction * (b - a); }

tl::unexpected<Diagnostic> refuse(const std::string& path, const Error& error, std::string detail = {}) {
  return tl::unexpected(Diagnostic{.error = error, .file = path, .detail = std::move(detail)});
}

tl::expected<std::vector<RecordedSample>, Diagnostic> read_samples(TraceReader& reader, const std::string& path,
                                                                   std::size_t user) {
  std::vector<RecordedSample> samples;
  TraceFrame frame;
  for (;;) {
    const auto more = reader.next(frame);
    if (!more) {
      Diagnostic error = reader.explain(more.error());
      error.file = path;
      return tl::unexpected(std::move(error));
    }
    if (!*more) break;
    if (samples.size() == kMostSamples) return refuse(path, fail(Errc::limit_exceeded, "R-API-11").value());
    samples.push_back({frame.tick, frame.users[user].device, frame.users[user].force});
  }
  if (samples.empty()) return refuse(path, fail(Errc::truncated, "R-TRC-3").value());
  return samples;
}

}  // namespace

tl::expected<Recording, Diagnostic> Recording::read(const std::string& path, const RecordingOptions& options) try {
  if (!(options.playback_rate > 0 && options.playback_rate <= 1000))
    return refuse(path, fail(Errc::invalid_argument, "R-API-4").value(), "playback_rate");
  auto reader = TraceReader::open(path, {});
  if (!reader) return tl::unexpected(reader.error());
  const TraceInfo& info = reader->info();
  const auto user = options.user.empty() ? info.users.begin() : std::ranges::find(info.users, options.user, &TraceUser::name);
  if (user == info.users.end())
    return refuse(path, fail(Errc::invalid_argument, "R-DEV-1").value(),
                  options.user.empty() ? "no user" : "user " + options.user);
  TACTUS_TRY(auto samples, read_samples(*reader, path, static_cast<std::size_t>(user - info.users.begin())));
  return Recording(*user, info.tick_rate, std::move(samples), options);
} catch (const std::bad_alloc&) {
  return refuse(path, out_of_memory().value());
}

Recording::Recording(TraceUser user, double rate, std::vector<RecordedSample> samples, const RecordingOptions& options)
    : user_(std::move(user)),
      rate_(rate),
      samples_(std::move(samples)),
      ticks_per_ns_(1e-9 * rate * options.playback_rate),
      loops_(options.loops) {
  low_ = high_ = begin();
  for (const RecordedSample& recorded : samples_) {
    const Vec3& p = recorded.sample.position;
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), std::min(low_.z, p.z)};
    high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y), std::max(high_.z, p.z)};
  }
}

Recording::Moment Recording::at(Time since) noexcept {
  const std::int64_t first = samples_.front().tick, last = samples_.back().tick;
  double tick = static_cast<double>(std::max<Time>(since, 0)) * ticks_per_ns_;
  if (loops_ && last > first) tick = std::fmod(tick, static_cast<double>(last - first));
  const auto into = static_cast<Time>(tick / ticks_per_ns_);
  tick += static_cast<double>(first);
  if (next_ > 0 && static_cast<double>(samples_[next_ - 1].tick) > tick) next_ = 0;
  while (next_ < samples_.size() && static_cast<double>(samples_[next_].tick) <= tick) ++next_;
  const RecordedSample& before = samples_[next_ - 1];
  Moment moment{before.sample, before.force, into};
  if (next_ == samples_.size()) {
    moment.is_over = !loops_ && tick > static_cast<double>(last);
    return moment;
  }
  const RecordedSample& after = samples_[next_];
  const double fraction = (tick - static_cast<double>(before.tick)) / static_cast<double>(after.tick - before.tick);
  moment.sample.position = between(before.sample.position, after.sample.position, fraction);
  moment.sample.velocity = between(before.sample.velocity, after.sample.velocity, fraction);
  moment.force = between(before.force, after.force, fraction);
  return moment;
}

// ==== replay device ====

namespace {

class ReplayDevice final : public Device {
 public:
  ReplayDevice(Capabilities capabilities, Recording recording)
      : capabilities_(std::move(capabilities)), recording_(std::move(recording)) {}

  const Capabilities& capabilities() const noexcept override { return capabilities_; }

  Result<Reading> read(Time deadline) noexcept override {
    if (begin_ < 0) begin_ = deadline;
    const Recording::Moment moment = recording_.at(deadline - begin_);
    return Reading{
        .sample = moment.sample, .taken = deadline, .state = moment.is_over ? Reading::State::ended : Reading::State::valid};
  }

  Result<void> write(const GuardedForce&) noexcept override { return {}; }
  void halt() noexcept override {}

 private:
  Capabilities capabilities_;
  Recording recording_;
  Time begin_ = -1;  // of the first sample
};

}  // namespace

tl::expected<std::unique_ptr<Device>, Diagnostic> open_replay_device(const std::string& path, const RecordingOptions& options) {
  TACTUS_TRY(auto recording, Recording::read(path, options));
  const TraceUser& user = recording.user();
  Capabilities capabilities{.name = "replay:" + path, .model = "recording of " + user.name, .senses = user.senses};
  capabilities.buttons = user.senses.buttons ? 32 : 0;
  capabilities.rate = recording.rate();
  capabilities.low = recording.low();
  capabilities.high = recording.high();
  return std::make_unique<ReplayDevice>(std::move(capabilities), std::move(recording));
}

}  // namespace tactus::device
