// SPDX-License-Identifier: Apache-2.0
/// Trace files: MCAP with zstd chunks and ROS 2 CDR messages.
///
/// topic                        message (header.frame_id "world", of contact the object's name)   when
/// /objects/<name>/pose         geometry_msgs/msg/PoseStamped       first tick, and ticks at which pose or twist is new
/// /objects/<name>/twist        geometry_msgs/msg/TwistStamped      with the pose, objects that can move
/// /users/<name>/device         geometry_msgs/msg/PointStamped      every tick
/// /users/<name>/device_orientation  geometry_msgs/msg/QuaternionStamped  every tick    these four only if the device senses them
/// /users/<name>/device_velocity     geometry_msgs/msg/Vector3Stamped     every tick
/// /users/<name>/device_buttons      tactus_msgs/msg/Buttons              first tick, and when it is new
/// /users/<name>/device_time         sensor_msgs/msg/TimeReference        every tick
/// /users/<name>/device_reports      tactus_msgs/msg/Reports              ticks with reports; only of a device that nobody interprets
/// /users/<name>/servo          tactus_msgs/msg/Servo               every tick of a captured device
/// /users/<name>/force          geometry_msgs/msg/Vector3Stamped    every tick
/// /users/<name>/server_force   geometry_msgs/msg/Vector3Stamped    every tick
/// /users/<name>/contact        tactus_msgs/msg/Contact             ticks with contact
/// /users/<name>/mesh_contact   tactus_msgs/msg/MeshContact         ticks with contact; only if there are meshes
/// /meshes/<name>/rest          shape_msgs/msg/Mesh (no header)     first tick
/// /meshes/<name>/displacement  tactus_msgs/msg/Displacements       ticks at which the shape is new; before the first, rest
/// /shown                       sensor_msgs/msg/TimeReference       every tick of a client behind a network: the time of what it shows
/// /markers                     rcl_interfaces/msg/Log (no header)  ticks that the experimenter marked; only of a capture
/// If no other channel has a message every tick, the first object's pose has one; without objects, the first mesh's displacement.
///
/// log_time, publish_time and header.stamp are round(tick * 1e9 / tick_rate), sequence is tick mod 2^32. Metadata:
///   record "tactus"         format_version ("2"; in "1" poses and twists come every tick), tick_rate, source, objects, users
///                           and, if there are any, meshes (names in order, one per line)
///   record "tactus_bounds"  of a replica: bounds of its stream (trace_bounds.h)
///   record "tactus_capture" of a capture: who, what and when (trace_capture.h)
///   pose channels           dof
///   reports channels        report_descriptor (hexadecimal)
///   force and server_force  known ("no": it is not, see RecordedForces; left out if known)
///   rest channels           fixed (vertex numbers, ascending, blanks between; left out if none), period (ticks; left out if 1)
/// The scene is the attachment "scene.toml". Chunks end at whole ticks, after 1 MiB or TraceWriterOptions::chunk_time.
///
/// rule      class             broken when
/// R-TRC-1   io                the operating system refuses to open, read or write the file; errno says why
/// R-TRC-2   malformed         MCAP's magic bytes are not at the front, or not at the very end behind a footer
///           unsupported       the file is of another known kind, or a folder holds no bag of MCAP files
/// R-TRC-3   truncated         the file ends before the header, the channels that its metadata announces, or any pose,
///                             or the first tick of a recording with meshes
/// R-TRC-4   malformed         a length inside a record reaches past the record's end
/// R-TRC-5   limit_exceeded    a record, a chunk or all declarations are larger than accepted
/// R-TRC-6   checksum          a CRC-32 does not match
/// R-TRC-7   unsupported       compression, message encoding (ROS 1, protobuf, JSON) or version that this reader does not know
/// R-TRC-8   malformed         a chunk's records or a compressed message are no zstd or LZ4 data of exactly the announced size, or a
///                             compressed file is damaged
/// R-TRC-9   malformed         a record or the summary stands where it must not
///           invalid           the footer points elsewhere than to the summary
/// R-TRC-10  invalid           a schema or channel is used undeclared or declared twice with a difference
/// R-TRC-11  invalid           text is not UTF-8, or a key stands twice in a map
/// R-TRC-12  invalid           the "tactus" or "tactus_bounds" metadata or the channels lack something or contradict each other
/// R-TRC-13  malformed         a message is not CDR of its channel's type
/// R-TRC-14  invalid           a value is NaN or infinite, a contact, an orientation or a time of a device or a time stamp is invalid, or a
///                             mesh has another number of vertices
/// R-TRC-15  invalid           ticks do not increase, a message's times disagree, a tick lacks a message or has one twice, or what is
///                             shown at a tick is not of a tick, or of an earlier one than before; of a foreign file, a sample is over
///                             2^31 s behind the first
/// R-TRC-16  unsupported       a foreign file without poses, transforms and forces that can be used
/// R-TRC-17  invalid_argument  TraceInfo: nothing to record, over 65535 channels, tick rate not in 1..1000000, dof bits, fixed
///                             vertices or the period of a mesh, bounds of another number of meshes, or a name that is empty, repeated,
///                             over 255 bytes, not UTF-8 or has '/' or control characters
/// R-TRC-18  limit_exceeded    chunks unpack to more, or objects of which nothing is said at a tick are more, than the file's size has
///                             earned (input_budget.h)
/// R-SRF-n   as tri_mesh.h     a mesh's rest shape
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/base/result.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/read_notes.h>

