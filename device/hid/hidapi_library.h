// SPDX-License-Identifier: Apache-2.0
/// What we use of hidapi, loaded when a controller is looked for. The names are hidapi's own.
#pragma once

#include <hidapi.h>

#include <string>
#include <tl/expected.hpp>

namespace tactus::device::hid {

struct HidApi {
  decltype(&hid_enumerate) enumerate = nullptr;
  decltype(&hid_free_enumeration) free_enumeration = nullptr;
  decltype(&hid_open_path) open_path = nullptr;
  decltype(&hid_close) close = nullptr;
  decltype(&hid_read_timeout) read_timeout = nullptr;

  /// err  a sentence: it is not there, and how to get it
  static tl::expected<HidApi, std::string> load();
};

}  // namespace tactus::device::hid
