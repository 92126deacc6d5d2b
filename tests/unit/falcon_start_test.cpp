// SPDX-License-Identifier: Apache-2.0
/// Firmware for a Falcon that was switched on.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <tactus/device/falcon/falcon_frame.h>
#include "tests/unit/falcon_fixture.h"

namespace tactus::device::falcon {
namespace {

using testing::FakeFalcon;
using testing::FakePort;

std::string reported(const tl::expected<void, Diagnostic>& result) { return result ? "fine" : to_string(result.error()); }

/// A file of so many bytes, gone at the end.
class File {
 public:
  explicit File(std::size_t size) {
    std::ofstream out(path_, std::ios::binary);
    for (std::size_t i = 0; i < size; ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(i * 37 + i / 256));
      out.put(static_cast<char>(bytes_.back()));
    }
  }
  ~File() { std::filesystem::remove(path_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  const std::string& path() const { return path_; }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::string path_ =
      ::testing::TempDir() + "falcon_start_test." + ::testing::UnitTest::GetInstance()->current_test_info()->name();
  std::vector<std::uint8_t> bytes_;
};

class FalconStart : public ::testing::Test {
 protected:
  FakeFalcon falcon_;
  FakePort port_{falcon_};
  File file_{1000};
};

TEST_F(FalconStart, AFalconThatRunsNeedsNoFirmware) {
  EXPECT_EQ(reported(start(port_, "")), "fine");
  EXPECT_TRUE(falcon_.firmware.empty());
  EXPECT_EQ(falcon_.settings, (std::vector<std::pair<std::uint8_t, std::uint16_t>>{{9, 1}, {3, 2}, {0, 1}, {0, 2}}));
  EXPECT_EQ(falcon_.frames.size(), 1u);
  EXPECT_TRUE(falcon_.is_at_rest());
}

TEST_F(FalconStart, OneThatWasSwitchedOnTakesIt) {
  falcon_.runs = false;
  EXPECT_EQ(reported(start(port_, file_.path())), "fine");
  EXPECT_EQ(falcon_.firmware, file_.bytes());
  const std::vector<std::pair<std::uint8_t, std::uint16_t>> greeting{
      {0, 1}, {0, 2}, {9, 16}, {3, 0x4138}, {4, 8}, {2, 0}, {1, 0x200}, {1, 0x100}, {1, 0x101}, {1, 0x100}, {3, 0x15}};
  ASSERT_EQ(falcon_.settings.size(), 4 + greeting.size() + 4);
  EXPECT_TRUE(std::equal(greeting.begin(), greeting.end(), falcon_.settings.begin() + 4));
}

TEST_F(FalconStart, WithoutFirmwareTheErrorSaysWhatToName) {
  falcon_.runs = false;
  EXPECT_EQ(reported(start(port_, "")),
            "the Falcon was switched on and has no firmware yet: R-DEV-3: what the device needs on this machine is not "
            "there; name the firmware file that came with the vendor's driver, and switch the Falcon off and on");
  EXPECT_EQ(
      reported(start(port_, "/nowhere/firmware.bin")).find("/nowhere/firmware.bin: the firmware cannot be read: No such file"),
      0u);
  for (const std::size_t size : {std::size_t{0}, kMostFirmware + 1}) {
    const File other(size);
    const auto result = start(port_, other.path());
    ASSERT_FALSE(result) << size;
    EXPECT_STREQ(result.error().error.rule, "R-DEV-3");
    EXPECT_EQ(result.error().file, other.path());
  }
  EXPECT_STREQ(start(port_, ::testing::TempDir()).error().error.rule, "R-DEV-3");
  EXPECT_TRUE(falcon_.firmware.empty());
}

TEST_F(FalconStart, FirmwareThatDoesNotRunIsNamed) {
  falcon_.runs = falcon_.takes_firmware = false;
  const auto result = start(port_, file_.path());
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().error.code, Errc::unsupported);
  EXPECT_EQ(result.error().file, file_.path());
}

TEST_F(FalconStart, EveryTransferMayFail) {
  falcon_.runs = false;
  std::uint64_t number = 0;
  for (;; ++number) {
    FakeFalcon falcon;
    falcon.runs = false;
    falcon.fails_at = number;
    falcon.failure = number % 2 == 0 ? UsbStatus::gone : UsbStatus::failed;
    FakePort port(falcon);
    const auto result = start(port, file_.path());
    if (result) break;
    ASSERT_STREQ(result.error().error.rule, "R-DEV-4") << number;
    ASSERT_EQ(result.error().error.code, Errc::io);
    ASSERT_FALSE(result.error().detail.empty());
  }
  EXPECT_GT(number, 200u);
}

TEST_F(FalconStart, SilenceEndsIt) {
  falcon_.runs = false;
  falcon_.is_deaf = true;
  const Time begin = falcon_.now;
  const auto result = start(port_, file_.path());
  ASSERT_FALSE(result);
  EXPECT_STREQ(result.error().error.rule, "R-DEV-4");
  EXPECT_NE(result.error().detail.find("power"), std::string::npos);
  EXPECT_LT(falcon_.now - begin, 2000 * kMillisecond);
}

/// Each answer in turn is another one: a bit flipped, a byte missing.
TEST_F(FalconStart, EveryWrongAnswerIsRefusedOrAskedForAgain) {
  for (const bool is_short : {false, true}) {
    for (int which = 0; which < 20; ++which) {
      FakeFalcon falcon;
      falcon.runs = false;
      int number = 0;
      falcon.spoil = [&](std::vector<std::uint8_t> bytes) {
        if (number++ == which && is_short) bytes.pop_back();
        else if (number - 1 == which) bytes.front() ^= 4;
        return bytes;
      };
      FakePort port(falcon);
      const auto result = start(port, file_.path());
      if (result) {  // the greeting, a frame, or none
        EXPECT_EQ(falcon.firmware, file_.bytes());
        EXPECT_TRUE(which == 0 || which >= 19) << which;
      } else {
        EXPECT_STREQ(result.error().error.rule, is_short ? "R-DEV-4" : "R-DEV-5") << which;
      }
    }
  }
}

TEST_F(FalconStart, SomethingElseBehindTheChipIsNoFalcon) {
  falcon_.runs = false;
  falcon_.spoil = [](std::vector<std::uint8_t> bytes) { return std::vector<std::uint8_t>(bytes.size(), '?'); };
  const auto result = start(port_, file_.path());
  ASSERT_FALSE(result);
  EXPECT_STREQ(result.error().error.rule, "R-DEV-5");
}

TEST_F(FalconStart, AnswersMayComeByteByByte) {
  falcon_.runs = false;
  falcon_.most_bytes = 1;
  EXPECT_EQ(reported(start(port_, file_.path())), "fine");
  EXPECT_EQ(falcon_.firmware, file_.bytes());
}

}  // namespace
}  // namespace tactus::device::falcon