namespace tactus {

struct TraceWriterOptions {
  double chunk_time = 1;  ///< [s] a crash loses at most so much; shorter chunks compress less
};

/// Writes a trace as it happens. If the process dies, the file is readable up to its last whole chunk.
class TraceWriter {
 public:
  /// path "-" is standard output.   err  io R-TRC-1; invalid_argument R-TRC-11 (texts), R-TRC-17, R-SRF-n
  static Result<TraceWriter> create(const std::string& path, const TraceInfo& info, const TraceWriterOptions& options = {});
  /// in   frame  tick >= 0 and larger than the last. A user's device sample is always kept; without contact, `contact` and
  ///             contact.device are ignored. A mesh that was not updated is not written
  /// time O(changes), about 15 instructions for each object at rest, and the every-tick messages of users and meshes
  /// err  invalid_argument R-API-1 not finite; R-API-5 wrong count, tick, contact, orientation or time of a device; R-API-6 a static
  ///      object moved; io R-TRC-1. Nothing was written after invalid_argument. After io and limit_exceeded R-API-11 (no memory) the
  ///      writer is unusable.
  Result<void> write(const TraceFrame& frame);
  /// Summary, index and footer. A writer destroyed without it leaves a readable but unindexed file.
  Result<void> finish();

  TraceWriter(TraceWriter&&) noexcept;
  TraceWriter& operator=(TraceWriter&&) noexcept;
  ~TraceWriter();

