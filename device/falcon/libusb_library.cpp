// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/falcon/libusb_library.h>

#include <tactus/device/shared_library.h>

namespace tactus::device::falcon {

tl::expected<LibUsb, std::string> LibUsb::load() {
  auto library = SharedLibrary::load("libusb-1.0.so.0");
  if (!library) return tl::unexpected("the Falcon needs libusb (apt-get install libusb-1.0-0): " + library.error());
  LibUsb usb;
  library->find("libusb_init", usb.init);
  library->find("libusb_exit", usb.exit);
  library->find("libusb_error_name", usb.error_name);
  library->find("libusb_get_device_list", usb.get_device_list);
  library->find("libusb_free_device_list", usb.free_device_list);
  library->find("libusb_ref_device", usb.ref_device);
  library->find("libusb_unref_device", usb.unref_device);
  library->find("libusb_get_device_descriptor", usb.get_device_descriptor);
  library->find("libusb_get_bus_number", usb.get_bus_number);
  library->find("libusb_get_device_address", usb.get_device_address);
  library->find("libusb_open", usb.open);
  library->find("libusb_close", usb.close);
  library->find("libusb_get_device", usb.get_device);
  library->find("libusb_get_string_descriptor_ascii", usb.get_string_descriptor_ascii);
  library->find("libusb_set_auto_detach_kernel_driver", usb.set_auto_detach_kernel_driver);
  library->find("libusb_claim_interface", usb.claim_interface);
  library->find("libusb_release_interface", usb.release_interface);
  library->find("libusb_control_transfer", usb.control_transfer);
  library->find("libusb_bulk_transfer", usb.bulk_transfer);
  if (library->missing() != nullptr)
    return tl::unexpected(std::string("this libusb is too old: it lacks ") + library->missing() +
                          " (apt-get install libusb-1.0-0)");
  return usb;
}

}  // namespace tactus::device::falcon
