// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/diagnostic.h>

#include <array>
#include <string_view>

#include <tactus/base/shown.h>

namespace tactus {
namespace {

constexpr std::size_t kMostOfDetail = 160;  // a location in our words and pieces of the file
constexpr std::size_t kMostOfRemedy = 400;  // it may repeat what is in the file

/// From the large to the small, without the line; some are empty.
std::array<std::string, 4> parts_of(const Diagnostic& d) {
  const std::uint64_t bit = d.error.bit_offset;
  return {bit == 0 ? "" : "byte " + std::to_string(bit / 8) + (bit % 8 == 0 ? "" : ", bit " + std::to_string(bit % 8)),
          d.step < 0 ? "" : "step " + std::to_string(d.step), d.kind == nullptr ? "" : d.kind + (' ' + std::to_string(d.element)),
          shown(d.detail, kMostOfDetail)};
}

/// A sentence as the end of a line: "Repair the line." is "repair the line".
std::string as_clause(std::string_view sentence) {
  if (sentence.ends_with('.')) sentence.remove_suffix(1);
  std::string out = shown(sentence, kMostOfRemedy);
  if (!out.empty() && out[0] >= 'A' && out[0] <= 'Z') out[0] = static_cast<char>(out[0] - 'A' + 'a');
  return out;
}

}  // namespace

std::string location_of(const Diagnostic& diagnostic) {
  std::string out = diagnostic.line > 0 ? "line " + std::to_string(diagnostic.line) : "";
  for (const std::string& part : parts_of(diagnostic))
    if (!part.empty()) out += (out.empty() ? "" : ", ") + part;
  return out;
}

std::string to_string(const Diagnostic& diagnostic) {
  std::string file = shown_path(diagnostic.file);
  if (diagnostic.line > 0) file += ':' + std::to_string(diagnostic.line);
  std::string out = file.empty() ? "" : file + ": ";
  for (const std::string& part : parts_of(diagnostic)) {
    if (part.empty()) continue;
    if (part.starts_with(out)) out.clear();  // a system's text may begin with the file
    out += part;
    out += ": ";
  }
  out += diagnostic.error.rule + std::string(": ") +
         (diagnostic.cause.empty() ? describe(diagnostic.error) : shown(diagnostic.cause, kMostOfRemedy));
  const std::string fix = as_clause(diagnostic.remedy.empty() ? remedy(diagnostic.error) : diagnostic.remedy);
  return fix.empty() ? out : out + "; " + fix;
}

}  // namespace tactus
