// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/key_list.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/seal/secret_file.h>

namespace tactus::seal {
namespace {

constexpr std::size_t kNone = std::string_view::npos;
constexpr std::array<std::string_view, 2> kRoles{"observe", "touch"};  // index: Role
constexpr std::size_t kLongestRole = 7, kLongestLine = Key::kLongestName + 1 + kLongestRole + 1 + 2 * Key::kSecret + 1;
constexpr std::size_t kLongestText = KeyList::kHead.size() + (KeyList::kMostUsers + 1) * kLongestLine;  // one that is too much

/// A line up to its end.   out  nothing: it is not one of a list
std::optional<KeyList::User> read_user(std::string_view line) {
  const std::size_t name_end = line.find(' '), role_end = name_end == kNone ? kNone : line.find(' ', name_end + 1);
  if (role_end == kNone) return std::nullopt;
  const auto role = std::ranges::find(kRoles, line.substr(name_end + 1, role_end - name_end - 1));
  auto key = Key::from(line.substr(0, name_end), line.substr(role_end + 1));
  if (role == kRoles.end() || !key) return std::nullopt;
  return KeyList::User{std::make_shared<const Key>(std::move(*key)), static_cast<Role>(role - kRoles.begin())};
}

}  // namespace

const char* name_of(Role role) noexcept { return kRoles[static_cast<std::size_t>(role)].data(); }

KeyList::KeyList(Key key) { append({std::make_shared<const Key>(std::move(key)), Role::touch}); }

/// Whether there is room, and no such name.
tl::expected<void, Errc> KeyList::append(User user) {
  if (users_.size() == kMostUsers) return tl::unexpected(Errc::limit_exceeded);
  if (!index_.emplace(user.name(), users_.size()).second) return tl::unexpected(Errc::invalid);
  users_.push_back(std::move(user));
  return {};
}

tl::expected<KeyList, Diagnostic> KeyList::parse(std::string_view text, const std::string& file) {
  if (!text.starts_with(kHead)) {
    TACTUS_TRY(auto key, Key::parse(text, file));
    return KeyList(std::move(key));
  }
  KeyList out;
  text.remove_prefix(kHead.size());
  for (std::uint64_t line = 2; !text.empty(); ++line) {
    const auto wrong = [&](const tl::unexpected<Error>& error, std::string cause = {}, std::string remedy = {}) {
      return tl::unexpected(
          Diagnostic{.error = error.value(), .file = file, .line = line, .cause = std::move(cause), .remedy = std::move(remedy)});
    };
    const std::size_t end = text.find('\n');
    auto user = end == kNone ? std::nullopt : read_user(text.substr(0, end));
    if (!user) return wrong(fail(Errc::malformed, "R-KEY-5"));
    const std::string name(user->name());
    const auto added = out.append(std::move(*user));
    if (!added && added.error() == Errc::invalid)
      return wrong(fail(Errc::invalid, "R-KEY-6"), "the list has the user " + name + " twice", "Remove one of the two lines.");
    if (!added) return wrong(fail(Errc::limit_exceeded, "R-KEY-6"), "the list has more than 1024 users", "Remove some.");
    text.remove_prefix(end + 1);
  }
  return out;
}

tl::expected<KeyList, Diagnostic> KeyList::read(const std::string& path) {
  TACTUS_TRY(const SecretText text, read_secret(path, kLongestText));
  return parse(text.view(), path);
}

Result<void> KeyList::write(const std::string& path) const {
  SecretText text(kLongestText);
  text.add(kHead);
  for (const User& user : users_) {
    for (const std::string_view part :
         {user.name(), std::string_view(" "), std::string_view(seal::name_of(user.role)), std::string_view(" ")})
      text.add(part);
    text.add_hex(user.key->secret());
    text.add("\n");
  }
  return replace_secret(path, text.view());
}

Result<void> KeyList::add(Key key, Role role) {
  if (const auto added = append({std::make_shared<const Key>(std::move(key)), role}); !added)
    return fail(added.error(), "R-KEY-6");
  return {};
}

bool KeyList::remove(std::string_view name) {
  if (find(name) == nullptr) return false;
  std::vector<User> users = std::exchange(users_, {});
  index_.clear();
  for (User& user : users)
    if (user.name() != name) static_cast<void>(append(std::move(user)));
  return true;
}

const KeyList::User* KeyList::find(std::string_view name) const noexcept {
  const auto found = index_.find(name);
  return found == index_.end() ? nullptr : &users_[found->second];
}

bool KeyList::holds(const Key& key) const noexcept {
  const User* const user = find(key.name());
  return user != nullptr && *user->key == key;
}

tl::expected<KeyListFile, Diagnostic> KeyListFile::open(const std::string& path) {
  const FileStamp stamp = stamp_of(path);
  TACTUS_TRY(auto keys, KeyList::read(path));
  return KeyListFile(path, stamp, std::move(keys));
}

tl::expected<bool, Diagnostic> KeyListFile::look() {
  using namespace std::chrono;
  constexpr nanoseconds kQuiet = milliseconds(100);
  const nanoseconds age = system_clock::now().time_since_epoch() - nanoseconds(stamp_of(path_).content_changed);
  if (age >= nanoseconds(0) && age < kQuiet) return false;
  return read_again();
}

tl::expected<bool, Diagnostic> KeyListFile::read_again() {
  const FileStamp stamp = stamp_of(path_);
  if (stamp == stamp_) return false;
  stamp_ = stamp;
  TACTUS_TRY(keys_, KeyList::read(path_));
  return true;
}

}  // namespace tactus::seal
