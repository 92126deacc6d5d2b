// SPDX-License-Identifier: Apache-2.0
/// What the figures of `tactus reproduce` share.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactus/sim/link/link.h>
#include <tactus/sim/scene/scene.h>
#include "cli/command.h"
#include "cli/figure/plot.h"
#include "cli/options/options_codec.h"
#include "cli/report/messages.h"

namespace tactus::cli {

struct ReproduceOptions {
  std::string figure = "fig3.14";
  std::uint32_t seeds = 5;
  double length_unit = 0.05;  ///< [m]
  std::string grip = "normal";
  double pace = 0.5,
         tremor = 0.4e-3;  ///< of the faster hand, [m]; both were chosen because they bring our rates near the thesis's
  std::string directory;   ///< of figures and tables; empty: none are written
  CommonOptions common;
};

/// The scene with the faster hand.
sim::Scene with_faster_hand(sim::Scene scene, const ReproduceOptions& options);
/// What is told of that hand beside its numbers.
std::string about_faster_hand(const ReproduceOptions& options);

/// Drawn by `tactus reproduce FIGURE -o`; the others are tables.
bool is_drawn(std::string_view figure);

/// Make the folder of a figure.   err  it cannot be made
Outcome make_folder(const std::string& directory);
/// Write a figure, and tables by their names, to the folder of the options; nothing if there is none.
Outcome write_figure(const ReproduceOptions& options, const Plot& plot,
                     const std::vector<std::pair<std::string, std::string>>& tables);

/// Figure 3.3: why updates are sent while a cube is pushed.
Outcome reproduce_traffic(const ReproduceOptions& options);
/// Figure 3.11: the rendered force with and without interpolation.
Outcome reproduce_interpolation(const ReproduceOptions& options);
/// Figure 3.8: what the ways of interpolation do to force and object.
Outcome reproduce_ways(const ReproduceOptions& options);
/// Figure 3.6: packets per second that a client gets when it is sent object states, and when it is sent forces.
Outcome reproduce_architectures(const ReproduceOptions& options);
/// Figure 3.10: updates per second in contact, at the deadbands that the subjects chose.
Outcome reproduce_adjusted(const ReproduceOptions& options);
/// Figures of what users of a scene feel behind a network: 4.1, 4.2, 4.6, 4.8, 4.10 to 4.12, 4.25, 4.27.
bool is_touch_figure(const std::string& figure);
Outcome reproduce_touch(const ReproduceOptions& options);
/// The network of thesis 4.2.4.3 and 4.2.4.4, one way: 25 ms and a gamma-distributed delay that keeps its value for a while.
sim::LinkOptions varying_network();
/// Figures 4.13a, 4.16, 4.17 and 4.23: a delay that varies, limits of stability, the stiffness of a surface.
bool is_limit_figure(const std::string& figure);
Outcome reproduce_limits(const ReproduceOptions& options);
/// Figures 4.7, 4.18, 4.20, 4.21, 4.22 and 4.24: what delay does to the force at a client, and compensation.
Outcome reproduce_delay(const ReproduceOptions& options);

/// All of them, in one report.
Outcome reproduce_all(const ReproduceOptions& options);

}  // namespace tactus::cli
