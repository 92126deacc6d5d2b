// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace tactus {

/// The path of a file that no other test uses, which may run at the same time; it is removed afterwards.
class TempFile {
 public:
  explicit TempFile(std::string_view ending = ".mcap") {
    static int count = 0;
    path_ = ::testing::TempDir() + "tactus_" + std::to_string(getpid()) + "_" + std::to_string(count++) + std::string(ending);
  }
  ~TempFile() { std::filesystem::remove(path_); }
  TempFile(const TempFile&) = delete;
  TempFile& operator=(const TempFile&) = delete;
  const std::string& path() const { return path_; }
  std::vector<std::uint8_t> bytes() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

 private:
  std::string path_;
};

}  // namespace tactus
