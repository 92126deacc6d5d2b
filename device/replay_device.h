// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include <tactus/device/device.h>
#include <tactus/device/recording.h>

namespace tactus::device {

/// A recording as a device; it takes no force. The time of a sample is the recording's.
/// in   path  a trace; its frame of coordinates is taken as the device's
/// err  those of Recording::read
tl::expected<std::unique_ptr<Device>, Diagnostic> open_replay_device(const std::string& path, const RecordingOptions& options);

}  // namespace tactus::device
