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
///   force and server_force  known ("no": nobody told it, see KnownForces; left out if known)
///   rest channels           fixed (vertex numbers, ascending, blanks between; left out if none), period (ticks; left out if 1)
/// The scene is the attachment "scene.toml". Chunks end at whole ticks, after 1 MiB or TraceWriterOptions::chunk_time.
///
/// rule      class             broken when
/// R-TRC-1   io                the operating system refuses to open, read or write the file; errno tells why
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
///                             shown at a tick is not of a tick, or of an earlier one than before
/// R-TRC-16  unsupported       a foreign file without poses, transforms and forces, or with a topic or frame that begins after the
///                             look-ahead or shares its name, or with a frame that comes to hang on another one
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

#include <tactus/base/result.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/read_notes.h>
#include <tactus/trace/trace_error.h>

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

enum class OnDamage : std::uint8_t { refuse, skip };

/// What of a recording was left out because it is damaged.
struct TraceLoss {
  std::string file{};                            ///< of a recording of several files
  Error cause{};                                 ///< its offset is that of the record
  std::uint64_t bytes = 0;                       ///< 0: not known
  std::optional<std::uint64_t> from{}, until{};  ///< [ns] log times, if something tells them
};

/// Reads a trace front to back, one frame at a time, in memory bounded by a chunk. Foreign ROS 2 recordings are read too:
///
///   PoseStamped, Odometry          each topic is an object; its motion is the odometry's, or the TwistStamped topic beside it (same path
///                                  except for the last part), else backward differences
///   TransformStamped, TFMessage    each frame that hangs on another one is an object, in the frame that hangs on none
///   WrenchStamped                  each topic is a user who feels the force, where its frame is, or the one object of a topic beside it;
///                                  a force in a known frame is turned to the world
///
/// Ticks follow from log_time and the median spacing of the topic or frame with the most samples. What a topic said last holds; frames
/// begin when every object has a pose.
class TraceReader {
 public:
  /// in   path  a file, a bag's folder or its metadata.yaml; "-" is standard input. zstd and LZ4 files are unpacked on the way
  ///      on_damage  skip: what is damaged is left out and told by losses(); a tick that lacks something then is left out, too
  /// err  io R-TRC-1; malformed, truncated, invalid, unsupported, checksum, limit_exceeded: R-TRC-n, R-SRF-n
  static TraceResult<TraceReader> open(const std::string& path, OnDamage on_damage = OnDamage::refuse);
  /// The same from memory that outlives the reader.
  static TraceResult<TraceReader> open_memory(std::span<const std::uint8_t> bytes);
  const TraceInfo& info() const noexcept;
  /// Number of frames if the file's summary tells it.
  std::optional<std::uint64_t> frame_count() const noexcept;
  /// Read the next frame into `frame`; false at the end. Pass the frame of the previous call: its vectors are reused, and a shape
  /// that is not new stays in it. Do not use the reader after an error.
  TraceResult<bool> next(TraceFrame& frame);
  /// What was decided about the files of a folder.
  std::vector<ReadNote> file_notes() const;
  /// What OnDamage::skip left out so far.
  std::vector<TraceLoss> losses() const;
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
