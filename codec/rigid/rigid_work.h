// SPDX-License-Identifier: Apache-2.0
/// What encoders of one truth have found out in this tick: those whose receivers know the same need not find it out again. It changes no
/// byte. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/packet/substream_encoder.h>
#include <tactus/rigid/curve.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// Whether an object must be updated, by what a receiver shows of it.
struct RigidDecision {
  Reason reason = Reason::request;  ///< this: no trigger has fired
  bool is_early = false;            ///< it would soon
};

/// A path of an object and a version: paths of one object and one version are equal. 0: that from its initial state.
struct VersionedPath {
  SmoothedPath path;
  std::uint64_t version = 0;
};

class RigidWork {
 public:
  static constexpr std::size_t kMostUpdates = 256;    ///< of a payload that is shared
  static constexpr std::size_t kHead = 2;             ///< first words of a key: what the paths do not depend on
  static constexpr std::size_t kAll = 6, kEach = 27;  ///< words of a key: of all, of each update

  /// What a decision depends on, besides the truth.
  struct Asked {
    std::uint64_t version = 0;
    std::uint32_t object = 0;
    double bound_scale = 1, early = 1;
    friend bool operator==(const Asked&, const Asked&) = default;
  };
  /// A payload and what it makes of the paths.
  struct Body {
    std::uint64_t read = 0;
    std::vector<std::uint32_t> key;
    std::vector<std::uint8_t> bytes;
    std::vector<VersionedPath> after;  ///< one per update
    Reason reason = Reason::request;
  };

  /// allocates 6 kB per object that can move, 1.5 MB at most; memory is taken by what is used
  explicit RigidWork(const Scene& scene);

  /// Null: nobody has asked in this read of the truth.   time about 5 ns
  const RigidDecision* find(std::uint64_t read, const Asked& asked) const noexcept;
  void put(std::uint64_t read, const Asked& asked, const RigidDecision& decision) noexcept;

  /// The same of payloads.   in   key  all that they depend on.   time O(key)
  const Body* find(std::uint64_t read, std::span<const std::uint32_t> key) const noexcept;
  /// Keep a payload instead of the oldest, and give the paths their versions.   in   key  as in find()
  void put(std::uint64_t read, std::span<const std::uint32_t> key, std::span<const std::uint8_t> bytes, Reason reason,
           std::span<VersionedPath* const> after) noexcept;
  std::uint64_t next_version() noexcept { return ++newest_; }  ///< of a path that nobody else has

 private:
  struct Entry {
    std::uint64_t read = 0;
    Asked asked;
    RigidDecision decision;
  };
  std::size_t slot_of(const Asked& asked) const noexcept;

  std::vector<Entry> entries_;  // a power of two of them
  std::array<Body, 8> bodies_;
  std::size_t next_ = 0;
  std::uint64_t newest_ = 0;  // version
};

/// All fields of a state, for a key.
void append_to(std::vector<std::uint32_t>& key, const RigidState& state) noexcept;

}  // namespace tactus
