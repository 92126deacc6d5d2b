// SPDX-License-Identifier: Apache-2.0
/// A packet of bytes that nobody wrote. MemorySanitizer must stop this program inside the decoder; if it ends with 0, the build
/// watches nothing.
#include <cstdlib>
#include <memory>

#include <tactus/rigid/rigid_decoder.h>

int main() {
  tactus::StreamHeader header;
  header.objects.push_back({"o", tactus::Dof::all, {}});
  auto decoder = tactus::RigidDecoder::create(header);
  if (!decoder) return 0;
  constexpr std::size_t kSize = 16;
  const std::unique_ptr<std::uint8_t[]> packet(new std::uint8_t[kSize]);
  (void)decoder->decode({packet.get(), kSize});
  return 0;
}
