// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/key.h>

#include <fcntl.h>
#include <gnutls/crypto.h>
#include <gnutls/gnutls.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>

#include <tactus/base/rule.h>

namespace tactus::seal {
namespace {

constexpr std::string_view kHead = "tactus key 1\n", kName = "name ", kSecretWord = "secret ";
constexpr std::string_view kDigits = "0123456789abcdef";
constexpr std::size_t kLongestText =
    kHead.size() + kName.size() + Key::kLongestName + 1 + kSecretWord.size() + 2 * Key::kSecret + 1;

bool is_name(std::string_view text) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  return !text.empty() && text.size() <= Key::kLongestName && text.find_first_not_of(kLetters) == std::string_view::npos;
}

/// Text that holds the secret: of fixed size and wiped, so that no copy stays in freed memory.
struct Text {
  Text() = default;
  Text(const Text&) = delete;
  Text& operator=(const Text&) = delete;
  ~Text() { gnutls_memset(bytes.data(), 0, bytes.size()); }
  void add(std::string_view more) noexcept {
    std::copy(more.begin(), more.end(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    size += more.size();
  }
  std::string_view view() const noexcept { return {bytes.data(), size}; }

  std::array<char, kLongestText + 1> bytes{};  // one more than a key file may have
  std::size_t size = 0;
};

/// An open file; closing keeps errno.
class File {
 public:
  explicit File(int handle) noexcept : handle_(handle) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    const int cause = errno;
    if (handle_ >= 0) ::close(handle_);
    errno = cause;
  }
  int handle() const noexcept { return handle_; }
  bool close() noexcept { return ::close(std::exchange(handle_, -1)) == 0; }

 private:
  int handle_;
};

bool read_all(int handle, Text& text) {
  while (text.size < text.bytes.size()) {
    const ssize_t got = ::read(handle, text.bytes.data() + text.size, text.bytes.size() - text.size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return false;
    if (got == 0) break;
    text.size += static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(int handle, std::string_view text) {
  while (!text.empty()) {
    const ssize_t put = ::write(handle, text.data(), text.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

tl::unexpected<Diagnostic> refuse(const Error& error, const std::string& file, std::uint64_t line) {
  return tl::unexpected(Diagnostic{.error = error, .file = file, .line = line});
}

}  // namespace

Result<Key> Key::generate(std::string_view name) {
  if (!is_name(name)) return fail(Errc::invalid_argument, "R-KEY-4");
  Key key;
  std::copy(name.begin(), name.end(), key.name_.begin());
  key.name_size_ = name.size();
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
  if (!take(kHead)) return wrong(1);
  if (!take(kName)) return wrong(2);
  const std::string_view name = text.substr(0, text.find('\n'));
  if (!is_name(name) || !take(name) || !take("\n")) return wrong(2);
  if (!take(kSecretWord) || text.size() < 2 * kSecret) return wrong(3);
  Key key;
  std::copy(name.begin(), name.end(), key.name_.begin());
  key.name_size_ = name.size();
  for (std::size_t i = 0; i < kSecret; ++i) {
    const std::size_t high = kDigits.find(text[2 * i]), low = kDigits.find(text[2 * i + 1]);
    if (high == std::string_view::npos || low == std::string_view::npos) return wrong(3);
    key.secret_[i] = static_cast<std::uint8_t>(16 * high + low);
  }
  text.remove_prefix(2 * kSecret);
  if (!take("\n")) return wrong(3);
  if (!text.empty()) return wrong(4);
  return key;
}

tl::expected<Key, Diagnostic> Key::read(const std::string& path) {
  const auto unreadable = [&path] { return refuse(fail(Errc::io, "R-KEY-1").value(), path, 0); };
  const File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // not blocking: it may be a pipe
  if (file.handle() < 0) return unreadable();
  struct stat status {};
  if (::fstat(file.handle(), &status) != 0) return unreadable();
  if (!S_ISREG(status.st_mode) || (status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return refuse(fail(Errc::invalid, "R-KEY-2").value(), path, 0);
  Text text;
  if (!read_all(file.handle(), text)) return unreadable();
  return parse(text.view(), path);
}

Result<void> Key::write(const std::string& path) const {
  Text text;
  text.add(kHead);
  text.add(kName);
  text.add(name());
  text.add("\n");
  text.add(kSecretWord);
  for (const std::uint8_t byte : secret_) {
    text.add(kDigits.substr(byte / 16u, 1));
    text.add(kDigits.substr(byte % 16u, 1));
  }
  text.add("\n");
  File file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (file.handle() < 0) return fail(Errc::io, "R-KEY-1");
  if (write_all(file.handle(), text.view()) && ::fsync(file.handle()) == 0 && file.close()) return {};
  const int cause = errno;
  ::unlink(path.c_str());
  errno = cause;
  return fail(Errc::io, "R-KEY-1");
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
