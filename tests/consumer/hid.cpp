// SPDX-License-Identifier: Apache-2.0
/// A user of the component hid: looks for a device, and prints what to do when it cannot be opened.
#include <tactus/device/hid/hid_device.h>

#include <cstdio>

int main() {
  const tactus::device::hid::HidBackend backend;
  for (const auto& device : backend.list().devices) std::printf("%s\n", device.name.c_str());
  const auto device = backend.open("9", {});
  if (device) return 1;
  std::printf("%s\n", to_string(device.error()).c_str());
  return 0;
}
