// SPDX-License-Identifier: Apache-2.0
/// Options that several commands share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactus/client/replica.h>
#include <tactus/sender.h>
#include <tactus/trace/trace_scene.h>
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/progress.h"

namespace tactus::cli {

/// What every command that writes or reports takes.
struct CommonOptions {
  const Command* command = nullptr;  ///< knows which options were typed
  bool json = false, quiet = false, no_progress = false, force = false;

  Visibility progress() const { return quiet || no_progress ? Visibility::hidden : Visibility::shown; }
  OutputFile::Existing existing() const { return force ? OutputFile::Existing::replace : OutputFile::Existing::keep; }
};
/// err  `output` is standard output and that a terminal: what the command writes is no text
Outcome check_no_terminal(const std::string& output);
void add_report_options(Command& app, CommonOptions& options);
void add_output_options(Command& app, CommonOptions& options);  ///< those of add_report_options, and -f

/// When an update is worth sending, as typed.
class TriggerArguments {
 public:
  void add_to(Command& app);
  /// Options of the encoder itself, beyond the bounds.
  void add_encoder_to(Command& app);
  bool any_given() const;
  RigidTriggers triggers() const { return over({}); }
  bool reduces() const { return !no_reduction_; }
  /// The bounds that were typed, for the others those of `out`.
  RigidTriggers over(RigidTriggers out) const;
  /// For meshes: what -p says, `otherwise` if it was not given; none if --haptic is off.
  std::optional<double> weber_fraction(std::optional<double> otherwise) const;
  double key_interval() const { return key_interval_; }

 private:
  /// Bounds that no encoder can hold end the parsing.
  void check_lengths() const;
  void check_bound(const Option& option, const PoseBound& bound) const;
  double scaled(const Quantity& length) const { return length.bare ? length.value * length_unit_ : length.value; }

  RigidTriggers triggers_;
  PoseBound visual_{{triggers_.visual_position, false}, {triggers_.visual_rotation, false}};
  PoseBound fixed_{{triggers_.fixed_position, false}, {triggers_.fixed_rotation, false}};
  double length_unit_ = 1;
  double key_interval_ = SenderPolicy{}.key_interval;
  bool no_reduction_ = false;
  const Option *deadband_ = nullptr, *haptic_ = nullptr, *alpha_ = nullptr, *jnd_fraction_ = nullptr, *floor_ = nullptr,
               *visual_option_ = nullptr, *fixed_option_ = nullptr, *length_unit_option_ = nullptr;
  std::vector<const Option*> options_;
};

/// Constants of motion of a recording, as typed.
class MotionArguments {
 public:
  void add_to(Command& app);
  MotionPhysics physics() const { return {{0, 0, -gravity_}, friction_}; }

 private:
  double gravity_ = 0, friction_ = 0;
};

/// How deformable objects are coded and bounded, as typed. The deadband is that of TriggerArguments, its default another.
class MeshArguments {
 public:
  void add_to(Command& app);
  /// Options of the encoder itself, beyond the bounds.
  void add_encoder_to(Command& app);
  bool any_given() const;
  DeformableThresholds thresholds(const TriggerArguments& triggers) const { return over({}, triggers); }
  /// The bounds that were typed, for the others those of `out`.
  DeformableThresholds over(DeformableThresholds out, const TriggerArguments& triggers) const;
  std::uint8_t rings(std::uint8_t otherwise) const { return rings_->count() > 0 ? coding_.rings : otherwise; }
  /// What a sender takes, with the triggers.
  SenderOptions sender(const TriggerArguments& triggers) const;
  std::uint8_t rings() const { return coding_.rings; }
  TraceCoding coding(const TriggerArguments& triggers) const;
  bool is_main() const { return coding_.profile == DeformableProfile::main; }

 private:
  DeformableThresholds thresholds_;
  DeformableCoding coding_;
  std::uint32_t modes_ = 0;
  double visual_fraction_ = 1, haptic_fraction_ = 1, fade_fraction_ = 0;
  const Option *visual_ = nullptr, *rings_ = nullptr, *fade_ = nullptr, *fractions_[2]{};  // visual, haptic
  std::vector<const Option*> options_;
};

/// Every option of both: for commands that encode.
void add_encoder_options(Command& app, TriggerArguments& triggers, MeshArguments& deformables);

/// Accept whole numbers from `low` to `high` only.
Check whole_number(std::uint64_t low, std::uint64_t high);
/// Accept numbers from `low` on; where they end, the library knows.
Check number_from(double low);
/// Accept numbers from `low` to `high` only.
Check number(double low, double high);

/// --interpolate
Option* add_interpolation(Command& app, ReplicaOptions& options);

}  // namespace tactus::cli
