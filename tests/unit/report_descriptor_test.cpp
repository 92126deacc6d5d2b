// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/hid/report_descriptor.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/property/allocated.h"
#include "tests/unit/hid_fixture.h"

namespace tactus::device::hid {
namespace {

using testing::Bytes;
using testing::joined;

void expect_broken(const Bytes& bytes, const char* what) {
  const auto fields = parse_report_descriptor(bytes);
  ASSERT_FALSE(fields) << what;
  EXPECT_EQ(fields.error().code, Errc::malformed) << what;
  EXPECT_STREQ(fields.error().rule, "R-DEV-5") << what;
  EXPECT_LE(fields.error().bit_offset, 8 * bytes.size()) << what;
}

TEST(ReportDescriptor, AnOlderMouseHasThreeReports) {
  const auto fields = parse_report_descriptor(testing::older_mouse());
  ASSERT_TRUE(fields);
  ASSERT_EQ(fields->size(), 8u);
  for (std::uint32_t axis = 0; axis < 6; ++axis) {
    const auto report = static_cast<std::uint8_t>(axis < 3 ? 1 : 2);
    EXPECT_EQ((*fields)[axis],
              (Field{kAxisX + axis, kMultiAxisController, report, 16 * (axis % 3), 16, -350, 350, -1400, 1400, 0x11, -4}))
        << axis;
  }
  for (std::uint32_t button = 0; button < 2; ++button)
    EXPECT_EQ((*fields)[6 + button], (Field{kButtons + 1 + button, kMultiAxisController, 3, button, 1, 0, 1, 0, 1, 0x11, -4}))
        << button;
}

TEST(ReportDescriptor, ANewerMouseHasAllAxesInOne) {
  const auto fields = parse_report_descriptor(testing::newer_mouse());
  ASSERT_TRUE(fields);
  ASSERT_EQ(fields->size(), 8u);
  for (std::uint32_t axis = 0; axis < 6; ++axis) {
    EXPECT_EQ((*fields)[axis].usage, kAxisX + axis);
    EXPECT_EQ((*fields)[axis].report, 1);
    EXPECT_EQ((*fields)[axis].bit, 16 * axis);
  }
}

TEST(ReportDescriptor, LimitsArePlainWhereTheLowerOneIs) {
  const auto fields = parse_report_descriptor(testing::plain_controller());
  ASSERT_TRUE(fields);
  ASSERT_EQ(fields->size(), 14u);
  EXPECT_EQ((*fields)[0], (Field{kAxisX, kMultiAxisController, 0, 0, 8, 0, 255, 0, 2, 0x13, 0}));
  EXPECT_EQ((*fields)[3], (Field{kAxisX + 3, kMultiAxisController, 0, 24, 8, 0, 255, -90, 90, 0x14, 0}));
  EXPECT_EQ((*fields)[13].usage, kButtons + 8);
  EXPECT_EQ((*fields)[13].bit, 55u);
}

TEST(ReportDescriptor, StatesAreSavedAndPagesStandInUsages) {
  const auto fields =
      parse_report_descriptor(joined({{0x15, 0x81, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x01},
                                      {0xa4, 0x75, 0x04, 0xb4},              // 4 bits, and back to 8
                                      {0xfe, 0x02, 0x33, 0x01, 0x02},        // a long item
                                      {0x0b, 0x30, 0x00, 0x01, 0x00},        // usage X with its page
                                      {0x81, 0x02, 0x05, 0x02, 0x09, 0x31},  // not Y: another page
                                      {0x81, 0x02, 0x09, 0x32, 0x05, 0x01},  // Z: the page comes later, but counts
                                      {0x81, 0x02}}));
  ASSERT_TRUE(fields);
  ASSERT_EQ(fields->size(), 2u);
  EXPECT_EQ((*fields)[0], (Field{kAxisX, 0, 0, 0, 8, -127, 127, -127, 127, 0, 0}));
  EXPECT_EQ((*fields)[1].usage, kAxisX + 2);
  EXPECT_EQ((*fields)[1].bit, 16u);
}

TEST(ReportDescriptor, ConstantsArraysAndOtherUsagesArePassedOver) {
  const auto only = [](const Bytes& input, const Bytes& usages) {
    const auto fields =
        parse_report_descriptor(joined({testing::kDesktop, {0x15, 0x00, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x02}, usages, input}));
    return fields ? fields->size() : 99;
  };
  EXPECT_EQ(only({0x81, 0x02}, testing::kXyz), 2u);  // no more than are counted
  EXPECT_EQ(only({0x81, 0x03}, testing::kXyz), 0u);
  EXPECT_EQ(only({0x81, 0x00}, testing::kXyz), 0u);
  EXPECT_EQ(only({0x91, 0x02}, testing::kXyz), 0u);
  EXPECT_EQ(only({0xb1, 0x02}, testing::kXyz), 0u);
  EXPECT_EQ(only({0x81, 0x02}, {0x09, 0x38}), 0u);  // a wheel
  EXPECT_EQ(only({0x81, 0x02}, {0x09, 0x30}), 1u);  // what the second one is, is not told
  EXPECT_EQ(only({0x81, 0x02}, {}), 0u);
}

TEST(ReportDescriptor, WhatIsOutOfOrderIsRefused) {
  expect_broken({0x26, 0x01}, "data cut off");
  expect_broken({0xfe, 0x02, 0x00, 0x01}, "a long item cut off");
  expect_broken({0xfe, 0x02}, "the head of a long item cut off");
  expect_broken({0xc0}, "an end without a beginning");
  expect_broken({0xa1, 0x01}, "a beginning without an end");
  expect_broken({0xb4}, "a state that was not saved");
  expect_broken({0x85, 0x00}, "report 0");
  expect_broken({0x86, 0x00, 0x01}, "report 256");
  expect_broken({0x75, 0x08, 0x95, 0x01, 0x81, 0x03, 0x85, 0x01}, "an id after a report without");
  expect_broken({0x29, 0x05}, "a range without a beginning");
  expect_broken({0x19, 0x05, 0x29, 0x04}, "a range backwards");
  expect_broken({0x05, 0x01, 0x09, 0x30, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02}, "an axis without a range");
  expect_broken(
      joined({{0x15, 0x00, 0x25, 0x01, 0x56, 0x10, 0x00}, testing::kDesktop, {0x09, 0x30, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02}}),
      "an exponent of 16");
}

TEST(ReportDescriptor, LimitsAreKept) {
  const Bytes cell{0x81, 0x03};
  EXPECT_TRUE(parse_report_descriptor({}));
  EXPECT_TRUE(parse_report_descriptor(Bytes(kMostDescriptor, 0x14)));
  expect_broken(Bytes(kMostDescriptor + 1, 0x14), "too long");
  EXPECT_TRUE(parse_report_descriptor(joined({{0x75, 0x08, 0x96, 0x00, 0x10}, cell})));
  expect_broken(joined({{0x75, 0x08, 0x96, 0x00, 0x10}, cell, {0x95, 0x01}, cell}), "a report of 4097 bytes");
  expect_broken(joined({{0x77, 0xff, 0xff, 0xff, 0xff, 0x97, 0xff, 0xff, 0xff, 0xff}, cell}), "2^64 bits");
  expect_broken(Bytes(65, 0xa4), "65 saved states");
  Bytes nested;
  for (int i = 0; i < 65; ++i) nested.insert(nested.end(), {0xa1, 0x00});
  expect_broken(nested, "65 collections");
  Bytes buttons{0x05, 0x09, 0x25, 0x01, 0x75, 0x01, 0x95, 0x20};
  for (int i = 0; i < 32; ++i) buttons.insert(buttons.end(), {0x19, 0x01, 0x29, 0x20, 0x81, 0x02});
  EXPECT_EQ(parse_report_descriptor(buttons)->size(), kMostFields);
  expect_broken(joined({buttons, {0x09, 0x01, 0x81, 0x02}}), "1025 fields");
}

TEST(ReportDescriptor, PrefixesAndBitFlipsDoNoHarm) {
  for (const Bytes& whole : {testing::older_mouse(), testing::newer_mouse(), testing::plain_controller()}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Bytes prefix(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_EQ(parse_report_descriptor(prefix).has_value(), size < 5 && size % 2 == 0)
          << size;  // before the collection is opened
    }
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
      Bytes flipped = whole;
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      const auto fields = parse_report_descriptor(flipped);
      if (!fields) continue;
      for (const Field& field : *fields) EXPECT_LE(field.bit + field.size, kMostReport);
    }
  }
}

TEST(ReportDescriptor, ValuesAreCutOutOfReports) {
  Field field;
  field.report = 7;
  std::srand(3);
  for (int round = 0; round < 5000; ++round) {
    field.size = static_cast<std::uint8_t>(1 + std::rand() % 32);
    field.bit = static_cast<std::uint32_t>(std::rand() % 70);
    field.logical_low = std::rand() % 2 - 1;
    Bytes report(15);
    report[0] = 7;
    std::int64_t expected = 0;
    for (std::size_t bit = 8; bit < 8 * report.size(); ++bit) {
      if (std::rand() % 2 == 0) continue;
      report[bit / 8] = static_cast<std::uint8_t>(report[bit / 8] | 1u << bit % 8);
      const std::size_t place = bit - 8 - field.bit;
      if (place < field.size) expected |= std::int64_t{1} << place;
    }
    if (field.logical_low < 0 && (expected >> (field.size - 1) & 1) != 0) expected -= std::int64_t{1} << field.size;
    ASSERT_EQ(value_in(report, field), expected) << +field.size << ' ' << field.bit;
    const std::size_t needed = 1 + (field.bit + field.size + 7) / 8;
    EXPECT_TRUE(value_in(std::span(report).first(needed), field));
    EXPECT_FALSE(value_in(std::span(report).first(needed - 1), field));
    report[0] = 8;
    EXPECT_FALSE(value_in(report, field));
  }
  EXPECT_FALSE(value_in({}, field));
}

}  // namespace
}  // namespace tactus::device::hid
