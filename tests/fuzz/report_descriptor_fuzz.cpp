// SPDX-License-Identifier: Apache-2.0
/// A hostile device: a byte of length, so many bytes of a report, and the rest is its report descriptor. Fields lie within the limits, and
/// values within what their size can hold.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/device/hid/report_descriptor.h>
#include "tests/fuzz/require.h"

namespace {

using namespace tactus::device::hid;

void check(const Field& field) {
  const bool is_axis = field.usage >= kAxisX && field.usage <= kAxisRz;
  require(is_axis || (field.usage > kButtons && field.usage <= kButtons + kMostButtons));
  require(!is_axis || field.logical_low < field.logical_high);
  require(field.size >= 1 && field.size <= 32 && field.bit + field.size <= kMostReport);
  require(field.exponent >= -8 && field.exponent <= 7);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t bytes = std::min<std::size_t>(data[0], size - 1);
  const std::vector<std::uint8_t> report(data + 1, data + 1 + bytes), descriptor(data + 1 + bytes, data + size);
  const auto fields = parse_report_descriptor(descriptor);
  if (!fields) return 0;
  require(fields->size() <= kMostFields);
  for (const Field& field : *fields) {
    check(field);
    const auto value = value_in(report, field);
    if (!value) continue;
    const std::int64_t range = std::int64_t{1} << field.size;
    require(field.logical_low < 0 ? *value >= -range / 2 && *value < range / 2 : *value >= 0 && *value < range);
  }
  return 0;
}
