// SPDX-License-Identifier: Apache-2.0
#include "cli/live/event_log.h"

#include <cmath>

#include <fmt/format.h>

#include "cli/report/messages.h"

namespace tactus::cli {

void EventLog::write(std::uint64_t now, const char* event, const std::string& text, Json fields) const {
  if (form_ == Form::none) return;
  const double seconds = 1e-6 * static_cast<double>(now - origin_);
  if (form_ == Form::text) {
    fmt::print(stderr, "{:9.3f} s  {}\n", seconds, printable(text));
    return;
  }
  Json line{{"time_s", std::round(1e3 * seconds) / 1e3}, {"event", event}};
  line.update(fields);
  fmt::print(stderr, "{}\n", line.dump());
}

}  // namespace tactus::cli
