// SPDX-License-Identifier: Apache-2.0
/// A codec made by others, as far as it concerns us: an integer triple per vertex in, a packet out, nothing remembered.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tests/bench/peers/animation.h"

namespace tactus::peers {

using Bytes = std::vector<std::uint8_t>;

class VertexCoder {
 public:
  VertexCoder() = default;
  VertexCoder(const VertexCoder&) = delete;
  VertexCoder& operator=(const VertexCoder&) = delete;
  virtual ~VertexCoder() = default;

  /// Empty: it cannot.
  virtual Bytes encode(std::span<const Vec3i> values) = 0;
  virtual bool decode(std::span<const std::uint8_t> packet, std::span<Vec3i> values) = 0;
};

/// One setting of a peer. Tables show the setting that takes the fewest bytes.
struct Peer {
  std::string name, setting;
  std::unique_ptr<VertexCoder> (*make)(const Animation&);
};

/// Peers that this build has, and those it was made without, with the Debian packages that bring them.
std::vector<Peer> peers();
std::vector<std::string> absent_peers();

void add_general_peers(std::vector<Peer>& out, std::vector<std::string>& absent);
void add_adaptive(std::vector<Peer>& out);
void add_draco(std::vector<Peer>& out);
void add_meshoptimizer(std::vector<Peer>& out);
void add_open3dgc(std::vector<Peer>& out);
void add_zfp(std::vector<Peer>& out);

/// Peers that put vertices into an order of their own: both ends know the mesh, so they can find out which, once.
class VertexOrder {
 public:
  /// in   coded  what comes out of the peer for the values (v, v, v)
  void learn(std::span<const Vec3i> coded) {
    vertex_.clear();
    for (const Vec3i& value : coded) vertex_.push_back(static_cast<std::uint32_t>(value[0]));
  }
  /// False: a vertex is missing.
  bool restore(std::span<const Vec3i> coded, std::span<Vec3i> values) const {
    if (coded.size() != vertex_.size()) return false;
    std::vector<bool> seen(values.size(), false);
    std::size_t count = 0;
    for (std::size_t i = 0; i < coded.size(); ++i) {
      if (vertex_[i] >= values.size()) return false;
      values[vertex_[i]] = coded[i];
      count += seen[vertex_[i]] ? 0U : 1U;
      seen[vertex_[i]] = true;
    }
    return count == values.size();
  }
  static std::vector<Vec3i> numbers(std::size_t count) {
    std::vector<Vec3i> out(count);
    for (std::size_t v = 0; v < count; ++v) out[v].fill(static_cast<std::int32_t>(v));
    return out;
  }

 private:
  std::vector<std::uint32_t> vertex_;
};

}  // namespace tactus::peers
