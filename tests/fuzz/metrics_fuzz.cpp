// SPDX-License-Identifier: Apache-2.0
/// Any bytes as a trace, coded with its contacts and compared with what its client shows: what the sender takes stays inside its
/// bounds, as `compare` measures them.
#include <vector>

#include <tactus/metrics/deformable_errors.h>
#include <tactus/metrics/errors.h>
#include <tactus/receiver.h>
#include <tactus/sender.h>
#include <tactus/trace/trace_file.h>
#include <tactus/trace/trace_scene.h>
#include "tests/fuzz/require.h"

namespace {

using namespace tactus;

constexpr int kMaxFrames = 500;

/// What a client shows, held against the truth.
class Watch {
 public:
  Watch(const TraceInfo& info, const Scene& scene) : scene_(scene), rigid_(info, RigidTriggers{}), shown_(scene.objects.size()) {
    for (std::size_t i = 0; i < scene.deformables.size(); ++i)
      deformables_.emplace_back(info.meshes[i].rest, DeformableThresholds{}, scene.deformables[i].rings, scene.grid.position);
  }

  /// An object is further from where it is shown than an update can name.
  bool is_far(const TraceFrame& frame, Replica& replica) const {
    for (std::uint32_t i = 0; i < shown_.size(); ++i)
      if (norm(frame.objects[i].pose.position - to_pose(replica.pose(i, frame.tick), scene_.grid.position).position) > 500)
        return true;
    return false;
  }
  void look(const TraceFrame& frame, Replica& replica) {
    for (std::uint32_t i = 0; i < shown_.size(); ++i) shown_[i] = to_pose(replica.pose(i, frame.tick), scene_.grid.position);
    rigid_.add(frame, shown_);
    require(rigid_.position().ticks_over() + rigid_.rotation().ticks_over() + rigid_.force().ticks_over() == 0);
    for (std::size_t i = 0; i < deformables_.size(); ++i) {
      if (!frame.meshes[i].updated) continue;
      deformables_[i].add(frame.meshes[i].displacements, replica.displacements(i, frame.tick), touch_of(frame, i));
      require(deformables_[i].worst_ratio() <= 1);
    }
  }

 private:
  const Scene& scene_;
  ErrorMetrics rigid_;
  std::vector<Pose> shown_;
  std::vector<DeformableErrors> deformables_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto reader = TraceReader::open_memory({data, size});
  TraceFrame frame;
  if (!reader || !reader->next(frame).value_or(false)) return 0;
  auto builder = scene_builder(reader->info(), frame);
  if (!builder) return 0;
  const auto scene = std::move(*builder).build();
  if (!scene) return 0;
  auto sender = Sender::create(*scene).value();
  auto receiver = Receiver::create(*scene).value();
  FrameTruth truth(reader->info());
  Watch watch(reader->info(), **scene);
  for (int i = 0; i < kMaxFrames; ++i) {
    const auto packets = sender.encode(frame.tick, truth.of(frame));
    if (packets) {
      if (!sender.held().empty() || watch.is_far(frame, receiver.replica()))
        return 0;  // the bounds are of what is held, or come in two steps
      for (const Packet& packet : *packets) require(receiver.push(packet.number, packet.bytes).has_value());
      watch.look(frame, receiver.replica());
    }
    if (!reader->next(frame).value_or(false)) break;
  }
  return 0;
}
