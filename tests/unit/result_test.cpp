// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/result.h>

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace tactus {
namespace {

TEST(Result, EveryErrorClassHasANameOfItsOwn) {
  std::set<std::string> names;
  for (const int value : {2, 3, 4, 5, 6, 7, 8, 10, 11, 12}) names.insert(errc_name(static_cast<Errc>(value)));
  EXPECT_EQ(names.size(), 10u);
  for (const int withdrawn : {1, 9}) EXPECT_STREQ(errc_name(static_cast<Errc>(withdrawn)), "unknown");
  EXPECT_TRUE(names.contains("malformed") && names.contains("limit_exceeded"));
}

TEST(Result, AdviceFollowsFromClassAndRule) {
  EXPECT_EQ(advice({Errc::malformed, "R-RIG-1"}), Advice::drop);
  EXPECT_EQ(advice({Errc::state, "R-PKT-4"}), Advice::request_key);
  EXPECT_EQ(advice({Errc::state, "R-PKT-5"}), Advice::drop);
  EXPECT_EQ(advice({Errc::unsupported, "R-DEF-2"}), Advice::close);
  EXPECT_EQ(advice({Errc::limit_exceeded, "R-PKT-1"}), Advice::drop);
  EXPECT_EQ(advice({Errc::limit_exceeded, "R-DEF-4"}), Advice::close);
}

}  // namespace
}  // namespace tactus
