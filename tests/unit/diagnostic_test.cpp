// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/diagnostic.h>

#include <gtest/gtest.h>

#include <string>

namespace tactus {
namespace {

TEST(Diagnostic, IsPlaceRuleFaultAndRemedy) {
  const Error error{Errc::invalid, "R-SRF-11", 0};
  const std::string told =
      "R-SRF-11: an edge belongs to a third triangle; remove the surplus element or take the mesh apart there";
  EXPECT_EQ(to_string(Diagnostic{error}), told);
  EXPECT_EQ(place_of(Diagnostic{error}), "");
  const Diagnostic full{
      .error = error, .file = "m.obj", .line = 3, .step = 0, .kind = "triangle", .element = 17, .detail = "'x'"};
  EXPECT_EQ(to_string(full), "m.obj:3: step 0: triangle 17: 'x': " + told);
  EXPECT_EQ(place_of(full), "line 3, step 0, triangle 17, 'x'");
}

TEST(Diagnostic, ItsOwnRemedyGoesBeforeThatOfTheRule) {
  const Error error{Errc::invalid, "R-SRF-11", 0};
  EXPECT_EQ(to_string(Diagnostic{.error = error, .remedy = "Look at it."}),
            "R-SRF-11: an edge belongs to a third triangle; look at it");
  EXPECT_EQ(to_string(Diagnostic{{Errc::invalid, "R-XYZ-1", 0}}), "R-XYZ-1: it breaks a rule that this version does not know");
}

TEST(Diagnostic, WhatComesFromAFileHasNoPower) {
  const Diagnostic evil{.error = {Errc::invalid, "R-SCN-3", 0}, .file = "\x1b[2J", .detail = "a\nb", .remedy = "c\rd"};
  EXPECT_EQ(to_string(evil), "\\x1b[2J: a\\x0ab: R-SCN-3: the key is not known here; c\\x0dd");
}

}  // namespace
}  // namespace tactus
