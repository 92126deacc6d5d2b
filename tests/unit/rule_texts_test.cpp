// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/rule.h>

#include <map>
#include <set>

#include <tactus/deformable/main_state.h>
#include <tactus/scene/scene_rules.h>

#include "tests/unit/rule_fixture.h"

namespace tactus {
namespace {

using testing::count;
using testing::expect_limits;
using testing::mib;

Error error_of(const std::string& rule) { return {Errc::invalid, rule.c_str(), 0}; }

TEST(Rule, TheLibrarySaysWhatTheTableSays) {
  const auto rows = testing::rule_rows();
  ASSERT_EQ(rows.size(), std::size(detail::kRuleNames));
  std::set<std::string> seen;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const testing::RuleRow& row = rows[i];
    EXPECT_EQ(detail::kRuleNames[i], row.rule);
    EXPECT_TRUE(seen.insert(row.rule).second) << row.rule << " is there twice";
    EXPECT_FALSE(row.text.empty() || row.fault.empty() || row.remedy.empty()) << row.rule;
    EXPECT_EQ(describe(error_of(row.rule)), row.fault) << row.rule;
    EXPECT_EQ(remedy(error_of(row.rule)), row.remedy) << row.rule;
  }
}

TEST(Rule, AdviceIsTheActionOfTheTable) {
  const std::map<std::string, Advice> advices{
      {"-", Advice::none}, {"drop", Advice::drop}, {"request_key", Advice::request_key}, {"close", Advice::close}};
  std::set<Advice> seen;
  for (const testing::RuleRow& row : testing::rule_rows()) {
    EXPECT_EQ(advice(error_of(row.rule)), advices.at(row.action)) << row.rule;
    seen.insert(advice(error_of(row.rule)));
  }
  EXPECT_EQ(seen.size(), advices.size());
}

TEST(Rule, AnUnknownRuleHasWordsToo) {
  for (const char* rule : {"", "R-STR-", "R-STR-0", "R-STR-99", "r-str-1"}) {
    EXPECT_STREQ(describe(error_of(rule)), "it breaks a rule that this version does not know") << rule;
    EXPECT_STREQ(remedy(error_of(rule)), "") << rule;
    EXPECT_EQ(advice(error_of(rule)), Advice::none) << rule;
  }
}

TEST(Rule, NamesOfNoneAreFalse) {
  EXPECT_FALSE(RuleName());
  EXPECT_TRUE(RuleName("R-STR-4"));
  EXPECT_STREQ(fail(Errc::malformed, "R-STR-4", 80).value().rule, "R-STR-4");
  EXPECT_EQ(fail_at({Errc::malformed, "R-STR-4", 80}, 3).value().bit_offset, 3U);
}

TEST(Rule, TheTableNamesTheLimitsOfTheCodec) {
  const DecodeLimits limits;
  expect_limits("R-STR-14", {count(limits.objects) + " objects", count(limits.vertices) + " vertices",
                             count(limits.triangles) + " triangles", mib(limits.header_bytes)});
  expect_limits("R-STR-18", {mib(limits.state_bytes)});
  expect_limits("R-PKT-1", {mib(limits.packet_bytes)});
  expect_limits("R-FIL-4", {mib(limits.packet_bytes)});
  expect_limits("R-DEF-1", {count(kMaxDeformables)});
  expect_limits("R-DEF-4", {count(kMaxMeshVertices) + " vertices", count(kMaxMeshTriangles) + " triangles"});
  expect_limits("R-DEF-7", {count(ModeBasis::kMaxModes) + " modes"});
  expect_limits("R-DEF-10", {count(kMaxHapticIndex)});
  expect_limits("R-API-9", {count(ModeBasis::kMaxModes)});
  expect_limits("R-SRF-14", {count(kMaxMeshVertices) + " vertices", count(kMaxMeshTriangles) + " triangles"});
}

}  // namespace
}  // namespace tactus
