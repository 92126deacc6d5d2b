// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/shared_library.h>

#include <gtest/gtest.h>

namespace tactus::device {
namespace {

TEST(SharedLibrary, FindsFunctionsAndNamesTheFirstThatIsMissing) {
  auto library = SharedLibrary::load("libm.so.6");
  ASSERT_TRUE(library) << library.error();
  double (*root)(double) = nullptr;
  library->find("sqrt", root);
  ASSERT_NE(root, nullptr);
  EXPECT_EQ(root(9), 3);
  EXPECT_EQ(library->missing(), nullptr);
  void (*none)() = nullptr;
  library->find("no_such_function", none);
  library->find("nor_this_one", none);
  EXPECT_EQ(none, nullptr);
  EXPECT_STREQ(library->missing(), "no_such_function");
}

TEST(SharedLibrary, TellsWhyItCannotBeLoaded) {
  const auto library = SharedLibrary::load("libno-such-library.so.0");
  ASSERT_FALSE(library);
  EXPECT_NE(library.error().find("libno-such-library.so.0"), std::string::npos) << library.error();
}

}  // namespace
}  // namespace tactus::device
