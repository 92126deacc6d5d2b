// SPDX-License-Identifier: Apache-2.0
/// Commands that are scripts of lab/: the program hands them over, as git does with git-NAME. A row of kScripts is all that it takes.
/// What other commands need of a script they have it do.
#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <tactus/base/shown.h>
#include "cli/commands/commands.h"
#include "cli/output.h"

namespace tactus::cli {
namespace {

namespace fs = std::filesystem;

struct Script {
  std::string_view command;
  const char* help;
};
constexpr std::array kScripts{
    Script{"plot", "Draw recordings over time, one or several in a figure"},
    Script{"sweep", "Run a command over a grid of parameters into a table and figures"},
    Script{"reproduce", "Run an experiment of the thesis and compare the figures"},
    Script{"bench", "Measure the simulation, sessions and signals"},
};

constexpr std::size_t kMostShown = 300;  // of a script's own words, in a message

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

/// What starts a script.   err  it is missing
tl::expected<std::vector<std::string>, Failure> words_of(const std::string& command, const std::vector<std::string>& arguments) {
  const fs::path program = own_program(), script = lab_folder(program) / (command + ".py");
  std::error_code failed;
  if (!fs::exists(script, failed))
    return refuse(fmt::format("tactus {}: its script is missing: {}", command, shown_path(script.string())),
                  "Install the scripts with the program, or name their folder in the variable TACTUS_LAB of the environment.");
  setenv("TACTUS", program.c_str(), 1);
  if (const fs::path study = program.parent_path() / "tactus-study"; fs::exists(study, failed))
    setenv("TACTUS_STUDY", study.c_str(), 1);
  std::vector<std::string> words{"python3", "-B", script.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> out;
  out.reserve(words.size() + 1);
  for (std::string& word : words) out.push_back(word.data());
  out.push_back(nullptr);
  return out;
}

tl::unexpected<Failure> refuse_start(const std::string& command, int why) {
  if (why == ENOENT)
    return refuse(fmt::format("tactus {} needs Python 3.11 or later, and python3 is not on PATH", command),
                  "Install it, for figures with matplotlib: apt-get install python3 python3-numpy python3-matplotlib");
  return refuse("python3 cannot be started: " + std::generic_category().message(why), remedy_of(why));
}

/// A file without a name, in memory, and its name among those of this process.
struct MemoryFile {
  Descriptor file{memfd_create("tactus", MFD_CLOEXEC)};
  std::string path = fmt::format("/proc/self/fd/{}", file.number());
};

/// Run to its end with these as standard input and standard error, in silence else.   out  as of waitpid();   err  errno
tl::expected<int, int> spawn(std::vector<std::string> words, const MemoryFile& in, const MemoryFile& errors) {
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  posix_spawn_file_actions_adddup2(&streams, in.file.number(), STDIN_FILENO);
  posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&streams, errors.file.number(), STDERR_FILENO);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, words[0].c_str(), &streams, nullptr, pointers_to(words).data(), environ);
  posix_spawn_file_actions_destroy(&streams);
  if (failed != 0) return tl::unexpected(failed);
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return tl::unexpected(errno);
  return status;
}

/// What a script wrote on standard error before it ended otherwise than well, its error as JSON.
tl::unexpected<Failure> refusal_of(const std::string& command, const std::string& errors) {
  const auto document = nlohmann::json::parse(errors.substr(std::min(errors.find('{'), errors.size())), nullptr, false);
  const nlohmann::json* const error = document.is_object() && document.contains("error") ? &document["error"] : nullptr;
  if (error == nullptr || !error->is_object())
    return refuse(
        fmt::format("tactus {} failed: {}", command, shown(errors.substr(errors.size() - std::min(errors.size(), kMostShown)))),
        "Check the installation of Python, NumPy and matplotlib.");
  return refuse(error->value("text", ""), error->value("remedy", ""));
}

}  // namespace

bool is_script(std::string_view command) { return std::ranges::find(kScripts, command, &Script::command) != std::end(kScripts); }

Outcome run_script(const std::string& command, const std::vector<std::string>& arguments) {
  TACTUS_TRY(auto words, words_of(command, arguments));
  execvp("python3", pointers_to(words).data());
  return refuse_start(command, errno);
}

Outcome feed_script(const std::string& command, std::vector<std::string> arguments, const std::string& input) {
  arguments.insert(arguments.end(), {"--json", "--quiet"});
  TACTUS_TRY(auto words, words_of(command, arguments));
  const MemoryFile in, errors;
  if (!in.file.is_open() || !errors.file.is_open()) return refuse_start(command, errno);
  if (!(std::ofstream(in.path, std::ios::binary) << input).flush()) return refuse_start(command, ENOSPC);
  const auto status = spawn(std::move(words), in, errors);
  if (!status) return refuse_start(command, status.error());
  if (WIFEXITED(*status) && WEXITSTATUS(*status) == 0) return {};
  TACTUS_TRY(const std::string text, read_file(errors.path));
  return refusal_of(command, text);
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
