// SPDX-License-Identifier: Apache-2.0
/// Another program, run with an argument vector and never through a shell, and a folder for the files exchanged with it.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace tactus::sim {

/// A folder that nobody else can read, removed with all that is in it; an empty path when it cannot be made.
class PrivateFolder {
 public:
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

struct ProgramResult {
  int status = 0;     ///< exit status; 128 + n: ended by signal n
  std::string words;  ///< the first 64 KiB that it printed, to either stream
};

enum class ProgramFailure { not_there, not_started, too_long };

/// Run arguments[0], looked up in PATH unless it holds a '/', in `folder` without standard input, until it ends or the deadline kills it.
tl::expected<ProgramResult, ProgramFailure> run_program(const std::vector<std::string>& arguments,
                                                        const std::filesystem::path& folder,
                                                        std::chrono::steady_clock::time_point deadline);

}  // namespace tactus::sim
