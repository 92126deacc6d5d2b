// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/program.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <thread>

namespace tactus::sim {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostWords = 1 << 16;

/// Input, output and working folder of the child.
class SpawnActions {
 public:
  SpawnActions(const fs::path& folder, const fs::path& output) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
    posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
  }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;
  const posix_spawn_file_actions_t* get() const noexcept { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

/// Status of the child; nothing if the deadline passes first.
std::optional<int> wait_until(pid_t child, Clock::time_point deadline) {
  using namespace std::chrono_literals;
  auto pause = 1ms;
  int status = 0;
  while (true) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    if (ended < 0 && errno != EINTR) return 128;  // somebody else took its status
    if (Clock::now() >= deadline) return std::nullopt;
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, 20ms);
  }
}

}  // namespace

PrivateFolder::PrivateFolder() {
  std::error_code ignored;
  std::string name = fs::temp_directory_path(ignored) / "tactus-XXXXXX";
  if (mkdtemp(name.data()) != nullptr) path_ = name;
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

tl::expected<ProgramResult, ProgramFailure> run_program(const std::vector<std::string>& arguments, const fs::path& folder,
                                                        Clock::time_point deadline) {
  std::vector<std::string> kept = arguments;
  std::vector<char*> pointers;
  pointers.reserve(kept.size() + 1);
  for (std::string& argument : kept) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const fs::path output = folder / "output.txt";
  const SpawnActions actions(folder, output);
  pid_t child = 0;
  const int error = posix_spawnp(&child, pointers[0], actions.get(), nullptr, pointers.data(), environ);
  if (error == ENOENT || error == EACCES) return tl::unexpected(ProgramFailure::not_there);
  if (error != 0) return tl::unexpected(ProgramFailure::not_started);
  const auto status = wait_until(child, deadline);
  if (!status) {
    kill(child, SIGKILL);
    while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) continue;
    return tl::unexpected(ProgramFailure::too_long);
  }
  ProgramResult result{*status, std::string(kMostWords, '\0')};
  std::ifstream in(output, std::ios::binary);
  in.read(result.words.data(), static_cast<std::streamsize>(kMostWords));
  result.words.resize(static_cast<std::size_t>(in.gcount()));
  return result;
}

}  // namespace tactus::sim
