// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>

namespace tactus {

/// Coordinate frames that hang on each other, as /tf tells. A frame without a parent is the world.
class RosFrames {
 public:
  struct Placed {
    Pose pose;               ///< in the world
    std::uint64_t time = 0;  ///< [ns] of the newest news of it, or of a frame that it hangs on
  };

  /// The frame of this name, or a new one.   time O(log frames)
  std::uint32_t number_of(std::string_view name);
  std::optional<std::uint32_t> find(std::string_view name) const;
  const std::string& name(std::uint32_t frame) const noexcept { return *links_[frame].name; }
  bool hangs(std::uint32_t frame) const noexcept { return links_[frame].parent.has_value(); }
  std::size_t size() const noexcept { return links_.size(); }

  /// The place of `child` in `parent`, at `time`.
  /// err  unsupported R-TRC-16: it hung on another frame before, or on itself by way of others
  /// time O(1), the first time O(frames)
  Result<void> place(std::uint32_t child, std::uint32_t parent, const Pose& pose, std::uint64_t time);
  /// time O(1) on average over all frames, between two calls of place()
  const Placed& placed(std::uint32_t frame);

 private:
  struct Link {
    const std::string* name = nullptr;
    std::optional<std::uint32_t> parent{};
    Placed in_parent{};
    Placed in_world{};
    std::uint64_t computed = 0;  // in_world, of this generation
  };
  std::map<std::string, std::uint32_t, std::less<>> numbers_;
  std::vector<Link> links_;
  std::vector<std::uint32_t> chain_;  // room for placed()
  std::uint64_t generation_ = 1;
};

}  // namespace tactus
