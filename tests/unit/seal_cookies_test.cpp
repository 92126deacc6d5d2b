// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/association.h>

#include "tests/unit/seal_fixture.h"

namespace tactus::seal {
namespace {

using tactus::testing::Bytes;
using tactus::testing::bytes_of;
using tactus::testing::key_of;
using Verdict = Cookies::Verdict;

constexpr std::uint64_t kSecond = 1'000'000;

/// The ClientHello of a client, without a cookie and with that of an answer.
struct Hellos {
  Hellos() : context(Context::create(key_of(), {}).value()), client(Association::client(*context).value()) {
    client->advance({});
  }
  Bytes bare() const { return bytes_of(client->flight()); }
  Bytes with(std::span<const std::uint8_t> answer) {
    client->advance(answer);
    return bytes_of(client->flight());
  }
  std::unique_ptr<const Context> context;
  std::unique_ptr<Association> client;
};

TEST(SealCookies, ProveTheAddressThatTheyWereMadeFor) {
  Cookies cookies = Cookies::create(0).value();
  const Bytes here = bytes_of("192.0.2.1:1"), there = bytes_of("192.0.2.1:2");
  Hellos hellos;
  EXPECT_EQ(cookies.look(0, here, hellos.bare()).verdict, Verdict::unproven);
  EXPECT_LT(cookies.answer(here).size(), hellos.bare().size()) << "shorter than what asks for it";
  const Bytes hello = hellos.with(cookies.answer(here));
  EXPECT_EQ(cookies.look(0, here, hello).verdict, Verdict::proven);
  EXPECT_EQ(cookies.look(0, there, hello).verdict, Verdict::unproven);
  Cookies of_another = Cookies::create(0).value();
  EXPECT_EQ(of_another.look(0, here, hello).verdict, Verdict::unproven);
}

TEST(SealCookies, LastFor30To60Seconds) {
  for (const std::uint64_t made : {0 * kSecond, 10 * kSecond, 29 * kSecond, 45 * kSecond}) {
    Cookies cookies = Cookies::create(0).value();
    Hellos hellos;
    const Bytes here = bytes_of("here");
    static_cast<void>(cookies.look(made, here, hellos.bare()));
    const Bytes hello = hellos.with(cookies.answer(here));
    EXPECT_EQ(cookies.look(made + 30 * kSecond, here, hello).verdict, Verdict::proven) << made;
    EXPECT_EQ(cookies.look(made + 60 * kSecond, here, hello).verdict, Verdict::unproven) << made;
  }
}

TEST(SealCookies, NobodyForLongEndsThemAll) {
  Cookies cookies = Cookies::create(0).value();
  Hellos hellos;
  const Bytes here = bytes_of("here");
  const Bytes hello = hellos.with(cookies.answer(here));
  EXPECT_EQ(cookies.look(3600 * kSecond, here, hello).verdict, Verdict::unproven);
  Hellos later;
  EXPECT_EQ(cookies.look(3600 * kSecond, here, later.with(cookies.answer(here))).verdict, Verdict::proven);
}

TEST(SealCookies, EveryPrefixAndEveryBit) {
  Cookies cookies = Cookies::create(0).value();
  Hellos hellos;
  const Bytes here = bytes_of("here"), hello = hellos.with(cookies.answer(here));
  for (std::size_t size = 0; size < 60; ++size)
    EXPECT_NE(cookies.look(0, here, std::span(hello).first(size)).verdict, Verdict::proven) << size;
  constexpr std::size_t kCookie = 13 + 12 + 2 + 32 + 1 + 1;
  for (std::size_t bit = 0; bit < 128; ++bit) {
    Bytes changed = hello;
    changed[kCookie + bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    EXPECT_EQ(cookies.look(0, here, changed).verdict, Verdict::unproven) << bit;
  }
}

}  // namespace
}  // namespace tactus::seal
