// SPDX-License-Identifier: Apache-2.0
/// From frames to packets and back, with what each end remembers: the peers with and without prediction in time, and our profiles.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/peers/coder.h"

namespace tactus::peers {

class Link {
 public:
  Link() = default;
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;
  virtual ~Link() = default;

  /// Empty: nothing to send.   in  positions  grid units;  fine  what they were rounded from, in 1/kFine of a unit
  virtual Bytes encode(std::size_t frame, std::span<const Vec3i> positions, std::span<const Vec3i> fine) = 0;
  /// False: the packet cannot be decoded.   in  packet  may be empty: no packet came in this frame   out  shown  as fine
  virtual bool decode(std::size_t frame, std::span<const std::uint8_t> packet, std::span<Vec3i> shown) = 0;
};

/// `predicted`: packets hold differences to the frame before, otherwise positions.
struct Scheme {
  std::string name, setting;
  bool predicted = false;
  std::function<std::unique_ptr<Link>(const Animation&)> make;
};

/// Ours first, then every peer twice.
std::vector<Scheme> all_schemes();

}  // namespace tactus::peers
