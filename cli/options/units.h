// SPDX-License-Identifier: Apache-2.0
/// Quantities as people type them: 2deg, 5mm, 4%, 100ms, 0.05N. Results are in SI units.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "cli/command.h"

namespace tactus::cli {

enum class Dimension { length, angle, time, force, fraction };

struct Quantity {
  double value = 0;   ///< SI; a bare number as it stands
  bool bare = false;  ///< typed without a unit
};

enum class Bare { refused, allowed };

/// err  a sentence that names the text, what is wrong and what would be right. A length, an angle and a time need their unit: a bare 6
///      is too easily meant in millimetres, a 2 in degrees, a 500 in milliseconds. Only 0 needs none.
tl::expected<Quantity, std::string> parse_quantity(std::string_view typed, Dimension dimension, Bare bare = Bare::refused);

/// A length and an angle, "0.3mm,2deg"; blanks may stand between. The length may be bare: needs_unit() refuses it where no option
/// says its unit.
struct PoseBound {
  Quantity length;
  Quantity angle;
};
tl::expected<PoseBound, std::string> parse_pose_bound(std::string_view text);
std::string needs_unit(std::string_view text, Dimension dimension);  ///< the sentence that refuses a bare number

/// Option that takes one quantity in SI units.
Option* add_quantity(Command& app, const std::string& name, double& value, Dimension dimension, const std::string& help);
/// Checks for such options, both ends included. They name what was typed and the range.   in  low, high  as typed: "1ms"
Check within(Dimension dimension, const std::string& low, const std::string& high);
Check above_zero(Dimension dimension);
/// Option that takes LENGTH,ANGLE.
Option* add_pose_bound(Command& app, const std::string& name, PoseBound& value, const std::string& help);

}  // namespace tactus::cli
