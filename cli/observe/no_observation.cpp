// SPDX-License-Identifier: Apache-2.0
/// In place of observation.cpp in a program that was built without the page.
#include "cli/observe/observation.h"

namespace tactus::cli {

tl::expected<std::unique_ptr<Observation>, Failure> Observation::create(const Setup& /*setup*/) {
  return refuse_arguments("--observe: this program was built without the page",
                          "Build it with TACTUS_WITH_VIEW=ON. Its tools: apt-get install " TACTUS_OBSERVE_TOOLS);
}

}  // namespace tactus::cli
