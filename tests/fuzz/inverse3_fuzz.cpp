// SPDX-License-Identifier: Apache-2.0
/// A hostile service: the input is a message. What is read of it is possible, and a command made of its id is JSON again.
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include <tactus/device/inverse3/inverse3_messages.h>
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactus::device::inverse3;
  const std::vector<char> message(data, data + size);
  const auto state = read_state({message.data(), message.size()}, "");
  if (!state || !*state) return 0;
  require(!(*state)->id.empty() && (*state)->id.size() <= kMostId);
  require(std::abs((*state)->position.x) <= 10 && std::abs((*state)->velocity.z) <= 1000);
  char command[kMostCommand];
  const std::size_t length = write_command(command, (*state)->id, (*state)->position);
  require(length < kMostCommand);
  require(read_state({command, length}, "").has_value());
  return 0;
}
