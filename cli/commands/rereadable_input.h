// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "cli/output.h"
#include "cli/report/messages.h"

namespace tactus::cli {

/// An input that is read more than once. What can be read only once (a pipe, "-") is copied to a temporary file without a name.
class RereadableInput {
 public:
  /// in   most  [bytes] of what is copied
  /// err  it cannot be read, or the copy not written; there is more to copy than `most`
  static tl::expected<RereadableInput, Failure> open(const std::string& path, std::uint64_t most = kMostRead);
  const std::string& path() const noexcept { return path_; }  ///< to read from while this lives

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, CloseFile> copy_;
};

}  // namespace tactus::cli
