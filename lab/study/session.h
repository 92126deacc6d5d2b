// SPDX-License-Identifier: Apache-2.0
/// What a session makes of a motion over a network: how often what a client shows is over a bound, against the truth of the tick that it
/// shows, and what that costs. Everything but the times is deterministic.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <tactus/metrics/errors.h>
#include <tactus/sender.h>
#include <tactus/sim/link/session_network.h>
#include <tactus/trace/trace_scene.h>

namespace tactus::sim::study {

/// A recorded motion.
struct Motion {
  std::string name;
  TraceInfo info;
  std::vector<TraceFrame> frames;  ///< of ticks 0, 1, 2, ...; shapes only where they are new
  SenderOptions sender{};
  TraceCoding coding{};
};

/// Three bodies that swing by 0.15 m and 34 deg at 0.5 to 1 Hz, without their angular velocity: 1 mm and 1 deg.
Motion swinging_bodies(std::int64_t ticks);

/// Motions of many objects, 1 mm and 1 deg, in session_motions.cpp.   in  seed  of what is drawn
Motion tumbling_boxes(std::int64_t ticks, std::uint64_t seed);   ///< 12 that are thrown up, tumble, bounce and rest
Motion knocked_objects(std::int64_t ticks, std::uint64_t seed);  ///< 25 wander, 75 rest but for knocks
Motion billiard(std::int64_t ticks, std::uint64_t seed);         ///< 16 balls that roll and collide
Motion juggled_clubs(std::int64_t ticks, std::uint64_t seed);    ///< 9 that fly, spin, are caught and thrown again
Motion drawn_sheet(std::int64_t ticks, std::uint64_t seed);      ///< 5041 vertices, into which a finger draws a dent; 0.25 mm

struct SessionCase {
  std::string group, name;  ///< "loss", "10 %"
  LinkOptions link{};       ///< the same there and back, but for the seed
  PlayoutOptions playout{};
  std::uint64_t rate = 0;  ///< [bit/s] at most, down; 0: no limit
  LossPolicy policy = LossPolicy::by_role;
  double limit_of_chain = 0,
         line_of_chain = 0;  ///< the rate at most, or that of the bottleneck, as a multiple of chain_payload()
};

struct SessionResult {
  SessionCase of;
  std::uint64_t ticks = 0,
                over = 0;  ///< judged: all that are shown, without rigid objects those with a new shape; with any bound broken
  std::uint64_t position = 0, rotation = 0, force = 0, shape = 0;  ///< ticks over each bound
  double longest = 0, mean = 0;                                    ///< [s] runs of ticks over a bound
  double behind = 0;                                               ///< [s] the tick shown, on average
  Traffic down{}, up{};
  BoundScaling bound_scaling{};
  double mean_bound_scale = 1;                        ///< over all ticks judged
  double error_median = 0, error_p95 = 0, worst = 0;  ///< largest error of a rigid object in a tick, as a multiple of its bound
  double seconds = 0;
  double recovery = 0;     ///< [s] after the last outage until the client has a state sent after it; 0: there was none
  double server_time = 0;  ///< [s] CPU, median: coding a tick and its datagrams
};

/// err  of SessionNetwork
Result<SessionResult> run_session(const Motion& motion, const SessionCase& one);

/// Payload of packets that build on the one before, over a network that loses nothing [bit/s].   err  of Sender
Result<double> chain_payload(const Motion& motion);

/// Losses, jitter, bursts, delays, playout delays, other disorder, outages.   in  brief  a few of them;  seed  of every network
std::vector<SessionCase> session_cases(bool brief, std::uint64_t seed);

}  // namespace tactus::sim::study
