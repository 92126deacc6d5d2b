// SPDX-License-Identifier: Apache-2.0
#include "conformance/make_vectors/catalogue.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

#include "conformance/make_vectors/features.h"
#include "conformance/make_vectors/sha256.h"
#include "conformance/report.h"
#include "conformance/session_report.h"

namespace tactus::conformance {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = 65536;
constexpr std::string_view kIndexBegin = "<!-- vectors: written by make_vectors -->\n";
constexpr std::string_view kIndexEnd = "<!-- end of vectors -->\n";

bool write_file(const fs::path& path, std::string_view text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  return static_cast<bool>(out.flush());
}

std::string hex(const Bytes& bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    out += "0123456789abcdef"[byte >> 4];
    out += "0123456789abcdef"[byte & 15];
  }
  return out;
}

std::string_view as_text(const Bytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

std::string sha256_of(std::string_view text) {
  return sha256_hex(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

template <class Texts>
std::string json_list(const Texts& texts) {
  std::string out = "[";
  for (const std::string& text : texts) out += (out.size() > 1 ? ", \"" : "\"") + text + "\"";
  return out + "]";
}

/// What the case checks: the rule that it breaks, and one that it breaks further on; or rules that it keeps.
std::vector<std::string> checked_rules(const Case& c) {
  if (!c.rejection) return c.rules;
  std::vector<std::string> out{c.rejection->rule};
  if (!c.rejection->later.empty() && c.rejection->later != c.rejection->rule) out.push_back(c.rejection->later);
  return out;
}

std::string case_json(const Case& c, std::string_view answer) {
  Features f = c.session ? Features{} : features(c.input.bytes, answer);
  if (c.session) f.flags.insert("session");
  if (c.rejection && !c.rejection->later.empty()) f.flags.insert("order");
  if (!c.replica.empty()) f.flags.insert("client");
  if (c.input.repeat) f.flags.insert("large");
  std::vector<std::string> flags;
  for (const Flag& flag : all_flags())
    if (f.flags.contains(flag.name)) flags.emplace_back(flag.name);
  const std::vector<std::string> rules = checked_rules(c);

  std::ostringstream out;
  out << "    {\"name\": \"" << c.name << "\", \"result\": ";
  if (c.rejection) out << "\"invalid\", \"errc\": \"" << c.rejection->errc << "\", \"rule\": \"" << c.rejection->rule << '"';
  else out << "\"valid\", \"section\": \"" << c.section << '"';
  if (!rules.empty()) out << ", \"rules\": " << json_list(rules);
  out << ",\n     \"profile\": " << json_list(f.profiles) << ", \"flags\": " << json_list(flags);
  if (!c.replica.empty()) out << ", \"args\": [\"--replica\", \"" << c.replica << "\"]";
  if (c.session) out << ", \"args\": [\"--session\"]";
  if (c.input.repeat)
    out << ", \"repeat\": {\"at\": " << c.input.repeat->at << ", \"bytes\": \"" << hex(c.input.repeat->pattern)
        << "\", \"times\": " << c.input.repeat->times << '}';
  out << ",\n     \"sha256\": \"" << sha256_hex(c.input.bytes) << "\",\n     \"what\": \"" << c.what << "\"}";
  return out.str();
}

struct Answer {
  std::string lines;
  bool as_expected = false;
};

/// What a testee must print: our decoder's lines, but the verdict is the case's own.
Answer answer(const Case& c) {
  std::ostringstream out;
  if (c.session) {
    const bool read = report_session(std::string(as_text(c.input.bytes)), out);
    return {out.str(), read};
  }
  std::optional<Interpolation> replica;
  if (c.replica == "none" || c.replica == "device") replica = Interpolation::none;
  if (c.replica == "linear") replica = Interpolation::linear;
  if (c.replica == "hermite") replica = Interpolation::hermite;
  if (c.replica == "blending") replica = Interpolation::blending;
  if (c.replica == "playout") replica = Interpolation::playout;
  const auto done = report(c.input.bytes, replica, c.replica == "device", out);
  if (!c.rejection) return {out.str(), done.has_value()};
  report_error(c.rejection->errc.c_str(), c.rejection->rule.c_str(), out);
  return {out.str(), !done && errc_name(done.error().code) == c.rejection->errc && done.error().rule == c.rejection->rule};
}

const char* suffix_of(const Case& c) { return c.session ? ".script" : ".tct"; }

/// Write both files of a case.
bool write_case(const Case& c, const Answer& expected, const fs::path& folder) {
  const std::string base = (folder / c.name).string();
  if (!expected.as_expected) std::fprintf(stderr, "%s: our decoder does not answer as expected\n", base.c_str());
  const Bytes stored = c.input.written();
  if (stored.size() > kLargestFile)
    std::fprintf(stderr, "%s: %zu bytes, at most %zu\n", base.c_str(), stored.size(), kLargestFile);
  const bool written = write_file(base + suffix_of(c), as_text(stored)) && write_file(base + ".jsonl", expected.lines);
  return written && expected.as_expected && stored.size() <= kLargestFile;
}

}  // namespace

Bytes Input::written() const {
  if (!repeat) return bytes;
  Bytes out = first(bytes, repeat->at);
  const std::size_t end = repeat->at + repeat->pattern.size() * repeat->times;
  out.insert(out.end(), bytes.begin() + static_cast<std::ptrdiff_t>(end), bytes.end());
  return out;
}

void Catalogue::begin(const std::string& stem, const std::string& what) { stems_.push_back({stem, what, {}}); }

void Catalogue::valid(const std::string& name, const std::string& what, Input input, std::vector<std::string> rules,
                      const std::string& replica) {
  add(name, {"", what, section_, std::move(rules), std::move(input), replica, std::nullopt, false});
}

void Catalogue::invalid(const std::string& name, const std::string& what, const Rejection& rejection, Input input) {
  add(name, {"", what, "", {}, std::move(input), "", rejection, false});
}

void Catalogue::session(const std::string& name, const std::string& what, Input script, std::vector<std::string> rules) {
  add(name, {"", what, section_, std::move(rules), std::move(script), "", std::nullopt, true});
}

void Catalogue::add(const std::string& name, Case entry) {
  std::vector<Case>& cases = stems_.back().cases;
  entry.name = std::to_string(1001 + cases.size()).substr(1) + '-' + name;
  cases.push_back(std::move(entry));
}

bool Catalogue::write(const fs::path& folder) const {
  bool good = true;
  std::string manifest = "{\n  \"format\": 2,\n  \"licence\": \"CC0-1.0\",\n  \"stems\": {";
  const char* comma = "\n";
  for (const Stem& stem : stems_) {
    const fs::path own = folder / "vectors" / stem.name;
    fs::create_directories(own);
    std::string list =
        "{\n  \"format\": 2,\n  \"stem\": \"" + stem.name + "\",\n  \"what\": \"" + stem.what + "\",\n  \"cases\": [";
    for (const Case& c : stem.cases) {
      const Answer expected = answer(c);
      good = write_case(c, expected, own) && good;
      list += (&c == stem.cases.data() ? "\n" : ",\n") + case_json(c, expected.lines);
    }
    list += "\n  ]\n}\n";
    good = write_file(own.string() + ".json", list) && good;
    manifest += std::string(comma) + "    \"" + stem.name + "\": {\"cases\": " + std::to_string(stem.cases.size()) +
                ", \"sha256\": \"" + sha256_of(list) + "\"}";
    comma = ",\n";
  }
  manifest += "\n  },\n  \"flags\": {";
  comma = "\n";
  for (const Flag& flag : all_flags()) {
    manifest += std::string(comma) + "    \"" + flag.name + "\": \"" + flag.meaning + '"';
    comma = ",\n";
  }
  return write_file(folder / "manifest.json", manifest + "\n  }\n}\n") && good;
}

bool Catalogue::write_index(const fs::path& file) const {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t begin = text.find(kIndexBegin), end = text.find(kIndexEnd);
  if (begin == std::string::npos || end == std::string::npos) {
    std::fprintf(stderr, "%s: no marks around the table of vectors\n", file.c_str());
    return false;
  }
  std::string table = "| vector | answer | what |\n|---|---|---|\n";
  for (const Stem& stem : stems_) {
    for (const Case& c : stem.cases) {
      const std::string verdict = c.rejection ? c.rejection->errc + ' ' + c.rejection->rule : "valid";
      table += "| " + stem.name + '/' + c.name + " | " + verdict + " | " + c.what + " |\n";
    }
  }
  return write_file(file, text.substr(0, begin + kIndexBegin.size()) + table + text.substr(end));
}

}  // namespace tactus::conformance
