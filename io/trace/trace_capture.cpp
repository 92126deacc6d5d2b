// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_capture.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <tactus/base/text.h>

namespace tactus {
namespace {

constexpr const char* kStarted = "started_ns";
constexpr std::array<std::pair<const char*, std::string TraceCapture::*>, 5> kTexts{{{"device", &TraceCapture::device},
                                                                                     {"backend", &TraceCapture::backend},
                                                                                     {"scheduling", &TraceCapture::scheduling},
                                                                                     {"subject", &TraceCapture::subject},
                                                                                     {"remarks", &TraceCapture::remarks}}};

}  // namespace

mcap::TextMap entries_of(const TraceCapture& capture) {
  mcap::TextMap entries{{kStarted, std::to_string(capture.started)}};
  for (const auto& [key, text] : kTexts) entries.emplace(key, capture.*text);
  return entries;
}

std::optional<TraceCapture> capture_from(const mcap::TextMap& entries) {
  TraceCapture capture;
  const auto started = entries.find(kStarted);
  const auto time = started == entries.end() ? std::nullopt : parse_number<std::int64_t>(started->second);
  if (!time) return std::nullopt;
  capture.started = *time;
  for (const auto& [key, text] : kTexts) {
    const auto found = entries.find(key);
    if (found == entries.end()) return std::nullopt;
    capture.*text = found->second;
  }
  return is_valid(capture) ? std::optional(std::move(capture)) : std::nullopt;
}

bool is_valid(const TraceCapture& capture) noexcept {
  return capture.started >= 0 && std::ranges::all_of(kTexts, [&](const auto& text) { return is_utf8(capture.*text.second); });
}

}  // namespace tactus
