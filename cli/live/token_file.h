// SPDX-License-Identifier: Apache-2.0
/// The token of a session that this user's programs remember, so that one that crashed comes back to its seat.
#pragma once

#include <cstdint>
#include <string>

namespace tactus::cli {

/// One for each server and user of a scene, in $XDG_RUNTIME_DIR or $XDG_STATE_HOME or ~/.local/state, readable by its owner only. While one
/// program holds it, others of the same name have none. Whoever cannot keep one does without.
class TokenFile {
 public:
  /// in   server  HOST:PORT;  user  of the scene, or nothing
  TokenFile(const std::string& server, const std::string& user);
  ~TokenFile();
  TokenFile(const TokenFile&) = delete;
  TokenFile& operator=(const TokenFile&) = delete;

  std::uint64_t token() const noexcept { return token_; }  ///< 0: none
  void keep(std::uint64_t token);                          ///< 0: the session has ended, and nothing is to be kept

 private:
  std::string path_;
  int handle_ = -1;
  std::uint64_t token_ = 0;
};

}  // namespace tactus::cli
