// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/session_options.h>

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

namespace tactus {
namespace {

using State = SessionState;
using Event = SessionEvent;
using enum SessionState;
using enum SessionEvent;

constexpr State kStates[] = {closed, joining, receiving, live};
constexpr Event kEvents[] = {open, welcomed, refused, completed, replaced, rejected, left, silent, close};

/// A state by its first letter, for each event in the order of kEvents; '.' where nothing happens.
void expect_table(std::span<const SessionTransition> table, const std::string (&rows)[4]) {
  const std::string letters = "cjrl";
  for (std::size_t s = 0; s < 4; ++s) {
    for (std::size_t e = 0; e < std::size(kEvents); ++e) {
      const auto next = next_state(table, kStates[s], kEvents[e]);
      EXPECT_EQ(next ? letters[static_cast<std::size_t>(*next)] : '.', rows[s][e]) << "state " << s << ", event " << e;
    }
  }
}

//                                                      open, welcomed, refused, completed, replaced, rejected, left, silent, close
TEST(SessionState, OfAClient) { expect_table(client_transitions(), {"j........", ".rc....cc", ".r.l.cccc", ".r....ccc"}); }
TEST(SessionState, OfAClientAtTheServer) {
  expect_table(server_transitions(), {"r........", ".........", "...lr.ccc", "....r.ccc"});
}

TEST(SessionState, NoPairOccursTwice) {
  for (const auto table : {client_transitions(), server_transitions()}) {
    std::set<std::pair<State, Event>> seen;
    for (const SessionTransition& t : table) EXPECT_TRUE(seen.emplace(t.from, t.event).second);
  }
}

TEST(SessionState, OnlyOpenLeavesClosedAndEveryOtherStateCanBeClosed) {
  for (const auto table : {client_transitions(), server_transitions()}) {
    std::set<State> reached{closed};
    for (const SessionTransition& t : table) {
      EXPECT_EQ(t.from == closed, t.event == open);
      reached.insert(t.to);
    }
    for (const State state : reached) {
      if (state == closed) continue;
      EXPECT_EQ(next_state(table, state, close), closed);
      EXPECT_EQ(next_state(table, state, silent), closed);
    }
    EXPECT_TRUE(reached.contains(live));
  }
}

}  // namespace
}  // namespace tactus
