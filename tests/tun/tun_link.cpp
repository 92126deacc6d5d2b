// SPDX-License-Identifier: Apache-2.0
// tun_link UP DOWN SERVER CLIENT: run two shell commands in network namespaces of their own, and carry the UDP datagrams between them over
// the emulated links UP (to the server) and DOWN. Prints what became of them, as JSON, when both commands have ended.
//
// Each namespace has a TUN device and no loopback device. The server's is 127.0.0.1 and the client's 127.0.0.2, with route_localnet: to the
// programs these are addresses of the loopback, which they do not leave while they have no key. In truth all datagrams come through here.
// Exits with 77 and the reason where the system makes no namespace or TUN device, with 1 when a command fails.
#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>

#include <tactus/sim/link/link.h>
#include "cli/options/options_link.h"

namespace {

using tactus::sim::Link;
using tactus::sim::Microseconds;
using Bytes = std::span<const std::uint8_t>;

[[noreturn]] void skip(const char* what) {
  std::fprintf(stderr, "skipped: %s: %s\n", what, std::strerror(errno));
  std::exit(77);
}

/// A TUN device in a network namespace of its own.
class End {
 public:
  End(const char* own, const char* other) {
    if (unshare(CLONE_NEWNET) != 0) skip("no network namespace can be made here (root can)");
    namespace_ = open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC);
    device_ = open("/dev/net/tun", O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (device_ < 0) skip("/dev/net/tun");
    ifreq request = named();
    request.ifr_flags = IFF_TUN | IFF_NO_PI;
    if (ioctl(device_, TUNSETIFF, &request) != 0) skip("no TUN device can be made here");
    write_setting("route_localnet", "1");
    write_setting("rp_filter", "0");
    const int any = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    request = named();
    request.ifr_qlen = 10'000;  // nothing is lost but on the link
    bool done = ioctl(any, SIOCSIFTXQLEN, &request) == 0;
    done = done && ioctl(any, SIOCSIFADDR, addressed(request, own)) == 0;
    done = done && ioctl(any, SIOCSIFDSTADDR, addressed(request, other)) == 0;
    request = named();
    request.ifr_flags = IFF_UP | IFF_RUNNING | IFF_POINTOPOINT | IFF_NOARP;
    if (!done || ioctl(any, SIOCSIFFLAGS, &request) != 0) skip("the TUN device takes no address");
    close(any);
  }
  int device() const { return device_; }

  /// Run a shell command in this namespace.
  void start(const char* command) {
    child_ = fork();
    if (child_ == 0) {
      if (setns(namespace_, CLONE_NEWNET) == 0) execl("/bin/sh", "sh", "-c", command, nullptr);
      _exit(127);
    }
  }
  bool is_running() {
    if (child_ > 0 && waitpid(child_, &status_, WNOHANG) == child_) child_ = 0;
    return child_ > 0;
  }
  bool has_failed() const { return !WIFEXITED(status_) || WEXITSTATUS(status_) != 0; }

 private:
  static ifreq named() {
    ifreq request{};
    std::strcpy(request.ifr_name, "tun0");
    return request;
  }
  static ifreq* addressed(ifreq& request, const char* address) {
    request = named();
    sockaddr_in to{};
    to.sin_family = AF_INET;
    inet_pton(AF_INET, address, &to.sin_addr);
    std::memcpy(&request.ifr_addr, &to, sizeof to);
    return &request;
  }
  static void write_setting(const std::string& name, const char* value) {
    const int file = open(("/proc/sys/net/ipv4/conf/tun0/" + name).c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0 || write(file, value, 1) != 1) skip("/proc/sys/net cannot be written");
    close(file);
  }
  int namespace_ = -1, device_ = -1, status_ = 0;
  pid_t child_ = 0;
};

constexpr std::size_t kLargestPacket = 65536, kUdpHead = 8;
constexpr std::uint8_t kUdp = 17, kVersion4 = 4;

/// The datagram in an IPv4 packet; empty: there is none.
Bytes datagram_of(Bytes packet) {
  if (packet.size() < 20 || packet[0] >> 4 != kVersion4 || packet[9] != kUdp) return {};
  const std::size_t head = 4u * (packet[0] & 15u) + kUdpHead;
  return packet.size() > head ? packet.subspan(head) : Bytes();
}

/// Forms 1 and 2 of 70, section 2: the datagrams that ends count.
bool is_numbered(Bytes datagram) { return (datagram[0] & 3) == 1 || (datagram[0] & 3) == 2; }

/// One direction.
struct Direction {
  Link link;
  std::uint64_t numbered_sent = 0, numbered_arrived = 0;
  std::uint64_t refused = 0;  // by the TUN device

