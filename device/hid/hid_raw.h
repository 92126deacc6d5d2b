// SPDX-License-Identifier: Apache-2.0
/// What the backend `hid` needs of the system, so that everything above it runs against a script, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include <tactus/device/device.h>

namespace tactus::device::hid {

struct RawListing {
  std::string path;  ///< "/dev/hidraw0"
  std::string model, serial;
  std::uint16_t vendor = 0, product = 0;
  bool may_open = false;
  std::vector<std::uint8_t> descriptor;  ///< of its reports; empty: not known
};

enum class RawRefusal : std::uint8_t { gone, denied, failed };

class RawPort {
 public:
  virtual const std::vector<std::uint8_t>& descriptor() const noexcept = 0;
  /// The oldest report that was not read yet, at once: its bytes, 0 when there is none; none at all: the device is gone.
  virtual std::optional<std::size_t> read(std::span<std::uint8_t> report) noexcept = 0;
  virtual Time now() const noexcept = 0;

  virtual ~RawPort() = default;
  RawPort() = default;
  RawPort(const RawPort&) = delete;
  RawPort& operator=(const RawPort&) = delete;
};

class RawBus {
 public:
  /// HID devices that are connected, by path, without opening any.   err  a sentence: they cannot be looked at
  virtual tl::expected<std::vector<RawListing>, std::string> list() const = 0;
  virtual tl::expected<std::unique_ptr<RawPort>, RawRefusal> open(const std::string& path) const = 0;

  virtual ~RawBus() = default;
};

/// By hidapi, which list() and open() load.
std::unique_ptr<RawBus> real_bus();

}  // namespace tactus::device::hid
