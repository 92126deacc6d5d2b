// SPDX-License-Identifier: Apache-2.0
#include "cli/live/token_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace tactus::cli {
namespace {

namespace fs = std::filesystem;

/// Empty: nowhere.
fs::path folder() {
  const auto variable = [](const char* name) {
    const char* const value = std::getenv(name);
    return fs::path(value != nullptr && value[0] == '/' ? value : "");
  };
  for (const char* const name : {"XDG_RUNTIME_DIR", "XDG_STATE_HOME"})
    if (const fs::path base = variable(name); !base.empty()) return base / "tactus";
  const fs::path home = variable("HOME");
  return home.empty() ? home : home / ".local/state/tactus";
}

std::string file_name(const std::string& server, const std::string& user) {
  std::string out = "session-";
  for (const char c : fmt::format("{}{}{}", server, user.empty() ? "" : "-", user)) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-';
    out += plain ? std::string(1, c) : fmt::format("_{:02x}", static_cast<unsigned char>(c));
  }
  return out;
}

std::uint64_t read_token(int handle) {
  std::array<char, 16> text{};
  std::uint64_t token = 0;
  if (::pread(handle, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) return 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), token, 16);
  return read.ec == std::errc() && read.ptr == text.data() + text.size() ? token : 0;
}

/// A file of this user's that no other program holds; below 0: there is none.
int open_own(const std::string& path, int how) {
  const int handle = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | how, S_IRUSR | S_IWUSR);
  if (handle < 0) return handle;
  struct stat found {};
  const bool ours = ::fstat(handle, &found) == 0 && S_ISREG(found.st_mode) && found.st_uid == ::geteuid() &&
                    (found.st_mode & (S_IRWXG | S_IRWXO)) == 0;
  if (ours && ::flock(handle, LOCK_EX | LOCK_NB) == 0) return handle;
  ::close(handle);
  return -1;
}

}  // namespace

TokenFile::TokenFile(const std::string& server, const std::string& user) {
  const fs::path in = folder();
  const std::string name = file_name(server, user);
  if (in.empty() || name.size() > 200) return;
  path_ = (in / name).string();
  handle_ = open_own(path_, 0);
  if (handle_ >= 0) token_ = read_token(handle_);
}

TokenFile::~TokenFile() {
  if (handle_ >= 0) ::close(handle_);
}

void TokenFile::keep(std::uint64_t token) {
  if (token == token_ || path_.empty()) return;
  if (handle_ < 0) {
    std::error_code ignored;
    fs::create_directories(fs::path(path_).parent_path(), ignored);
    handle_ = open_own(path_, O_CREAT);
  }
  if (handle_ < 0) return;
  token_ = token;
  const std::string text = token == 0 ? "" : fmt::format("{:016x}", token);
  if (::ftruncate(handle_, 0) != 0 || ::pwrite(handle_, text.data(), text.size(), 0) < 0) token_ = 0;
  if (token == 0) ::unlink(path_.c_str());
}

}  // namespace tactus::cli
