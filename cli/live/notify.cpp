// SPDX-License-Identifier: Apache-2.0
#include "cli/live/notify.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>

namespace tactus::cli {
namespace {

std::string_view variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string_view() : value;
}

/// A datagram socket that is connected to this address, a path or, after @, an abstract name; below 0: it is not there.
int connect_to(std::string_view name) {
  sockaddr_un address{};
  if (name.size() < 2 || name.size() >= sizeof address.sun_path || (name[0] != '/' && name[0] != '@')) return -1;
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, name.data(), name.size());
  if (name[0] == '@') address.sun_path[0] = '\0';
  const int handle = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
  if (handle < 0 || ::connect(handle, reinterpret_cast<const sockaddr*>(&address), size) == 0) return handle;
  ::close(handle);
  return -1;
}

}  // namespace

ServiceManager::ServiceManager() : socket_(connect_to(variable("NOTIFY_SOCKET"))) {
  const std::string_view text = variable("WATCHDOG_USEC"), meant = variable("WATCHDOG_PID");
  const bool is_meant = meant.empty() || meant == std::to_string(::getpid());
  if (socket_ >= 0 && is_meant) std::from_chars(text.data(), text.data() + text.size(), watchdog_);
}

ServiceManager::~ServiceManager() {
  if (socket_ >= 0) ::close(socket_);
}

void ServiceManager::send(std::string_view text) const noexcept {
  if (socket_ >= 0) ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);  // what cannot be sent is left out
}

void ServiceManager::ready(std::string_view status) const { send("READY=1\nSTATUS=" + std::string(status)); }

void ServiceManager::stopping() const noexcept { send("STOPPING=1"); }

void ServiceManager::send_alive(std::uint64_t now) noexcept {
  next_ = now + watchdog_ / 2;
  send("WATCHDOG=1");
}

}  // namespace tactus::cli
