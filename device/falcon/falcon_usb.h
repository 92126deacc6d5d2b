// SPDX-License-Identifier: Apache-2.0
/// What a Falcon needs of USB, so that everything above it runs against a script, too. The Falcon is an FTDI chip (0403:cb48) with one
/// interface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include <tactus/device/device.h>

namespace tactus::device::falcon {

enum class UsbStatus : std::uint8_t {
  done,
  timeout,
  gone,    ///< unplugged
  denied,  ///< the user may not open it
  busy,    ///< another program has it
  no_library,
  failed,  ///< anything else
};

struct UsbTransfer {
  UsbStatus status = UsbStatus::done;
  std::size_t bytes = 0;  ///< moved, also when the time was over
};

/// An open interface. One thread reads; another one may write meanwhile.
class UsbPort {
 public:
  /// A vendor request to the chip, without data.   time at most kAnswerTime
  virtual UsbStatus control(std::uint8_t request, std::uint16_t value) noexcept = 0;
  /// time at most kAnswerTime
  virtual UsbTransfer write(std::span<const std::uint8_t> bytes) noexcept = 0;
  /// One transfer, modem bytes included.   time until `deadline`, but at least 1 ms
  virtual UsbTransfer read(std::span<std::uint8_t> bytes, Time deadline) noexcept = 0;
  virtual Time now() const noexcept = 0;
  virtual const std::string& serial() const noexcept = 0;

  virtual ~UsbPort() = default;  ///< gives the interface back
  UsbPort() = default;
  UsbPort(const UsbPort&) = delete;
  UsbPort& operator=(const UsbPort&) = delete;
};

class UsbBus {
 public:
  /// The Falcons that are connected, without opening any: whether this user may open them.
  /// err  a sentence: USB cannot be looked at
  virtual tl::expected<std::vector<bool>, std::string> list() const = 0;
  /// in   index       as in list()
  ///      last_words  what is written if this process ends without closing the port (killed, crashed)
  /// err  gone: there is no such Falcon
  virtual tl::expected<std::unique_ptr<UsbPort>, UsbStatus> open(std::size_t index,
                                                                 std::span<const std::uint8_t> last_words) const = 0;

  virtual ~UsbBus() = default;
};

/// By libusb, which list() and open() load. Its transfers allocate. A Guardian has the last words.
std::unique_ptr<UsbBus> real_bus();

}  // namespace tactus::device::falcon
