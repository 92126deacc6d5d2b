// SPDX-License-Identifier: Apache-2.0
/// Both ends of the seal among hostile datagrams: the input is a row of (operation, size, its bytes). Who has not validated an address gets
/// no more than three times what it sent, a stranger's datagram never comes out as one of the session, and no noise ends an association.
/// The input is a key file and a key list, too. (GnuTLS draws its random numbers: the same input takes the same path, but for their values.)
#include <algorithm>
#include <string_view>

#include "tests/fuzz/seal_world.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactus;
  testing::World world;
  std::span<const std::uint8_t> left(data, size);
  if (size > 0 && data[0] % 2 == 0) world.flow();
  while (left.size() >= 3) {
    const std::uint8_t op = left[0];
    const std::size_t bytes = std::min<std::size_t>(left[1] + 256u * (left[2] % 8), left.size() - 3);
    testing::Bytes datagram(left.begin() + 3, left.begin() + 3 + static_cast<std::ptrdiff_t>(bytes));
    left = left.subspan(3 + bytes);
    if (op & 16u) {  // the newest true one, changed
      testing::Bytes changed = op & 32u ? world.up : world.down;
      for (std::size_t i = 0; i + 1 < datagram.size() && !changed.empty(); i += 2)
        changed[datagram[i] % changed.size()] ^= datagram[i + 1];
      datagram = changed;
    }
    if (op % 4 == 0) world.hostile_up(op & 64u ? world.home : world.elsewhere, datagram);
    else if (op % 4 == 1) world.hostile_down(datagram);
    else if (op % 4 == 2) world.flow();
    else world.now += 1000u * datagram.size();
    require(world.client.handle_timeout(world.now) || !world.client.is_open());
  }
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  static_cast<void>(seal::Key::parse(text, "fuzz"));
  if (const auto list = seal::KeyList::parse(text, "fuzz")) {
    require(list->users().size() <= seal::KeyList::kMostUsers);
    for (const seal::KeyList::User& user : list->users())
      require(seal::Key::is_name(user.name()) && list->find(user.name()) == &user);
  }
  return 0;
}
