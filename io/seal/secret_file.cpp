// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/secret_file.h>

#include <fcntl.h>
#include <gnutls/crypto.h>
#include <gnutls/gnutls.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus::seal {
namespace {

constexpr std::string_view kDigits = "0123456789abcdef";

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

bool write_all(int handle, std::string_view text) {
  while (!text.empty()) {
    const ssize_t put = ::write(handle, text.data(), text.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

/// Remove a file, and say why it was not what it was to be.
tl::unexpected<Error> give_up(const std::string& path) {
  const int cause = errno;
  ::unlink(path.c_str());
  errno = cause;
  return fail(Errc::io, "R-KEY-1");
}

}  // namespace

SecretText::~SecretText() {
  if (bytes_) gnutls_memset(bytes_.get(), 0, most_);
}

void SecretText::add(std::string_view more) noexcept {
  const std::size_t taken = std::min(more.size(), most_ - size_);
  std::copy_n(more.begin(), taken, bytes_.get() + size_);
  size_ += taken;
}

void SecretText::add_hex(std::span<const std::uint8_t> secret) noexcept {
  for (const std::uint8_t byte : secret) {
    add(kDigits.substr(byte / 16u, 1));
    add(kDigits.substr(byte % 16u, 1));
  }
}

bool read_hex(std::string_view text, std::span<std::uint8_t> secret) noexcept {
  if (text.size() != 2 * secret.size()) return false;
  const auto value = [](char digit) {
    if (digit >= '0' && digit <= '9') return digit - '0';
    return digit >= 'a' && digit <= 'f' ? digit - 'a' + 10 : -1;
  };
  for (std::size_t i = 0; i < secret.size(); ++i) {
    const int high = value(text[2 * i]), low = value(text[2 * i + 1]);
    if (high < 0 || low < 0) return false;
    secret[i] = static_cast<std::uint8_t>(16 * high + low);
  }
  return true;
}

FileStamp stamp_of(const std::string& path) noexcept {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return {};
  const auto ns = [](const timespec& time) { return std::int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec; };
  return {found.st_dev, found.st_ino, static_cast<std::uint64_t>(found.st_size), ns(found.st_mtim), ns(found.st_ctim)};
}

tl::expected<SecretText, Diagnostic> read_secret(const std::string& path, std::size_t most) {
  const auto unreadable = [&path] { return tl::unexpected(Diagnostic{fail(Errc::io, "R-KEY-1").value(), path}); };
  const File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // not blocking: it may be a pipe
  if (file.handle() < 0) return unreadable();
  struct stat status {};
  if (::fstat(file.handle(), &status) != 0) return unreadable();
  if (!S_ISREG(status.st_mode) || (status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return tl::unexpected(Diagnostic{fail(Errc::invalid, "R-KEY-2").value(), path});
  SecretText text(most + 1);
  while (text.size_ < text.most_) {
    const ssize_t got = ::read(file.handle(), text.bytes_.get() + text.size_, text.most_ - text.size_);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return unreadable();
    if (got == 0) break;
    text.size_ += static_cast<std::size_t>(got);
  }
  return text;
}

Result<void> create_secret(const std::string& path, std::string_view text) {
  File file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (file.handle() < 0) return fail(Errc::io, "R-KEY-1");
  if (write_all(file.handle(), text) && ::fsync(file.handle()) == 0 && file.close()) return {};
  return give_up(path);
}

Result<void> replace_secret(const std::string& path, std::string_view text) {
  std::string beside = path + ".XXXXXX";
  File file(::mkostemp(beside.data(), O_CLOEXEC));  // mode 0600
  if (file.handle() < 0) return fail(Errc::io, "R-KEY-1");
  struct stat old {};
  const bool is_owned = ::stat(path.c_str(), &old) != 0 || ::fchown(file.handle(), old.st_uid, old.st_gid) == 0;
  const bool is_written = is_owned && write_all(file.handle(), text) && ::fsync(file.handle()) == 0 && file.close();
  if (is_written && ::rename(beside.c_str(), path.c_str()) == 0) return {};
  return give_up(beside);
}

}  // namespace tactus::seal
