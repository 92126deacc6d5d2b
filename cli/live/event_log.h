// SPDX-License-Identifier: Apache-2.0
/// What happens in a session, a line for each event on standard error: for a person, or as JSON for a program.
#pragma once

#include <cstdint>
#include <string>

#include "cli/report/json.h"

namespace tactus::cli {

class EventLog {
 public:
  enum class Form : std::uint8_t { none, text, json };
  /// in   origin  [us] of the times in the lines
  EventLog(Form form, std::uint64_t origin) noexcept : form_(form), origin_(origin) {}

  /// "   12.345 s  TEXT", or {"time_s": 12.345, "event": EVENT, fields}.   in  event  one word
  void write(std::uint64_t now, const char* event, const std::string& text, Json fields = Json::object()) const;

 private:
  Form form_;
  std::uint64_t origin_;
};

}  // namespace tactus::cli
