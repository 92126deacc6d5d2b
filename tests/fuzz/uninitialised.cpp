// SPDX-License-Identifier: Apache-2.0
/// A packet of bytes that nobody wrote. MemorySanitizer must stop this program inside the receiver; if it ends with 0, the build
/// watches nothing.
#include <memory>

#include <tactus/receiver.h>

int main() {
  tactus::SceneSpec spec;
  spec.objects.push_back({"o", tactus::Dof::all, {}});
  const auto scene = tactus::Scene::create(std::move(spec));
  if (!scene) return 0;
  auto receiver = tactus::Receiver::create(*scene);
  if (!receiver) return 0;
  constexpr std::size_t kSize = 16;
  const std::unique_ptr<std::uint8_t[]> packet(new std::uint8_t[kSize]);
  (void)receiver->push(1, {packet.get(), kSize});
  return 0;
}
