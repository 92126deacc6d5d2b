// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/openhaptics/hd_runtime.h>

#include <gtest/gtest.h>

#include <fstream>

#include <tactus/device/openhaptics/openhaptics_device.h>

namespace tactus::device::openhaptics {
namespace {

bool is_loaded(const std::string& library) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (line.find(library) != std::string::npos) return true;
  return false;
}

TEST(HdRuntime, IsLoadedWhenADeviceIsOpenedAndNotBefore) {
  const OpenHapticsBackend backend;
  (void)backend.list();
  EXPECT_FALSE(is_loaded("libHD.so"));
  ASSERT_TRUE(Runtime::load(STUB_LIBHD));
  EXPECT_TRUE(is_loaded("libHD.so"));
}

TEST(HdRuntime, AMissingLibraryIsSaid) {
  const auto runtime = Runtime::load("/nowhere/libHD.so");
  ASSERT_FALSE(runtime);
  EXPECT_STREQ(runtime.error().error.rule, "R-DEV-3");
  EXPECT_EQ(runtime.error().file, "/nowhere/libHD.so");
  EXPECT_NE(runtime.error().remedy.find("--runtime"), std::string::npos);
}

TEST(HdRuntime, ALibraryWithoutItsFunctionsIsRefused) {
  const auto runtime = Runtime::load("libm.so.6");
  ASSERT_FALSE(runtime);
  EXPECT_STREQ(runtime.error().error.rule, "R-DEV-3");
  EXPECT_EQ(runtime.error().detail, "no function hdInitDevice");
}

}  // namespace
}  // namespace tactus::device::openhaptics
