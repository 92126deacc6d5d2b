// SPDX-License-Identifier: Apache-2.0
/// How long a client takes to join over a line, and what that does to another client on the same line: sessions in virtual time.
#pragma once

#include <cstdint>

#include <tactus/base/result.h>

namespace tactus::sim::study {

struct JoinCase {
  std::uint32_t side = 316;          ///< vertices of a square sheet: 316 make a declaration of 1.3 MB
  std::int64_t round_trip = 40'000;  ///< [us]
  double rate = 10e6;                ///< [bit/s] of the bottleneck that both clients share, headers included
  double loss = 0;                   ///< fraction of datagrams, each way
  std::int64_t jitter = 0;           ///< [us] of every datagram, uniform within 0 and this
  std::int64_t queue = 100'000;      ///< [us] that the bottleneck holds
  std::uint64_t limit = 0;           ///< [bit/s] that the server's user states for each client; 0: none
  bool sealed = false;  ///< addresses are validated, and datagrams as long as sealed ones; the seal's handshake is not counted
  std::uint64_t seed = 1;
};

struct JoinResult {
  std::uint64_t declaration = 0;  ///< [bytes]
  double live = 0;                ///< [s] from the join until the client holds the declaration; 0: not after ten minutes
  double sent = 0;                ///< datagrams that the server sent for it, over those that it takes
  double longest_silence = 0;     ///< [s] without progress that the client could show
  double waits = 0, worst = 0;    ///< [s] longer than the fastest that datagrams to the live client took: 99 % of them, and all
  double lost = 0;                ///< fraction of them that the bottleneck dropped
};

/// err  of SessionServer::create, SessionClient::create, Link::create
Result<JoinResult> run_join(const JoinCase& of);

}  // namespace tactus::sim::study
