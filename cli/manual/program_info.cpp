// SPDX-License-Identifier: Apache-2.0
#include "cli/manual/program_info.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>
#include <vector>

#include "cli/report/json_parts.h"

namespace tactus::cli {
namespace {

constexpr std::string_view kCommit =
#include "commit.inc"
    ;

std::string compiler() {
#ifdef __clang__
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
  return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
  return "unknown";
#endif
}

std::vector<std::string> words(const char* text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

}  // namespace

std::string program_info(bool as_json) {
  if (as_json) {
    nlohmann::ordered_json out{{"schema", "tactus.version/1"}, {"version", TACTUS_VERSION}};
    if (!kCommit.empty()) out["commit"] = kCommit;
    out["compiler"] = compiler();
    out["build"] = TACTUS_CONFIG;
    out["components"] = words(TACTUS_BUILT);
    out["left_out"] = words(TACTUS_LEFT_OUT);
    return text_of_json(out);
  }
  std::string out = "tactus " TACTUS_VERSION;
  if (!kCommit.empty()) out += fmt::format("\ncommit      {}", kCommit);
  out += fmt::format("\ncompiler    {}, {}\ncomponents  {}", compiler(), TACTUS_CONFIG, TACTUS_BUILT);
  if (!std::string_view(TACTUS_LEFT_OUT).empty()) out += fmt::format("\nleft out    {}", TACTUS_LEFT_OUT);
  return out;
}

}  // namespace tactus::cli
