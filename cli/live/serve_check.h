// SPDX-License-Identifier: Apache-2.0
/// What `serve` would do, found without a network: a client joins in virtual time, and memory is counted.
#pragma once

#include <cstddef>
#include <string>

#include <tactus/session/session_server.h>
#include <tactus/sim/server.h>
#include <tactus/thesis/if_built.h>
#include "cli/report/messages.h"

namespace tactus::cli {

struct Value;

struct ServePlan {
  std::string scene{}, listen{};  ///< as typed; an address
  SessionServerOptions settings{};
  DecodeLimits limits{.thesis = thesis_if_built()};  ///< of the client that tries
  bool is_sealed = false;
  std::size_t room = 0, wanted_room = 0;  ///< [bytes] for datagrams that wait
};

/// "tactus.serve_check/1".   err  no client with these limits can join
tl::expected<Value, Failure> check_plan(const ServePlan& plan, sim::Server& world);

}  // namespace tactus::cli
