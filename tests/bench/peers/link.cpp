// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/peers/link.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/deformable/motion_clusters.h>
#include <tactus/receiver.h>
#include <tactus/sender.h>
#include <tactus/thesis/thesis.h>

namespace tactus::peers {
namespace {

class PeerLink final : public Link {
 public:
  PeerLink(std::unique_ptr<VertexCoder> coder, bool predicted, std::size_t vertices)
      : coder_(std::move(coder)), predicted_(predicted), before_(vertices), values_(vertices) {}

  Bytes encode(std::size_t, std::span<const Vec3i> positions, std::span<const Vec3i>) override {
    for (std::size_t v = 0; v < positions.size(); ++v)
      for (std::size_t axis = 0; axis < 3; ++axis) values_[v][axis] = positions[v][axis] - before_[v][axis];
    remember(positions);
    return coder_->encode(values_);
  }
  bool decode(std::size_t, std::span<const std::uint8_t> packet, std::span<Vec3i> shown) override {
    if (!coder_->decode(packet, values_)) return false;
    for (std::size_t v = 0; v < shown.size(); ++v) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        values_[v][axis] += before_[v][axis];
        shown[v][axis] = values_[v][axis] * kFine;
      }
    }
    remember(values_);
    return true;
  }

 private:
  void remember(std::span<const Vec3i> positions) {
    if (predicted_) std::copy(positions.begin(), positions.end(), before_.begin());
  }

  std::unique_ptr<VertexCoder> coder_;
  bool predicted_;
  std::vector<Vec3i> before_, values_;
};

constexpr std::uint32_t kFrameRate = 60;
/// Of the stream's grid [m]: its unit gets another name, nothing else.
const double kStep = std::ldexp(1.0, -GridExponents{}.position);

struct OurSetting {
  DeformableProfile profile = DeformableProfile::main;
  bool models_kept = false;      ///< thesis
  bool chained = true;           ///< false: every packet is a key packet
  bool lossy = false;            ///< main: given what the grid rounded, and allowed the error of that rounding
  std::uint8_t weight_sets = 1;  ///< main
  std::size_t clusters = 0;      ///< main
  std::size_t known = 1;         ///< early: clusters are found on the first of so many parts of the frames
};

/// Steps of the stream's grid to a unit of the table's.
std::int32_t units_of(const OurSetting& setting) { return setting.lossy ? kFine : 1; }

ClusterBasis clusters_of(const Animation& animation, const OurSetting& setting) {
  TriMesh rest{.vertices = {}, .triangles = animation.triangles};
  for (const Vec3i& p : animation.rest) rest.vertices.push_back({1.0 * p[0], 1.0 * p[1], 1.0 * p[2]});
  std::vector<std::vector<float>> shapes;
  const std::size_t frames = animation.frames.size() / setting.known;
  const std::size_t stride = (frames + kClusterShapes - 1) / kClusterShapes;
  for (std::size_t f = 0; f < frames; f += stride) {
    std::vector<float>& shape = shapes.emplace_back();
    for (std::size_t v = 0; v < animation.rest.size(); ++v)
      for (std::size_t axis = 0; axis < 3; ++axis)
        shape.push_back(static_cast<float>(animation.frames[f][v][axis] - animation.rest[v][axis]));
  }
  return motion_clusters(rest, shapes, setting.clusters).value();
}

SharedScene scene_of(const Animation& animation, const OurSetting& setting) {
  SceneSpec spec;
  spec.tick_rate = kFrameRate;
  DeformableObject object;
  object.name = "mesh";
  object.profile = setting.profile;
  object.models_kept = setting.models_kept;
  object.rest = animation.rest;
  for (Vec3i& v : object.rest)
    for (std::int32_t& c : v) c *= units_of(setting);
  object.triangles = animation.triangles;
  object.weight_sets = setting.weight_sets;
  if (setting.clusters > 0) {
    object.cluster_basis = clusters_of(animation, setting);
    object.fade = 8000;  // 98 % per second at 30 frames/s
  }
  spec.deformables.push_back(std::move(object));
  return Scene::create(std::move(spec), {.thesis = &thesis_component}).value();
}

SenderOptions options_of(const OurSetting& setting) {
  SenderOptions options;
  options.deformable.thresholds.visual = setting.lossy ? kRounding * kFine * kStep : 0;
  options.deformable.thresholds.weber_fraction = {};
  options.policy.key_interval = setting.chained ? 0 : 0.5 / kFrameRate;
  return options;
}

class OurLink final : public Link {
 public:
  OurLink(const Animation& animation, const OurSetting& setting)
      : lossy_(setting.lossy),
        sender_(Sender::create(scene_of(animation, setting), options_of(setting)).value()),
        receiver_(Receiver::create(sender_.scene()).value()),
        rest_(sender_.scene()->deformables[0].rest),
        displacements_(3 * rest_.size()) {}

