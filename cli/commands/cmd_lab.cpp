// SPDX-License-Identifier: Apache-2.0
/// Commands that are scripts of lab/: the program hands them over, as git does with git-NAME. A row of kScripts is all that it takes.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include <tactus/base/shown.h>
#include "cli/commands/commands.h"

namespace tactus::cli {
namespace {

namespace fs = std::filesystem;

struct Script {
  std::string_view command;
  const char* help;
};
constexpr std::array kScripts{
    Script{"sweep", "Run a command over a grid of parameters into a table and figures"},
    Script{"reproduce", "Run an experiment of the thesis and compare the figures"},
    Script{"bench", "Measure the simulation, sessions and signals"},
};

fs::path own_program() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored);
}

/// TACTUS_LAB, or lab/ beside the program in a build tree, or share/tactus/lab of an installation.
fs::path lab_folder(const fs::path& program) {
  if (const char* const named = std::getenv("TACTUS_LAB"); named != nullptr && *named != '\0') return named;
  std::error_code ignored;
  const fs::path beside = program.parent_path() / "lab";
  return fs::is_directory(beside, ignored) ? beside : program.parent_path().parent_path() / "share/tactus/lab";
}

}  // namespace

bool is_script(std::string_view command) { return std::ranges::find(kScripts, command, &Script::command) != std::end(kScripts); }

Outcome run_script(const std::string& command, const std::vector<std::string>& arguments) {
  const fs::path program = own_program(), folder = lab_folder(program), script = folder / (command + ".py");
  std::error_code failed;
  if (!fs::exists(script, failed))
    return refuse(fmt::format("tactus {}: its script is missing: {}", command, shown_path(script.string())),
                  "Install the scripts with the program, or name their folder in the variable TACTUS_LAB of the environment.");
  setenv("TACTUS", program.c_str(), 1);
  if (const fs::path study = program.parent_path() / "tactus-study"; fs::exists(study, failed))
    setenv("TACTUS_STUDY", study.c_str(), 1);
  std::vector<std::string> words{"python3", "-B", script.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execvp(pointers[0], pointers.data());
  const int why = errno;
  if (why == ENOENT)
    return refuse(fmt::format("tactus {} needs Python 3.11 or later, and python3 is not on PATH", command),
                  "Install it, for figures with matplotlib: apt-get install python3 python3-numpy python3-matplotlib");
  return refuse("python3 cannot be started: " + std::generic_category().message(why), remedy_of(why));
}

void setup_script(Command& app, std::string_view name, Action& action) {
  const std::string command(name);
  Command& added = app.add_command(command, std::ranges::find(kScripts, name, &Script::command)->help);
  added.footer(
      fmt::format("`tactus {} --help` lists its options. It is a Python script: it needs python3, and for figures the\n"
                  "Debian packages python3-numpy and python3-matplotlib.",
                  command));
  added.on_chosen([&action, command] { action = [command] { return run_script(command, {}); }; });
}

}  // namespace tactus::cli
