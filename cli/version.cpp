// SPDX-License-Identifier: Apache-2.0
#include "cli/version.h"

#include <fmt/format.h>

#include <sstream>
#include <vector>

#include "cli/options/options_codec.h"
#include "cli/report/json.h"
#include "commit.h"

namespace tactus::cli {
namespace {

#ifdef __clang__
constexpr const char* kCompiler = "clang " __clang_version__;
#else
constexpr const char* kCompiler = "g++ " __VERSION__;
#endif

std::vector<std::string> words_of(const char* text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

}  // namespace

void print_version(bool as_json) {
  Json out{{"schema", "tactus.version/1"}, {"version", TACTUS_VERSION}};
  if (*TACTUS_COMMIT) out["commit"] = TACTUS_COMMIT;
  out["compiler"] = kCompiler;
  out["build"] = TACTUS_BUILD_TYPE;
  out["components"] = words_of(TACTUS_COMPONENTS);
  out["left_out"] = words_of(TACTUS_LEFT_OUT);
  CommonOptions options;
  options.json = as_json;
  print(out, "version", options);
}

}  // namespace tactus::cli
