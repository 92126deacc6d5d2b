// SPDX-License-Identifier: Apache-2.0
/// What we use of libusb 1.0, loaded when a Falcon is looked for. The names are libusb's own.
#pragma once

#include <libusb.h>

#include <string>
#include <tl/expected.hpp>

namespace tactus::device::falcon {

struct LibUsb {
  decltype(&libusb_init) init = nullptr;
  decltype(&libusb_exit) exit = nullptr;
  decltype(&libusb_error_name) error_name = nullptr;
  decltype(&libusb_get_device_list) get_device_list = nullptr;
  decltype(&libusb_free_device_list) free_device_list = nullptr;
  decltype(&libusb_ref_device) ref_device = nullptr;
  decltype(&libusb_unref_device) unref_device = nullptr;
  decltype(&libusb_get_device_descriptor) get_device_descriptor = nullptr;
  decltype(&libusb_get_bus_number) get_bus_number = nullptr;
  decltype(&libusb_get_device_address) get_device_address = nullptr;
  decltype(&libusb_open) open = nullptr;
  decltype(&libusb_close) close = nullptr;
  decltype(&libusb_get_device) get_device = nullptr;
  decltype(&libusb_get_string_descriptor_ascii) get_string_descriptor_ascii = nullptr;
  decltype(&libusb_set_auto_detach_kernel_driver) set_auto_detach_kernel_driver = nullptr;
  decltype(&libusb_claim_interface) claim_interface = nullptr;
  decltype(&libusb_release_interface) release_interface = nullptr;
  decltype(&libusb_control_transfer) control_transfer = nullptr;
  decltype(&libusb_bulk_transfer) bulk_transfer = nullptr;

  /// err  a sentence: it is not there, and how to get it
  static tl::expected<LibUsb, std::string> load();
};

}  // namespace tactus::device::falcon
