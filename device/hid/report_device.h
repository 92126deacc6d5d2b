// SPDX-License-Identifier: Apache-2.0
/// A HID device of any kind, whose reports are handed on as they come.
#pragma once

#include <memory>

#include <tactus/device/device.h>
#include <tactus/device/hid/hid_raw.h>

namespace tactus::device::hid {

Capabilities report_capabilities(const RawListing& listing);

/// What comes beyond a tick's room is left in the system, which keeps 64 reports.
std::unique_ptr<Device> make_report_device(std::unique_ptr<RawPort> port, const RawListing& listing);

}  // namespace tactus::device::hid
