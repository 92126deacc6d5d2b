// SPDX-License-Identifier: Apache-2.0
/// Recordings for the 3-D panels of Foxglove and Lichtblick: MCAP with scene updates, transforms, and what plots need.
///
/// topic                        message                                        when
/// /tf                          foxglove_msgs/msg/FrameTransforms              each time that is written; frames objects/NAME, users/NAME,
///                                                                             meshes/NAME in "world"
/// /scene/objects               foxglove_msgs/msg/SceneUpdate                  the first time; entities that move with their frames
/// /scene/meshes/<name>         foxglove_msgs/msg/SceneUpdate                  the first time, and when the shape is new
/// /scene/users/<name>          foxglove_msgs/msg/SceneUpdate                  each time: device, touched point, forces
/// /objects/<name>/pose, /users/<name>/device, force, server_force             as in a trace (trace_file.h), each time that is written
/// A force that the trace does not know (KnownForces) has neither topic nor arrow.
///
/// A viewer that jumps in time takes up the last message of every topic: what an entity needs is whole in the last message of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/trace/frame.h>

namespace tactus {

/// What a rigid object looks like, around its origin.
struct FoxgloveShape {
  Vec3 box{};         ///< [m] edge lengths; all zero: not known, its axes are drawn
  TriMesh surface{};  ///< [m] with triangles, instead of the box
};

struct FoxgloveOptions {
  double rate = 60;                 ///< [Hz] at most, > 0
  double metres_per_newton = 0.05;  ///< length of a force's arrow, > 0
};

class FoxgloveWriter {
 public:
  /// path "-" is standard output.
  /// in   shapes  of the first objects; the others' are not known
  /// err  io R-TRC-1; invalid_argument R-TRC-17 as TraceWriter, or an option
  static Result<FoxgloveWriter> create(const std::string& path, const TraceInfo& info, std::vector<FoxgloveShape> shapes,
                                       const FoxgloveOptions& options = {});

  /// Write a frame, if one is due.   pre  frames of a trace that is described by the info, in their order
  Result<void> write(const TraceFrame& frame);
  Result<void> finish();
  std::uint64_t messages() const noexcept;

  FoxgloveWriter(FoxgloveWriter&&) noexcept;
  FoxgloveWriter& operator=(FoxgloveWriter&&) noexcept;
  ~FoxgloveWriter();

 private:
  struct Impl;
  explicit FoxgloveWriter(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
