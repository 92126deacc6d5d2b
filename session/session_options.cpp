// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/session_options.h>

namespace tactus {

namespace {

using enum SessionState;
using Event = SessionEvent;

constexpr SessionTransition kClient[] = {
    {closed, Event::open, joining},  //
    {joining, Event::welcomed, receiving},   {joining, Event::refused, closed},
    {joining, Event::silent, closed},        {joining, Event::close, closed},  //
    {receiving, Event::welcomed, receiving}, {receiving, Event::completed, live},
    {receiving, Event::rejected, closed},    {receiving, Event::left, closed},
    {receiving, Event::silent, closed},      {receiving, Event::close, closed},
    {live, Event::welcomed, receiving},      {live, Event::left, closed},
    {live, Event::silent, closed},           {live, Event::close, closed},
};

constexpr SessionTransition kServer[] = {
    {closed, Event::open, receiving},  //
    {receiving, Event::completed, live}, {receiving, Event::replaced, receiving},
    {receiving, Event::left, closed},    {receiving, Event::silent, closed},
    {receiving, Event::close, closed},  //
    {live, Event::replaced, receiving},  {live, Event::left, closed},
    {live, Event::silent, closed},       {live, Event::close, closed},
};

}  // namespace

std::span<const SessionTransition> client_transitions() noexcept { return kClient; }
std::span<const SessionTransition> server_transitions() noexcept { return kServer; }

std::optional<SessionState> next_state(std::span<const SessionTransition> table, SessionState state,
                                       SessionEvent event) noexcept {
  for (const SessionTransition& t : table)
    if (t.from == state && t.event == event) return t.to;
  return std::nullopt;
}

}  // namespace tactus