 private:
  struct Impl;
  explicit TraceWriter(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

/// Which times of a recording of another program are its samples' times.
enum class RosStamps : std::uint8_t {
  automatic,  ///< log times, unless header stamps are clearly better
  header,
  log,
};

/// A topic of a file, and how many of its messages were read.
struct TraceTopic {
  std::string topic, type;
  std::uint64_t messages = 0;
};

/// How a recording of another program is read. Our own traces leave nothing to choose.
struct ReadOptions {
  std::vector<std::string>
      topics{};  ///< whose poses, frames and forces become objects and users; empty: all. Trees place them all the same
  std::vector<std::string> skip{};  ///< topics that are not read at all, and objects that are left out
  bool strict = false;              ///< refuse a recording with a missing sample
  double gap = 0;                   ///< [s] longest time to interpolate over; 0: see TraceReader
  std::uint32_t tick_rate = 0;      ///< 1 .. 1000000; 0: follows from the recording
  RosStamps stamps = RosStamps::automatic;
  OnDamage on_damage = OnDamage::refuse;  ///< also of our own traces
  ReadWatcher* watcher = nullptr;         ///< of the look at a foreign recording that open() takes; may be null
};

/// Reads a trace front to back, one frame at a time, in memory bounded by a chunk. Foreign ROS 2 recordings are read too. What is decided
/// where they leave something open is in notes().
///
/// What becomes what
///   PoseStamped, Odometry          each topic is an object; its motion is the odometry's, or the TwistStamped topic beside it (same path
///                                  except for the last part), else that of its poses: at a sample from the one before to the one after,
///                                  between samples on the line between their velocities
///   TransformStamped, TFMessage    each frame that hangs on another one is an object; /r1/tf is a tree of its own, whose frame `base` is
///                                  the object r1.base
///   WrenchStamped                  each topic is a user who feels the force, where its frame is, or the one object of a topic beside it
///   One topic on several channels is one source. Torques and covariances are ignored; other types are not read.
/// Frames
///   What is expressed in a frame is turned and moved into the world: the frame that hangs on none. Leading slashes of names are dropped. The
///   frames of a topic /r1/... are looked up in the tree of /r1/tf, then in the common one. An odometry's twist is expressed in child_frame_id:
///   that frame of the tree, else the frame of the pose. A frame that comes to hang on another one is followed from then on; a transform
///   that closes a loop is left out.
/// Time
///   Log times are the clock; header stamps are, where they are regular and log times come in bursts or jitter. Bursts without such stamps
///   are spread evenly. The tick rate is that of the topic or frame with the most samples: their count over their length without pauses and
///   lost samples, rounded to the roundest whole number within its uncertainty. Where a clock is set back, what follows goes on there.
///   Messages are sorted; a window holds back as much as the recording is out of order, at most 262144 samples.
/// Between samples
///   At each tick poses, transforms, forces and twists follow a line and the shorter arc between the samples around it, if these are not
///   farther apart than the gap: 3 times the median gap of the source, at least 0.1 s and at most 10 s. Over longer gaps, ahead of its first
///   sample and after its last, an object rests at the sample beside; a force is held for as long as the gap and is 0 beyond. A transform
///   of /tf_static holds until it changes. Ticks at which nothing is recorded by any source are left out. Of samples with the same time the
///   last counts; one with the stamp and the value of the sample before is left out as a copy.
/// Missing samples
///   A message that is not of its type, a number that is NaN, infinite or beyond 1e15, a rotation whose length is off 1 by more than 2 %:
///   such a sample counts as missing.
///
/// A file and memory are read twice: all is looked at before the first frame, in memory for statistics alone. Of a pipe the first 4096
/// samples are; topics and frames that begin later are left out.
class TraceReader {
 public:
  /// in   path  a file, a bag's folder or its metadata.yaml; "-" is standard input. zstd and LZ4 files are unpacked on the way
  /// err  io R-TRC-1; malformed, truncated, invalid, unsupported, checksum, limit_exceeded: R-TRC-n, R-SRF-n
  static Result<TraceReader> open(const std::string& path);
  /// The same, where an error says what is wrong, where, and what repairs it.
  static tl::expected<TraceReader, Diagnostic> open(const std::string& path, const ReadOptions& options);
  /// The same from memory that outlives the reader.
  static Result<TraceReader> open_memory(std::span<const std::uint8_t> bytes);
  static tl::expected<TraceReader, Diagnostic> open_memory(std::span<const std::uint8_t> bytes, const ReadOptions& options);
  /// What was decided about the files of a folder and about a foreign recording; complete once next() has returned false.
  std::vector<ReadNote> notes() const;
  /// What OnDamage::skip left out so far.
  const std::vector<ReadLoss>& losses() const noexcept;
  /// The last error of next(), with what is known beyond its rule.
  Diagnostic explain(const Error& error) const;
  const TraceInfo& info() const noexcept;
  /// Number of frames if the file's summary states it.
  std::optional<std::uint64_t> frame_count() const noexcept;
  /// Read the next frame into `frame`; false at the end. Pass the frame of the previous call: its vectors are reused, and a shape
  /// that is not new stays in it. Do not use the reader after an error.
  Result<bool> next(TraceFrame& frame);
  /// All that the file declares, and what was read of it so far.
  std::vector<TraceTopic> topics() const;
  /// Bytes of the files that were read, and of all; none for a pipe.
  struct Bytes {
    std::uint64_t read = 0;
    std::optional<std::uint64_t> all{};
  };
  Bytes bytes() const;
  /// True if the file ends early (crash, truncation); everything up to its last whole chunk was delivered. Valid once next() has
  /// returned false.
  bool cut_short() const noexcept;

  TraceReader(TraceReader&&) noexcept;
  TraceReader& operator=(TraceReader&&) noexcept;
  ~TraceReader();

 private:
  struct Impl;
  explicit TraceReader(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
