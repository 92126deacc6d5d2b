// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/hid/hidapi_library.h>

#include <tactus/device/shared_library.h>

namespace tactus::device::hid {

tl::expected<HidApi, std::string> HidApi::load() {
  auto library = SharedLibrary::load("libhidapi-hidraw.so.0");
  if (!library)
    return tl::unexpected("multi-axis controllers need hidapi (apt-get install libhidapi-hidraw0): " + library.error());
  HidApi hid;
  library->find("hid_enumerate", hid.enumerate);
  library->find("hid_free_enumeration", hid.free_enumeration);
  library->find("hid_open_path", hid.open_path);
  library->find("hid_close", hid.close);
  library->find("hid_read_timeout", hid.read_timeout);
  if (library->missing() != nullptr)
    return tl::unexpected(std::string("this hidapi is too old: it lacks ") + library->missing() +
                          " (apt-get install libhidapi-hidraw0)");
  return hid;
}

}  // namespace tactus::device::hid
