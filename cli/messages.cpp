// SPDX-License-Identifier: Apache-2.0
#include "cli/messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

#include <tactus/base/shown.h>

namespace tactus::cli {
namespace {

struct RuleText {
  std::string_view rule;
  const char* broken;  ///< what is wrong
  const char* remedy;  ///< what would mend it
};

constexpr const char* kNotAStream = "Give a stream file that `tactus encode` or `tactus sim --stream` wrote.";
constexpr const char* kNotATrace =
    "Give a trace that `tactus sim` or `tactus import` wrote, or another MCAP file with PoseStamped channels.";
constexpr const char* kDamaged = "The file was changed or cut after it was written; copy it again from its source.";
constexpr const char* kNewer = "It comes from a newer or another program; use that version of Tactus.";
constexpr const char* kEncoderFault = "Whatever encoded the stream has a defect, or the file was changed; encode it again.";
constexpr const char* kOrder =
    "Packets must be decoded in the order in which they were sent; go to a key packet and decode on from there.";

constexpr std::array kRules{
    RuleText{"R-API-1", "a value is not a finite number", "Look for gaps or NaN in the recording at this place."},
    RuleText{"R-API-2", "a position or velocity lies outside the stream's grid",
             "Check that the recording is in metres, seconds and radians (import takes --length-unit for other units)."},
    RuleText{"R-API-3", "a rotation is not a unit quaternion", "Check the order of its components: w, x, y, z."},
    RuleText{"R-API-4", "a threshold is zero, out of range or finer than the stream's grid",
             "Give -p above 0 (--haptic off for no bound of force), lengths of at least 2 um and angles of 0.002 to 180 deg."},
    RuleText{"R-API-5", "ticks do not increase, a count is wrong, or a contact is not valid",
             "Check that the inputs belong together and that the recording's times increase."},
    RuleText{"R-API-6", "an object moves along an axis that its degrees of freedom exclude",
             "Declare the axis in the scene or in the recording's channel (dof)."},
    RuleText{"R-API-7", "an object is further from where it is expected than an update can tell",
             "Check that the recording is in metres (import takes --length-unit for other units)."},
    RuleText{"R-API-9", "a mesh cannot have so many modes",
             "Take a smaller --basis: less than three modes per vertex that can move."},
    RuleText{"R-API-10", "a triangle of a mesh is so small that it has no area on the stream's grid of 0.24 um",
             "Merge the corners of such triangles; check that the mesh is in metres (import mesh takes --length-unit)."},
    RuleText{"R-API-11", "the machine gives no more memory", "End other programs, or take a smaller input."},
    RuleText{"R-STR-1", "this is not a Tactus stream", kNotAStream},
    RuleText{"R-STR-2", "the stream has a format version that this program does not know", kNewer},
    RuleText{"R-STR-3", "the stream has a profile that this program does not know", kNewer},
    RuleText{"R-STR-4", "reserved flags of the stream header are set", kNewer},
    RuleText{"R-STR-5", "the stream header ends inside an element", kDamaged},
    RuleText{"R-STR-6", "the tick rate is not within 1 to 1000000 per second", kEncoderFault},
    RuleText{"R-STR-7", "the grid exponents are out of range", kEncoderFault},
    RuleText{"R-STR-8", "the longest extrapolation is zero", kEncoderFault},
    RuleText{"R-STR-9", "the baseline span is not within 1 to 64", kEncoderFault},
    RuleText{"R-STR-10", "the scene declares an object of an unknown kind", kNewer},
    RuleText{"R-STR-11", "an object's name is empty, too long, no plain text, or there twice",
             "Give every object its own name of 1 to 255 bytes."},
    RuleText{"R-STR-12", "an object may turn about two axes, which no stream can say",
             "Declare rotation about none, one or all three axes."},
    RuleText{"R-STR-13", "an object's first rotation is not a unit quaternion", kEncoderFault},
    RuleText{"R-STR-14", "the scene is larger than this decoder accepts (4096 objects, 2^20 vertices, 2^21 triangles, 64 MiB)",
             "Split the scene into several streams."},
    RuleText{"R-STR-15", "the check value of the stream header does not match", kDamaged},
    RuleText{"R-STR-16", "extension records do not fill the stream header exactly", kEncoderFault},
    RuleText{"R-STR-17", "the bounds in the stream header are none", kEncoderFault},
    RuleText{"R-STR-18", "the states of this stream take more memory than this decoder accepts (256 MiB)",
             "Split the scene into several streams, or encode it with fewer baselines."},
    RuleText{"R-FIL-1", "the file cannot be written", "Check the free space of the disk and your permissions."},
    RuleText{"R-FIL-2", "the file ends inside a record", "The file was cut; `tactus info` tells how far it reads."},
    RuleText{"R-FIL-3", "a record has an unknown type", kNewer},
    RuleText{"R-FIL-4", "a packet is larger than this decoder accepts (64 MiB)", kEncoderFault},
    RuleText{"R-FIL-5", "the check value of a record does not match", kDamaged},
    RuleText{"R-FIL-6", "a record's time is missing, overlong or out of range", kEncoderFault},
    RuleText{"R-FIL-7", "the file and the packet in it name different ticks", kEncoderFault},
    RuleText{"R-FIL-8", "something follows the end of the stream", "Two files may have been joined; split them."},
    RuleText{"R-PKT-1", "the packet is larger than the decoder accepts", kEncoderFault},
    RuleText{"R-PKT-2", "the packet has fewer than two bytes", kEncoderFault},
    RuleText{"R-PKT-3", "the packet builds on a state that the stream does not keep", kEncoderFault},
    RuleText{"R-PKT-4", "the packet builds on a state that was never received", kOrder},
    RuleText{"R-PKT-5", "the packet is older than what was already decoded", kOrder},
    RuleText{"R-PKT-7", "the packet's number is far from that of the packet before it", kOrder},
    RuleText{"R-RIG-1", "the packet's tick is out of range or lies before the last one", kEncoderFault},
    RuleText{"R-RIG-3", "the packet announces more updates than there are objects, or none", kEncoderFault},
    RuleText{"R-RIG-4", "the packet names an object that is not there", kEncoderFault},
    RuleText{"R-RIG-6", "a rotation residual is longer than 1", kEncoderFault},
    RuleText{"R-PKT-6", "the packet belongs to a part of the scene that is not there", kEncoderFault},
    RuleText{"R-DEF-1", "the stream header announces meshes and has none", kEncoderFault},
    RuleText{"R-DEF-2", "a mesh has a profile that this program does not know", kNewer},
    RuleText{"R-DEF-3", "the coding parameters of a mesh are out of range", kEncoderFault},
    RuleText{"R-DEF-4", "a mesh has no vertices or is larger than accepted (2^20 vertices, 2^21 triangles)",
             "Simplify the mesh."},
    RuleText{"R-DEF-5", "a vertex of a mesh lies outside the stream's grid", kEncoderFault},
    RuleText{"R-DEF-6", "a triangle of a mesh names a vertex that is not there, or one twice", kEncoderFault},
    RuleText{"R-DEF-7", "the basis of a mesh is out of range", kEncoderFault},
    RuleText{"R-DEF-8", "the packet's tick is out of range or lies before the last one", kEncoderFault},
    RuleText{"R-DEF-9", "the packet names a triangle that is not there", kEncoderFault},
    RuleText{"R-DEF-10", "a bound in the packet is out of range", kEncoderFault},
    RuleText{"R-DEF-11", "the packet ends early or is not in its shortest form", kEncoderFault},
    RuleText{"R-DEF-12", "a count or range in the packet is out of range", kEncoderFault},
    RuleText{"R-DEF-13", "the packet names a vertex that is not there", kEncoderFault},
    RuleText{"R-RNG-2", "bytes are left over behind the packet's last symbol", kEncoderFault},
    RuleText{"R-RNG-3", "the packet ends with a zero byte, which is never the shortest form", kEncoderFault},
    RuleText{"R-RNG-4", "a coded number is too wide", kEncoderFault},
    RuleText{"R-TRC-1", "the file cannot be opened, read or written", "Check that the path is right and that you may use it."},
    RuleText{"R-TRC-2", "this is not an MCAP file, or its end is not", kNotATrace},
    RuleText{"R-TRC-3", "the file ends before its channels are declared", kDamaged},
    RuleText{"R-TRC-4", "a length reaches past the end of its record", kDamaged},
    RuleText{"R-TRC-5", "a record or chunk is larger than accepted (256 MiB)", "Write the recording with smaller chunks."},
    RuleText{"R-TRC-6", "a check value does not match", kDamaged},
    RuleText{"R-TRC-7", "compression, encoding or version is one that this program does not read",
             "Write the recording with zstd or without compression."},
    RuleText{"R-TRC-8", "a chunk is not zstd data of the announced size", kDamaged},
    RuleText{"R-TRC-9", "a record stands where it must not", kDamaged},
    RuleText{"R-TRC-10", "a schema or channel is not declared, or declared twice", kDamaged},
    RuleText{"R-TRC-11", "text is not UTF-8, or a key stands twice", kDamaged},
    RuleText{"R-TRC-12", "the channels lack something or contradict the trace's metadata", kNotATrace},
    RuleText{"R-TRC-13", "a message does not have its channel's type", kDamaged},
    RuleText{"R-TRC-14", "a value is not finite, or a contact, a time stamp or the size of a mesh is not valid",
             "Look for gaps or NaN in the recording at this place."},
    RuleText{"R-TRC-15", "ticks do not increase, or a tick lacks a message or has one twice",
             "Record every channel once per tick."},
    RuleText{"R-TRC-16", "there is no PoseStamped channel to read objects from", kNotATrace},
    RuleText{"R-TRC-17", "the trace's description is not valid",
             "Give every object and user its own plain name, and a tick rate of 1 to 1000000."},
    RuleText{"R-TRC-18", "the file unpacks to, or repeats, far more than its size has earned",
             "Write the recording without compression, or only with the objects that move."},
    RuleText{"R-SRF-8", "a mesh has a vertex that is not finite or far beyond any scene", kDamaged},
    RuleText{"R-SRF-9", "a triangle of a mesh names a vertex that is not there", kDamaged},
    RuleText{"R-SRF-10", "a triangle of a mesh has no area", kDamaged},
    RuleText{"R-SRF-11", "an edge of a mesh belongs to more than two triangles", kDamaged},
    RuleText{"R-SRF-12", "two neighbouring triangles of a mesh are oriented differently", kDamaged},
    RuleText{"R-SRF-13", "parts of a mesh hang together by a single vertex", kDamaged},
    RuleText{"R-SRF-14", "a mesh is larger than accepted (2^20 vertices, 2^21 triangles)", "Simplify the mesh."},
    RuleText{"R-CSV-1", "the table has no line of names and one of values, or its zstd data ends early",
             "Give a table whose first line names the columns."},
    RuleText{"R-CSV-2", "a column is not there, or there twice", "Compare the mapping with the first line of the table."},
    RuleText{"R-CSV-3", "the row has more or fewer fields than there are columns", "Mend the row or remove it."},
    RuleText{"R-CSV-4", "the field is not a finite number", "Mend the field or remove the row."},
    RuleText{"R-CSV-5", "time does not increase within a segment",
             "Name the column that tells segments apart (--segment), or sort the rows."},
    RuleText{"R-CSV-6", "a line is longer than 1 MiB", "Give a table with one sample per line."},
    RuleText{"R-CSV-7", "the rate of the recording is unknown", "Give --tick-rate HZ, or --time COLUMN."},
    RuleText{
        "R-CSV-8",
        "the mapping names some columns of a vector but not all, nothing to record, or spins of the body frame without rotations",
        "Give --preset NAME, or --map with every column of a quantity."},
    RuleText{"R-CSV-9", "the zstd data unpacks to far more than its size has earned",
             "Unpack it with zstd and give the table itself."},
    RuleText{"R-SIM-2", "the scene has deformable objects, and this program was built without them",
             "Install libeigen3-dev, libsuitesparse-dev and libspectra-dev, and build with TACTUS_WITH_FEM=ON."},
    RuleText{"R-SIM-3",
             "the springs of all users together are too stiff for a one-dimensional object at its rate (thesis eq. 4.38)",
             "Lower touch.stiffness, or msd.rate (--rate), or give the object more mass or damping."},
    RuleText{"R-SIM-4", "a basis of vibration modes was asked for, and this program was built without their solver",
             "Install libeigen3-dev and libspectra-dev and build with TACTUS_WITH_MODES=ON, or leave --basis out."},
    RuleText{"R-SIM-5", "the vibration modes of a mesh cannot be found",
             "Take a smaller --basis, or a mesh whose parts hang together."},
    RuleText{"R-SIM-6", "too many objects touch each other (65536 contacts in one tick)", "Move them apart, or take fewer."},
    RuleText{"R-TET-1", "a vertex of a tetrahedral mesh is not finite or farther away than 1000 km",
             "Mend the mesh; its lengths are metres."},
    RuleText{"R-TET-2", "a tetrahedron names a vertex that is not there", "Mend the mesh; check whether it counts from 0 or 1."},
    RuleText{"R-TET-3", "a tetrahedron has no volume", "Mend the mesh: `tactus mesh` makes one without flat tetrahedra."},
    RuleText{"R-TET-4", "a tetrahedron is inside out", "Turn its corners round: (b-a) x (c-a) . (d-a) must be positive."},
    RuleText{"R-TET-5", "tetrahedra overlap at a face", "Mend the mesh: each face belongs to at most two tetrahedra."},
    RuleText{"R-TET-6", "a vertex of a tetrahedral mesh belongs to no tetrahedron", "Remove it from the mesh."},
    RuleText{"R-TET-7", "a tetrahedral mesh is larger than accepted (2^20 vertices, 2^22 tetrahedra)", "Take a coarser one."},
    RuleText{"R-FEM-1", "a material of a deformable object is out of range",
             "Give young and density within 0 to 1e15, and poisson above -1 and below 0.5."},
    RuleText{"R-FEM-2", "a deformable object has neither one material nor one for each tetrahedron",
             "Give one material, or one for each tetrahedron."},
    RuleText{"R-FEM-3", "a fixed vertex of a deformable object is not there", "Fix only vertices of its mesh."},
    RuleText{"R-FEM-4", "a damping of a deformable object is negative or not finite", "Give dampings of at least 0."},
    RuleText{"R-FEM-5", "a force, displacement or step of a deformable object is not finite",
             "Look for gaps or NaN in the recording at this place."},
    RuleText{"R-FEM-6", "a deformable object could not follow its motion at this step",
             "Take another --method, a --rate nearer to 1, or a softer coupling."},
    RuleText{"R-FEM-7", "a deformable object's system matrix cannot be factored",
             "Fix at least three of its vertices that do not lie on a line, or give it less extreme materials."},
    RuleText{"R-FEM-8", "the method cannot deform an object at this step", "Take another --method, or a --rate nearer to 1."},
    RuleText{"R-SIM-1", "the physics broke down: a state is no longer finite",
             "Soften the scene: a lower stiffness, or a heavier object."},
};

}  // namespace

std::string place_of_bit(std::uint64_t bit_offset) {
  if (bit_offset == 0) return {};
  if (bit_offset % 8 == 0) return fmt::format("byte {}", bit_offset / 8);
  return fmt::format("byte {}, bit {}", bit_offset / 8, bit_offset % 8);
}

tl::unexpected<Failure> refuse(const std::string& file, const std::string& place, const Error& error) {
  const int cause = error.code == Errc::io ? errno : 0;
  const auto* text = std::find_if(kRules.begin(), kRules.end(), [&](const RuleText& r) { return r.rule == error.rule; });
  const bool known = text != kRules.end();
  auto refused =
      refuse_told(fmt::format("{}{}{}: {}{}{} ({}, {})", shown_path(file), place.empty() ? "" : ", ", place,
                              known ? text->broken : "breaks a rule of the specification", cause == 0 ? "" : ": ",
                              cause == 0 ? "" : std::generic_category().message(cause), errc_name(error.code), error.rule),
                  file, place, error);
  if (cause != 0) refused.value().remedy = remedy_of(cause);
  else if (known) refused.value().remedy = text->remedy;
  return refused;
}

tl::unexpected<Failure> refuse_told(std::string text, const std::string& file, const std::string& place, const Error& error) {
  auto refused = refuse(std::move(text), "");
  refused.value().file = file;
  refused.value().place = place;
  refused.value().error_class = errc_name(error.code);
  refused.value().rule = error.rule;
  return refused;
}

tl::unexpected<Failure> refuse(const std::string& file, const Error& error) {
  return refuse(file, place_of_bit(error.bit_offset), error);
}

std::string remedy_of(int cause) {
  switch (cause) {
    case ENOSPC:
    case EDQUOT:
      return "Make room on this disk, or write to another one.";
    case EACCES:
    case EPERM:
    case EROFS:
      return "Check that you may use this file and its folder.";
    case ENOENT:
    case ENOTDIR:
      return "Check that the path is right.";
    default:
      return "Check that the path is right and that you may use it.";
  }
}

tl::unexpected<Failure> refuse_io(const std::string& file, const std::string& what, int cause) {
  auto refused = refuse(shown_path(file) + ": " + what + ": " + std::generic_category().message(cause), remedy_of(cause));
  refused.value().file = file;
  refused.value().error_class = errc_name(Errc::io);
  return refused;
}

tl::unexpected<Failure> refuse(std::string text, std::string remedy) {
  return tl::unexpected(Failure{std::move(text), std::move(remedy)});
}

tl::unexpected<Failure> refuse_arguments(std::string text, std::string remedy) {
  return tl::unexpected(Failure{std::move(text), std::move(remedy), Failure::Cause::arguments});
}

}  // namespace tactus::cli
