// SPDX-License-Identifier: Apache-2.0
#include "cli/viewer/columns.h"
#include "cli/viewer/page.h"

#include <gtest/gtest.h>

#include <sstream>

#include <tactus/receiver.h>

namespace tactus::cli {
namespace {

TEST(Viewer, Base64IsThatOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string_view("\xff\x00\x80", 3)), "/wCA");
}

TEST(Viewer, AColumnCodesDifferencesAndRunsOfZeros) {
  Column column(0.5);
  for (const std::int64_t value : {0, 0, 0, 1, -1, -1, 200}) column.add(value);
  const auto json = column.take();
  EXPECT_EQ(json["count"], 7);
  EXPECT_EQ(json["step"], 0.5);
  // Three zeros; +1, -2; one zero; +201 in two bytes.
  EXPECT_EQ(json["data"], base64(std::string_view("\x00\x02\x02\x03\x00\x00\x92\x03", 8)));
  column.add(1);  // begun anew
  EXPECT_EQ(column.take()["data"], base64("\x02"));
}

TEST(Viewer, AColumnOfRealsRoundsToItsStepAndStaysInRange) {
  Column column(1e-3);
  column.add_real(0.0124);
  column.add_real(1e300);
  column.add_real(-1e300);
  EXPECT_EQ(column.size(), 3u);
  EXPECT_GT(column.bytes(), 15u);  // two differences of 2^52 and more
}

TEST(Viewer, NoNameEndsTheElementThatHoldsTheData) {
  const std::string text = page_json({{"name", "</script><script>alert(1)</script><!--&"}, {"broken", "\xff"}});
  EXPECT_EQ(text.find_first_of("<>&"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(text)["name"], "</script><script>alert(1)</script><!--&");
}

TEST(Viewer, ThePageHasItsDataWhereItBelongs) {
  std::ostringstream out;
  write_page(out, "{}");
  const std::string page = out.str();
  EXPECT_EQ(page.find("<!--tactus-data-->"), std::string::npos);
  const std::size_t data = page.find("<script id=\"tactus-data\" type=\"application/json\">{}</script>");
  ASSERT_NE(data, std::string::npos);
  EXPECT_LT(data, page.find("<script type=\"module\">"));
  EXPECT_NE(page.find("http-equiv=\"Content-Security-Policy\""), std::string::npos);
  EXPECT_EQ(page.find("@SCRIPT"), std::string::npos);
  EXPECT_EQ(page.find("@STYLE"), std::string::npos);
}

TEST(Viewer, TheGhostIsWithinATwentiethOfTheBounds) {
  const auto scene = SceneBuilder().rigid("cube").declare_bounds({.visual_position = 2e-3, .visual_rotation = 0.1}, {}).build();
  ASSERT_TRUE(scene);
  const GhostBounds ghost = ghost_bounds(**scene);
  EXPECT_DOUBLE_EQ(ghost.rigid.visual_position, 1e-4);
  EXPECT_DOUBLE_EQ(ghost.rigid.visual_rotation, 5e-3);
  EXPECT_EQ(ghost.rigid.haptic, HapticRule::off);
  EXPECT_DOUBLE_EQ(ghost.deformable.visual, 1.5e-5);
  const auto fine = SceneBuilder().rigid("cube").declare_bounds({.visual_position = 1e-5, .visual_rotation = 1e-4}, {}).build();
  ASSERT_TRUE(fine);
  EXPECT_GE(ghost_bounds(**fine).rigid.visual_position, 4e-6);  // the grid can hold it
}

/// What the page is sent of a user to whom nothing is rendered while the server renders so much.
nlohmann::ordered_json user_of(RecordedForces known, double server) {
  TraceInfo info{.objects = {{"cube"}}, .users = {{.name = "hand", .forces = known}}, .source = {}, .scene = {}};
  TraceFrame frame{.objects = {{}}, .users = {{}}};
  frame.users[0].server_force = {0, 0, server};
  const auto scene = SceneBuilder().rigid("cube").build();
  auto receiver = Receiver::create(*scene);
  auto truth = TruthData::create(info, frame, **scene);
  EXPECT_TRUE(truth && truth->add(frame, receiver->replica()));
  return truth->take()["users"][0];
}

TEST(Viewer, ThePageIsSentWhichForcesAreKnown) {
  EXPECT_EQ(user_of(RecordedForces::both, 0)["knows"], "both");
  EXPECT_FALSE(user_of(RecordedForces::both, 0).contains("rendered"));
  EXPECT_TRUE(user_of(RecordedForces::both, 1).contains("rendered"));
  EXPECT_EQ(user_of(RecordedForces::server, 1)["knows"], "server");
  EXPECT_FALSE(user_of(RecordedForces::server, 1).contains("rendered"));
  EXPECT_TRUE(user_of(RecordedForces::server, 1).contains("server"));
  EXPECT_EQ(user_of(RecordedForces::rendered, 0)["knows"], "rendered");
  EXPECT_FALSE(user_of(RecordedForces::rendered, 0).contains("server"));
  EXPECT_TRUE(user_of(RecordedForces::rendered, 0).contains("rendered"));
}

}  // namespace
}  // namespace tactus::cli
