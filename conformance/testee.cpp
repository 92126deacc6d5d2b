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

namespace {

constexpr const char* kUsage =
    "usage: testee [--without thesis] [--replica none|device|linear|hermite|blending|playout] <stream.tct\n"
    "       testee [--without thesis] --session <datagrams.script\n";

std::optional<tactus::Interpolation> client_of(std::string_view kind) {
  using tactus::Interpolation;
  if (kind == "none" || kind == "device") return Interpolation::none;
  if (kind == "linear") return Interpolation::linear;
  if (kind == "hermite") return Interpolation::hermite;
  if (kind == "blending") return Interpolation::blending;
  if (kind == "playout") return Interpolation::playout;
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  tactus::conformance::TesteeOptions options;
  std::vector<std::string_view> words(argv + 1, argv + argc);
  if (words.size() >= 2 && words[0] == "--without" && words[1] == "thesis") {
    options.thesis = nullptr;
    words.erase(words.begin(), words.begin() + 2);
  }
  if (words.size() == 2 && words[0] == "--replica") {
    options.replica = client_of(words[1]);
    options.device = words[1] == "device";
  }
  const bool session = words.size() == 1 && words[0] == "--session";
  if (!words.empty() && !options.replica && !session) {
    std::fputs(kUsage, stderr);
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
      tactus::conformance::report({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()}, options, std::cout);
  if (!done) tactus::conformance::report_error(tactus::errc_name(done.error().code), done.error().rule, std::cout);
  return done ? 0 : 1;
}