  Bytes encode(std::size_t frame, std::span<const Vec3i> positions, std::span<const Vec3i> fine) override {
    const auto truth = lossy_ ? fine : positions;
    for (std::size_t v = 0; v < rest_.size(); ++v)
      for (std::size_t axis = 0; axis < 3; ++axis)
        displacements_[3 * v + axis] = static_cast<float>((truth[v][axis] - rest_[v][axis]) * kStep);
    const DeformableTruth shape{displacements_, {}};
    const auto packets = sender_.encode(static_cast<std::int64_t>(frame), {.deformables = {&shape, 1}}).value();
    if (packets.empty()) return {};
    return {packets[0].bytes.begin(), packets[0].bytes.end()};
  }
  bool decode(std::size_t frame, std::span<const std::uint8_t> packet, std::span<Vec3i> shown) override {
    if (!packet.empty() && !receiver_.push(++number_, packet)) return false;
    const auto displacement = receiver_.replica().displacements(0, static_cast<std::int64_t>(frame));
    for (std::size_t v = 0; v < rest_.size(); ++v)
      for (std::size_t axis = 0; axis < 3; ++axis)
        shown[v][axis] = (rest_[v][axis] + displacement[v][axis]) * (lossy_ ? 1 : kFine);
    return true;
  }

 private:
  bool lossy_;
  Sender sender_;
  Receiver receiver_;
  std::span<const Vec3i> rest_;       // of the sender's scene
  std::uint64_t number_ = 0;          // of the last packet decoded
  std::vector<float> displacements_;  // [m] exact as far as a vertex moves by less than 2^24 steps
};

Scheme ours(const char* name, const char* text, const OurSetting& setting) {
  return {name, text, setting.chained,
          [setting](const Animation& a) -> std::unique_ptr<Link> { return std::make_unique<OurLink>(a, setting); }};
}

}  // namespace

std::vector<Peer> peers() {
  std::vector<Peer> out;
  std::vector<std::string> absent;
  add_adaptive(out);
  add_general_peers(out, absent);
#ifdef TACTUS_PEER_DRACO
  add_draco(out);
#endif
#ifdef TACTUS_PEER_MESHOPTIMIZER
  add_meshoptimizer(out);
#endif
#ifdef TACTUS_PEER_OPEN3DGC
  add_open3dgc(out);
#endif
#ifdef TACTUS_PEER_ZFP
  add_zfp(out);
#endif
  return out;
}

std::vector<std::string> absent_peers() {
  std::vector<Peer> ignored;
  std::vector<std::string> absent;
  add_general_peers(ignored, absent);
#ifndef TACTUS_PEER_DRACO
  absent.emplace_back("Draco (apt-get install libdraco-dev)");
#endif
#ifndef TACTUS_PEER_MESHOPTIMIZER
  absent.emplace_back("meshoptimizer (apt-get install libmeshoptimizer-dev)");
#endif
#ifndef TACTUS_PEER_OPEN3DGC
  absent.emplace_back("Open3DGC (apt-get install libo3dgc-dev)");
#endif
#ifndef TACTUS_PEER_ZFP
  absent.emplace_back("zfp (apt-get install libzfp-dev)");
#endif
  return absent;
}

std::vector<Scheme> all_schemes() {
  std::vector<Scheme> out;
  out.push_back(ours("tactus main", "key packets", {.chained = false}));
  for (const bool lossy : {false, true}) {
    const char* name = lossy ? "tactus main, same largest error" : "tactus main";
    out.push_back(ours(name, "nugget 2%", {.lossy = lossy}));
    out.push_back(ours(name, "nugget all", {.lossy = lossy, .weight_sets = 7}));
    out.push_back(ours(name, "40 clusters", {.lossy = lossy, .weight_sets = 2, .clusters = 40}));
    out.push_back(ours(name, "40 early clusters", {.lossy = lossy, .weight_sets = 2, .clusters = 40, .known = 4}));
  }
  out.push_back(ours("tactus thesis (8 bits)", "key packets", {.profile = DeformableProfile::thesis, .chained = false}));
  out.push_back(ours("tactus thesis (8 bits)", "models restarted", {.profile = DeformableProfile::thesis}));
  out.push_back(ours("tactus thesis (8 bits)", "models kept", {.profile = DeformableProfile::thesis, .models_kept = true}));
  for (const Peer& peer : peers()) {
    for (const bool predicted : {false, true}) {
      const auto make = [peer, predicted](const Animation& a) -> std::unique_ptr<Link> {
        return std::make_unique<PeerLink>(peer.make(a), predicted, a.rest.size());
      };
      out.push_back({peer.name, peer.setting, predicted, make});
    }
  }
  return out;
}

}  // namespace tactus::peers
