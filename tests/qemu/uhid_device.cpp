// SPDX-License-Identifier: Apache-2.0
/// A device of the kernel's own making, by /dev/uhid: it waits until somebody opens it, moves and is unplugged.
///
///   uhid_device controller REPORTS RATE    a multi-axis controller: after report n its first axis stands at n modulo 701, minus 350
///   uhid_device glove REPORTS RATE         something of a vendor's own: report n is n in four bytes, then 60 that are n modulo 251
#include <fcntl.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <thread>

namespace {

constexpr int kReach = 350;

// Six axes of 16 bits, from -350 to 350, then two buttons.
constexpr std::array<std::uint8_t, 57> kDescriptor{
    0x05, 0x01, 0x09, 0x08, 0xa1, 0x01,                          // generic desktop, multi-axis controller
    0x16, 0xa2, 0xfe, 0x26, 0x5e, 0x01, 0x36, 0x88, 0xfa, 0x46,  // -350..350, physical -1400..
    0x78, 0x05, 0x55, 0x0c, 0x65, 0x11, 0x75, 0x10, 0x95, 0x06,  // 1400, 10^-4 cm, six of 16 bits
    0x09, 0x30, 0x09, 0x31, 0x09, 0x32, 0x09, 0x33, 0x09, 0x34, 0x09, 0x35, 0x81, 0x02, 0x05, 0x09,
    0x19, 0x01, 0x29, 0x02, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0, 0x00, 0x00};
constexpr std::size_t kDescriptorBytes = kDescriptor.size() - 2;

constexpr std::array<std::uint8_t, 20> kGlove{0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01,  // a page of the vendor's
                                              0x09, 0x02, 0x15, 0x00, 0x25, 0xff, 0x75, 0x08, 0x95, 0x40,  // 64 bytes
                                              0x81, 0x02, 0xc0};

struct Kind {
  const char* name;
  std::span<const std::uint8_t> descriptor;
  std::size_t (*report)(int number, std::uint8_t* out);  // out  its length
};

std::size_t controller_report(int number, std::uint8_t* out) {
  const std::int16_t axis = static_cast<std::int16_t>(number % (2 * kReach + 1) - kReach);
  std::memcpy(out, &axis, sizeof axis);
  out[12] = static_cast<std::uint8_t>(number / 100 % 4);
  return 13;
}

std::size_t glove_report(int number, std::uint8_t* out) {
  std::memcpy(out, &number, sizeof number);
  std::memset(out + 4, number % 251, 60);
  return 64;
}

constexpr Kind kController{"Six axes", std::span(kDescriptor).first(kDescriptorBytes), controller_report};
constexpr Kind kOther{"Glove", kGlove, glove_report};

bool send(int file, const uhid_event& event) { return write(file, &event, sizeof event) == sizeof event; }

bool create(int file, const Kind& kind) {
  uhid_event event{};
  event.type = UHID_CREATE2;
  std::strcpy(reinterpret_cast<char*>(event.u.create2.name), kind.name);
  std::strcpy(reinterpret_cast<char*>(event.u.create2.uniq), "U1");
  std::ranges::copy(kind.descriptor, event.u.create2.rd_data);
  event.u.create2.rd_size = static_cast<std::uint16_t>(kind.descriptor.size());
  event.u.create2.bus = 3;  // USB
  event.u.create2.vendor = 0x1209;
  event.u.create2.product = 1;
  return send(file, event);
}

bool wait_until_opened(int file) {
  pollfd waiting{file, POLLIN, 0};
  while (poll(&waiting, 1, 60'000) == 1) {
    uhid_event event{};
    if (read(file, &event, sizeof event) <= 0) return false;
    if (event.type == UHID_OPEN) return true;
  }
  return false;
}

bool move(int file, const Kind& kind, int number) {
  uhid_event event{};
  event.type = UHID_INPUT2;
  event.u.input2.size = static_cast<std::uint16_t>(kind.report(number, event.u.input2.data));
  return send(file, event);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) return 2;
  const Kind& kind = std::strcmp(arguments[1], "glove") == 0 ? kOther : kController;
  const int reports = std::atoi(arguments[2]), rate = std::atoi(arguments[3]);
  const int file = open("/dev/uhid", O_RDWR | O_CLOEXEC);
  if (file < 0 || !create(file, kind) || !wait_until_opened(file)) {
    std::perror("uhid_device");
    return 1;
  }
  const auto begin = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
  auto worst = std::chrono::nanoseconds(0);
  for (int report = 0; report < reports; ++report) {
    const auto due = begin + report * std::chrono::nanoseconds(1'000'000'000 / rate);
    std::this_thread::sleep_until(due);
    worst = std::max<std::chrono::nanoseconds>(worst, std::chrono::steady_clock::now() - due);
    if (!move(file, kind, report)) return 1;
  }
  std::printf("{\"reports\": %d, \"latest_us\": %.0f}\n", reports, 1e-3 * static_cast<double>(worst.count()));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  return 0;  // unplugged
}
