// SPDX-License-Identifier: Apache-2.0
/// The users of a server: a key and a role each. spec/70-session.md sections 11.2 and 11.5.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/seal/key.h>

namespace tactus::seal {

/// What a user may do.
enum class Role : std::uint8_t {
  observe,  ///< look on
  touch,    ///< play a seat, too
};

class KeyList {
 public:
  static constexpr std::size_t kMostUsers = 1024;
  static constexpr std::string_view kHead = "tactus keys 1\n";
  struct User {
    std::shared_ptr<const Key> key;  ///< never null
    Role role = Role::touch;
    std::string_view name() const noexcept { return key->name(); }
  };

  KeyList() = default;  ///< nobody
  KeyList(Key key);     ///< one user, who may touch. Not explicit: it is a list

  /// The text of a key list, or of a key file.   in  file  for the message
  /// err  malformed R-KEY-3, R-KEY-5;  invalid R-KEY-6: a name stands there twice;  limit_exceeded R-KEY-6; all with the line
  static tl::expected<KeyList, Diagnostic> parse(std::string_view text, const std::string& file);
  /// err  io R-KEY-1, with errno;  invalid R-KEY-2: others can read it;  as parse()
  static tl::expected<KeyList, Diagnostic> read(const std::string& path);
  /// Make the file, or put another one in its place; only its owner can read it.   err  io R-KEY-1, with errno
  Result<void> write(const std::string& path) const;

  /// err  invalid R-KEY-6: there is such a name;  limit_exceeded R-KEY-6
  Result<void> add(Key key, Role role);
  bool remove(std::string_view name);  ///< out  false: there is none
  /// Null: there is none.
  const User* find(std::string_view name) const noexcept;
  /// The user has this very key.
  bool holds(const Key& key) const noexcept;
  std::span<const User> users() const noexcept { return users_; }

 private:
  tl::expected<void, Errc> append(User user);
  std::vector<User> users_;                                  // in the order of the file
  std::unordered_map<std::string_view, std::size_t> index_;  // of a name, which is in the key and stays where it is
};

/// What a file was: another one, or the same one after it was changed, has another of these.
struct FileStamp {
  std::uint64_t device = 0, inode = 0, size = 0;
  std::int64_t content_changed = 0, changed = 0;  // [ns] since 1970
  bool operator==(const FileStamp& other) const = default;
};

/// The key list of a server that may change while it runs.
class KeyListFile {
 public:
  /// err  as KeyList::read()
  static tl::expected<KeyListFile, Diagnostic> open(const std::string& path);
  const KeyList& keys() const noexcept { return keys_; }
  /// Read the file again if it is another one, or was changed. One that was changed just now is left for the next time, as whoever writes
  /// it in its place may not be done.   out  keys() are others now
  /// err  as KeyList::read(), once for each change; keys() stay   time  a system call; 0.5 ms for 1024 users
  tl::expected<bool, Diagnostic> look();
  tl::expected<bool, Diagnostic> read_again();  ///< the same, without leaving anything for the next time

 private:
  KeyListFile(std::string path, FileStamp stamp, KeyList keys) : path_(std::move(path)), stamp_(stamp), keys_(std::move(keys)) {}
  std::string path_;
  FileStamp stamp_;
  KeyList keys_;
};

/// "observe", "touch".
const char* name_of(Role role) noexcept;

}  // namespace tactus::seal
