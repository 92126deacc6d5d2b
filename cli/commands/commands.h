// SPDX-License-Identifier: Apache-2.0
/// Every command adds itself to the program, or to its group: `setup_import_mesh` is `tactus import mesh`. CMakeLists.txt says which of
/// them a program has.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/command.h"

namespace tactus::cli {

void setup_sim(Command& app, Action& action);
void setup_mesh(Command& app, Action& action);
void setup_import(Command& app, Action& action);
void setup_import_ros(Command& group, Action& action);
void setup_import_mesh(Command& group, Action& action);
void setup_encode(Command& app, Action& action);
void setup_decode(Command& app, Action& action);
void setup_compare(Command& app, Action& action);
void setup_view(Command& app, Action& action);
void setup_info(Command& app, Action& action);
void setup_tolerable(Command& app, Action& action);
void setup_capture(Command& app, Action& action);
void setup_play(Command& app, Action& action);
void setup_devices(Command& app, Action& action);
void setup_cut(Command& app, Action& action);
void setup_merge(Command& app, Action& action);
void setup_recover(Command& app, Action& action);
void setup_resample(Command& app, Action& action);
void setup_export(Command& app, Action& action);
void setup_export_figure(Command& group, Action& action);
void setup_export_foxglove(Command& group, Action& action);
void setup_export_mesh(Command& group, Action& action);
void setup_export_pcap(Command& group, Action& action);
void setup_link(Command& app, Action& action);
void setup_serve(Command& app, Action& action);
void setup_join(Command& app, Action& action);
void setup_key(Command& app, Action& action);
void setup_help(Command& app, Action& action);
void setup_completion(Command& app, Action& action);

/// --node and --axes, of files with surfaces.
void add_scene_options(Command& command, std::string& node, std::string& axes);

/// Whether a command is a script of lab/, which takes all that follows its name.
bool is_script(std::string_view command);
/// Name it in the help, the manual and the completion.   pre  is_script(name)
void setup_script(Command& app, std::string_view name, Action& action);
/// Run it in the place of this program.   out  never;   err  the script or Python is missing
Outcome run_script(const std::string& command, const std::vector<std::string>& arguments);
/// Run it beside this program, with a text as its standard input.   err  as run_script(); what the script refuses
Outcome feed_script(const std::string& command, std::vector<std::string> arguments, const std::string& input);

}  // namespace tactus::cli
