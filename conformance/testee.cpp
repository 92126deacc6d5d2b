// SPDX-License-Identifier: Apache-2.0
/// Our decoder behind the testee contract: a stream file or a script on stdin, JSON lines on stdout, exit 0, 1 (rejected) or 2 (usage).
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/binary_streams.h"
#include "conformance/report.h"
#include "conformance/session_report.h"

int main(int argc, char** argv) {
  std::optional<tactus::Interpolation> replica;
  const std::string_view kind = argc == 3 && std::string_view(argv[1]) == "--replica" ? argv[2] : "";
  const bool device = kind == "device";
  if (kind == "none" || device) replica = tactus::Interpolation::none;
  if (kind == "linear") replica = tactus::Interpolation::linear;
  if (kind == "hermite") replica = tactus::Interpolation::hermite;
  if (kind == "blending") replica = tactus::Interpolation::blending;
  if (kind == "playout") replica = tactus::Interpolation::playout;
  const bool session = argc == 2 && std::string_view(argv[1]) == "--session";
  if (argc != 1 && !replica && !session) {
    std::fputs(
        "usage: testee [--replica none|device|linear|hermite|blending|playout] <stream.tct\n       testee --session "
        "<datagrams.script\n",
        stderr);
    return 2;
  }
  std::ios::sync_with_stdio(false);
  tactus::conformance::use_binary_streams();
  if (session) {
    const std::string script{std::istreambuf_iterator<char>(std::cin), {}};
    return tactus::conformance::report_session(script, std::cout) ? 0 : 2;
  }
  const std::vector<char> file{std::istreambuf_iterator<char>(std::cin), {}};
  const auto done =
      tactus::conformance::report({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()}, replica, device, std::cout);
  if (!done) tactus::conformance::report_error(tactus::errc_name(done.error().code), done.error().rule, std::cout);
  return done ? 0 : 1;
}
