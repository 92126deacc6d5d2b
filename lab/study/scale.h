// SPDX-License-Identifier: Apache-2.0
/// What a server of many clients and objects costs: sessions in virtual time, each client some milliseconds off, of which only the server's
/// calls are timed.
#pragma once

#include <cstdint>

#include <tactus/base/result.h>
#include <tactus/session/session_options.h>

namespace tactus::sim::study {

struct ScaleCase {
  std::uint16_t clients = 64;
  std::uint32_t objects = 1000, moving = 10;  ///< of the objects
  std::int64_t ticks = 1000;                  ///< that are measured, after two seconds
  std::uint64_t seed = 1;
  double loss = 0;               ///< fraction of datagrams, each way
  std::uint64_t delay = 10'000;  ///< [us]
  Role role = Role::observer;
  bool names_moved = false;  ///< the server is given the objects that have moved
  bool spread =
      false;         ///< objects are 1 m apart instead of 0.1 m, those that move are all over them, and clients walk among them
  double reach = 0;  ///< [m] of the clients' interest, in full up to 1 m; 0: they are sent all objects
};

struct ScaleResult {
  double mean = 0, median = 0, worst = 0;  ///< [s] of CPU of the server in a tick: all that came, submit(), all that goes
  double submit = 0;                       ///< [s] of it, mean
  double join = 0, worst_join = 0;         ///< [s] of the call that takes a join, or that brings a client live: median and worst
  double work = 0, worst_work = 0;         ///< [s] of what is made elsewhere for that: SessionServer::Work::run()
  double memory = 0;                       ///< [bytes] that the process has more than before the first client, for each of them
  double server_memory = 0;                ///< [bytes] the same while only the server has its end of the sessions
  double datagrams = 0, bytes = 0;         ///< down, per client and tick
  std::uint64_t live = 0;                  ///< clients at the end
};

/// err  of SessionServer::create, SessionServer::submit
Result<ScaleResult> run_scale(const ScaleCase& of);

}  // namespace tactus::sim::study
