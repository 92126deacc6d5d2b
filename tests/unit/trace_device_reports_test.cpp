// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/device_reports.h>

#include <gtest/gtest.h>

#include <tactus/trace/messages.h>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(DeviceReports, HexadecimalDigitsGiveTheBytesBack) {
  const Bytes bytes{0x00, 0x0f, 0xa0, 0xff};
  EXPECT_EQ(hex_of(bytes), "000fa0ff");
  EXPECT_EQ(bytes_of_hex("000fa0ff"), bytes);
  EXPECT_EQ(bytes_of_hex(""), Bytes{});
  for (const char* wrong : {"0", "0g", "g0", " 1", "-1", "+1", "1 ", "0x"}) EXPECT_FALSE(bytes_of_hex(wrong)) << wrong;
}

TEST(DeviceReports, WhatIsNoListOfReportsIsRefused) {
  DeviceReports out;
  Bytes message;
  encode_reports(message, 5, {{2, 1}, {1, 2, 3}});
  EXPECT_EQ(decode_reports(message, out), 5u);
  EXPECT_EQ(out, (DeviceReports{{2, 1}, {1, 2, 3}}));
  for (const DeviceReports& wrong :
       {DeviceReports{{2}, {1}}, DeviceReports{{0}, {}}, DeviceReports{}, DeviceReports{{0, 1}, {1}}}) {
    encode_reports(message, 5, wrong);
    EXPECT_STREQ(decode_reports(message, out).error().rule, "R-TRC-14");
  }
  encode_reports(message, 5, {{2, 1}, {1, 2, 3}});
  for (std::size_t size = 0; size < message.size(); ++size)
    EXPECT_FALSE(decode_reports(std::span(message).first(size), out)) << size;
  message[message.size() - 7] = 0xff;  // of the number of bytes
  EXPECT_STREQ(decode_reports(message, out).error().rule, "R-TRC-13");
}

}  // namespace
}  // namespace tactus
