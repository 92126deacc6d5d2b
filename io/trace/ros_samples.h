// SPDX-License-Identifier: Apache-2.0
/// What the messages of a recording hold, one source at a time: a source is a topic of poses, twists or forces, or a frame that hangs on
/// another one. Internal to the library.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/trace/mcap_reader.h>
#include <tactus/trace/ros_messages.h>

namespace tactus {

struct RosSample {
  std::uint32_t source = 0;
  std::uint32_t frame = 0;           ///< name in which it is expressed; of a link: the parent
  std::uint64_t ordinal = 0;         ///< of its message in the file
  std::uint64_t log = 0, stamp = 0;  ///< [ns] stamp 0: none
  std::uint64_t time = 0;            ///< [ns] by the clock that was chosen (RosClock)
  RosFault fault = RosFault::none;
  bool ignored = false;
  RigidSample value{};  ///< of a pose or link its pose, of a twist its velocities, of a force its position is the force
};

struct RosSource {
  enum class Kind : std::uint8_t { pose, twist, force, link };
  Kind kind{};
  std::string topic;         ///< on which it was first published
  std::uint32_t space = 0;   ///< name: where its frames are looked up first; "/r1/tf" gives "r1", of other topics the path
  std::uint32_t child = 0;   ///< name: of a link, the frame that hangs; of an odometry's twist, the frame it is expressed in
  bool is_odometry = false;  ///< a pose or twist of one
  bool is_static = false;    ///< a link of /tf_static
};

/// Which topics are read.
struct RosSelection {
  std::vector<std::string> only, skip;
  bool has(const std::string& topic) const;
};

/// Sources and names, numbered in the order in which they come; they stay from one pass over the recording to the next.
class RosSamples {
 public:
  explicit RosSamples(RosSelection selection) : selection_(std::move(selection)) {}

  /// Begin a pass at a message, or the end.
  void restart(mcap::Item first) { item_ = first, ordinal_ = 0, waiting_.clear(), runs_.clear(); }
  /// The next one; none at the end. Of a transform that cannot be read at all, the source is the topic itself.   err  those of the container
  Result<std::optional<RosSample>> next(mcap::Reader& mcap);
  /// Sources are kept from here on: samples of another one are counted in late() and left out.
  void close() noexcept { is_closed_ = true; }

  const std::vector<RosSource>& sources() const noexcept { return sources_; }
  const std::string& name(std::uint32_t name) const noexcept { return *names_[name]; }
  /// The link that places this frame for topics in `space`: in its own tree, or one of a shorter path, or the common one. Where none has
  /// it, "base" of /r1 may be "r1/base" of the common tree, and "r1/base" be "base" of the tree of /r1.
  std::optional<std::uint32_t> link_of(std::uint32_t space, std::uint32_t frame);
  /// Whether any tree for `space` has it, as a parent if not as a child.
  bool is_in_tree(std::uint32_t space, std::uint32_t frame);

  struct Other {
    std::string type;
    std::uint64_t topics = 0;
    std::string first;
  };
  /// Topics that are not read, by type; those that were skipped on demand are not among them.
  std::vector<Other> others(const mcap::Reader& mcap) const;
  const std::map<std::string, std::uint64_t>& late() const noexcept { return late_; }
  /// By source: samples with stamp and value of the one before, no more than a second after the first such one, which are left out.
  const std::map<std::uint32_t, std::uint64_t>& copies() const noexcept { return copies_; }
  /// Topics of several channels.
  const std::map<std::string, int>& channels() const noexcept { return channels_of_topic_; }
  /// Two types on one topic, or the like: topic, then what.

 private:
  struct ChannelUse {
    RosType type = RosType::none;
    std::optional<std::uint32_t> main, twist;  // sources
    std::uint32_t space = 0;
  };
  /// Samples with the same stamp.
  struct Run {
    RosSample first{};
    std::uint64_t number = 0;
  };
  const ChannelUse& use_of(const mcap::Reader& mcap, std::uint16_t id);
  std::uint32_t number_of(std::string_view name);
  std::optional<std::uint32_t> source_of(RosSource::Kind kind, const std::string& topic, std::uint32_t space,
                                         std::uint32_t child);
  std::optional<std::uint32_t> prefixed(std::uint32_t space, std::uint32_t frame) const;
  std::optional<std::uint32_t> link_in(std::string_view tree, std::string_view frame) const;
  void push(const RosSample& sample);
  Result<void> take(mcap::Reader& mcap);
  void take_item(const ChannelUse& use, const std::string& topic, const RosItem& item, RosSample sample);
  void take_odometry(const ChannelUse& use, const std::string& topic, const RosItem& item, RosSample sample);

  RosSelection selection_;
  mcap::Item item_ = mcap::Item::end;
  std::uint64_t ordinal_ = 0, spent_ = 0;
  bool is_closed_ = false;
  std::map<std::string, std::uint32_t, std::less<>> numbers_;
  std::vector<const std::string*> names_;
  std::vector<RosSource> sources_;
  std::map<std::pair<RosSource::Kind, std::string>, std::uint32_t> by_topic_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> links_;                 // space and child
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> parents_;                        // space and name: is one there
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::optional<std::uint32_t>> found_;  // link_of(), once closed
  std::map<std::uint16_t, ChannelUse> uses_;
  std::map<std::string, int> channels_of_topic_;
  std::map<std::string, std::uint64_t> late_;
  std::map<std::uint32_t, std::uint64_t> copies_;
  std::map<std::uint32_t, Run> runs_;  // the last one of each source
  std::deque<RosSample> waiting_;      // of the last message
  std::vector<RosItem> items_;
};

}  // namespace tactus