  void take(int from, Microseconds now) {
    std::array<std::uint8_t, kLargestPacket> buffer;
    for (ssize_t size = 0; (size = read(from, buffer.data(), buffer.size())) > 0;) {
      const Bytes packet(buffer.data(), static_cast<std::size_t>(size)), datagram = datagram_of(packet);
      if (datagram.empty()) continue;  // what the system says on its own
      numbered_sent += is_numbered(datagram);
      link.send(now, packet);
    }
  }
  void hand_on(int to, Microseconds now) {
    while (const auto arrival = link.poll(now)) {
      numbered_arrived += is_numbered(datagram_of(arrival->bytes));
      refused += write(to, arrival->bytes.data(), arrival->bytes.size()) != static_cast<ssize_t>(arrival->bytes.size());
    }
  }
  std::string json() const {
    const auto& c = link.counters();
    const auto pair = [](const char* name, std::uint64_t value) {
      return "\"" + std::string(name) + "\": " + std::to_string(value);
    };
    return "{" + pair("sent", c.sent) + ", " + pair("arrived", c.arrived) + ", " + pair("lost", c.lost) + ", " +
           pair("numbered_sent", numbered_sent) + ", " + pair("numbered_arrived", numbered_arrived) + ", " +
           pair("refused", refused) + "}";
  }
};

Direction direction_of(const char* typed) {
  const auto options = tactus::cli::parse_link(typed);
  if (!options) {
    std::fprintf(stderr, "%s\n", options.error().c_str());
    std::exit(2);
  }
  return {Link::create(*options).value()};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: tun_link UP DOWN SERVER CLIENT\n");
    return 2;
  }
  Direction up = direction_of(argv[1]), down = direction_of(argv[2]);
  End server("127.0.0.1", "127.0.0.2"), client("127.0.0.2", "127.0.0.1");
  server.start(argv[3]);
  client.start(argv[4]);

  const auto start = std::chrono::steady_clock::now();
  const auto now = [start] {
    return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start).count();
  };
  constexpr Microseconds kLook = 20'000;  // for commands that have ended
  for (bool running = true; running;) {
    running = static_cast<int>(server.is_running()) + static_cast<int>(client.is_running()) > 0;
    Microseconds next = now() + kLook;
    for (const Direction* direction : {&up, &down}) next = std::min(next, direction->link.next().value_or(next));
    const Microseconds left = std::max<Microseconds>(0, next - now());
    const timespec timeout{left / 1'000'000, left % 1'000'000 * 1000};
    std::array<pollfd, 2> handles{pollfd{server.device(), POLLIN, 0}, pollfd{client.device(), POLLIN, 0}};
    ppoll(handles.data(), handles.size(), &timeout, nullptr);
    up.take(client.device(), now());
    down.take(server.device(), now());
    up.hand_on(server.device(), now());
    down.hand_on(client.device(), now());
  }
  std::printf("{\"up\": %s, \"down\": %s}\n", up.json().c_str(), down.json().c_str());
  return server.has_failed() || client.has_failed() ? 1 : 0;
}
