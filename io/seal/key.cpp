// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/key.h>

#include <gnutls/crypto.h>
#include <gnutls/gnutls.h>

#include <algorithm>
#include <optional>

#include <tactus/base/rule.h>
#include <tactus/seal/key_list.h>
#include <tactus/seal/secret_file.h>

namespace tactus::seal {
namespace {

constexpr std::string_view kHead = "tactus key 1\n", kName = "name ", kSecretWord = "secret ";
constexpr std::size_t kLongestText =
    kHead.size() + kName.size() + Key::kLongestName + 1 + kSecretWord.size() + 2 * Key::kSecret + 1;

tl::unexpected<Diagnostic> refuse(const Error& error, const std::string& file, std::uint64_t line) {
  return tl::unexpected(Diagnostic{.error = error, .file = file, .line = line});
}

}  // namespace

bool Key::is_name(std::string_view text) noexcept {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  return !text.empty() && text.size() <= kLongestName && text.find_first_not_of(kLetters) == std::string_view::npos;
}

Result<Key> Key::generate(std::string_view name) {
  if (!is_name(name)) return fail(Errc::invalid_argument, "R-KEY-4");
  Key key(name);
  if (gnutls_rnd(GNUTLS_RND_KEY, key.secret_.data(), key.secret_.size()) != 0) return fail(Errc::internal, "R-SEA-6");
  return key;
}

tl::expected<Key, Diagnostic> Key::parse(std::string_view text, const std::string& file) {
  const auto wrong = [&](std::uint64_t line) { return refuse(fail(Errc::malformed, "R-KEY-3").value(), file, line); };
  const auto take = [&text](std::string_view word) {
    if (!text.starts_with(word)) return false;
    text.remove_prefix(word.size());
    return true;
  };
  if (text.starts_with(KeyList::kHead)) return refuse(fail(Errc::invalid, "R-KEY-7").value(), file, 1);
  if (!take(kHead)) return wrong(1);
  if (!take(kName)) return wrong(2);
  const std::string_view name = text.substr(0, text.find('\n'));
  if (!is_name(name) || !take(name) || !take("\n")) return wrong(2);
  if (!take(kSecretWord)) return wrong(3);
  Key key(name);
  if (!read_hex(text.substr(0, 2 * kSecret), key.secret_)) return wrong(3);
  text.remove_prefix(2 * kSecret);
  if (!take("\n")) return wrong(3);
  if (!text.empty()) return wrong(4);
  return key;
}

tl::expected<Key, Diagnostic> Key::read(const std::string& path) {
  TACTUS_TRY(const SecretText text, read_secret(path, kLongestText));
  return parse(text.view(), path);
}

Result<void> Key::write(const std::string& path) const {
  SecretText text(kLongestText);
  for (const std::string_view part : {kHead, kName, name(), std::string_view("\n"), kSecretWord}) text.add(part);
  text.add_hex(secret_);
  text.add("\n");
  return create_secret(path, text.view());
}

Key::Key(std::string_view name) noexcept : name_size_(name.size()) { std::copy(name.begin(), name.end(), name_.begin()); }

std::optional<Key> Key::from(std::string_view name, std::string_view secret) noexcept {
  if (!is_name(name)) return std::nullopt;
  Key key(name);
  if (!read_hex(secret, key.secret_)) return std::nullopt;
  return key;
}

bool operator==(const Key& a, const Key& b) noexcept {
  return a.name() == b.name() && gnutls_memcmp(a.secret_.data(), b.secret_.data(), a.secret_.size()) == 0;
}

Key::Key(Key&& other) noexcept : name_(other.name_), name_size_(other.name_size_), secret_(other.secret_) { other.wipe(); }

Key& Key::operator=(Key&& other) noexcept {
  if (this == &other) return *this;
  name_ = other.name_;
  name_size_ = other.name_size_;
  secret_ = other.secret_;
  other.wipe();
  return *this;
}

Key::~Key() { wipe(); }

void Key::wipe() noexcept {
  gnutls_memset(name_.data(), 0, name_.size());
  name_size_ = 0;
  gnutls_memset(secret_.data(), 0, secret_.size());
}

}  // namespace tactus::seal
