// SPDX-License-Identifier: Apache-2.0
#include "conformance/make_vectors/catalogue.h"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

#include "conformance/make_vectors/sha256.h"
#include "conformance/report.h"

namespace tactus::conformance {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kIndexBegin = "<!-- vectors: written by make_vectors -->\n";
constexpr std::string_view kIndexEnd = "<!-- end of vectors -->\n";

bool write_file(const fs::path& path, std::string_view text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  return static_cast<bool>(out.flush());
}

std::string file_name(const Case& c) { return c.id.substr(c.stem.size() + 1); }

std::string json_list(const std::vector<std::string>& texts) {
  std::string out = "[";
  for (const std::string& text : texts) out += (out.size() > 1 ? ", \"" : "\"") + text + "\"";
  return out + "]";
}

std::string case_json(const Case& c) {
  const std::string name = file_name(c);
  std::ostringstream out;
  out << "{\n  \"id\": \"" << c.id << "\",\n  \"stem\": \"" << c.stem << "\",\n  \"rules\": " << json_list(c.rules)
      << ",\n  \"profile\": \"thesis\",\n  \"level\": \"must\",\n  \"flags\": [],\n  \"input\": \"" << name
      << ".tct\",\n  \"sha256\": \"" << sha256_hex(c.input) << "\",\n  \"args\": "
      << json_list(c.replica.empty() ? std::vector<std::string>{} : std::vector<std::string>{"--replica", c.replica})
      << ",\n  \"expect\": {\"class\": \"" << (c.rejection ? "invalid" : "valid") << "\", ";
  if (c.rejection) out << "\"errc\": \"" << c.rejection->errc << "\", \"rule\": \"" << c.rejection->rule << "\", ";
  out << "\"output\": \"" << name << ".jsonl\"},\n  \"what\": \"" << c.what << "\"\n}\n";
  return out.str();
}

struct Answer {
  std::string lines;
  bool as_expected = false;
};

/// What a testee must print: our decoder's lines, but the verdict is the case's own.
Answer answer(const Case& c) {
  std::ostringstream out;
  std::optional<Interpolation> replica;
  if (!c.replica.empty()) replica = c.replica == "none" ? Interpolation::none : Interpolation::linear;
  const auto done = report(c.input, replica, out);
  if (!c.rejection) return {out.str(), done.has_value()};
  report_error(c.rejection->errc.c_str(), c.rejection->rule.c_str(), out);
  return {out.str(), !done && errc_name(done.error().code) == c.rejection->errc && done.error().rule == c.rejection->rule};
}

}  // namespace

void Catalogue::begin(std::string stem) {
  stem_ = std::move(stem);
  number_ = 0;
}

void Catalogue::valid(const std::string& name, const std::string& what, Bytes input, std::vector<std::string> rules,
                      const std::string& replica) {
  add(name, {stem_, "", what, std::move(rules), std::move(input), replica, std::nullopt});
}

void Catalogue::invalid(const std::string& name, const std::string& what, const Rejection& rejection, Bytes input) {
  add(name, {stem_, "", what, {rejection.rule}, std::move(input), "", rejection});
}

void Catalogue::add(const std::string& name, Case entry) {
  const std::string number = std::to_string(1000 + ++number_).substr(1);
  entry.id = entry.stem + '/' + number + '-' + name;
  cases_.push_back(std::move(entry));
}

bool Catalogue::write(const fs::path& folder) const {
  bool good = true;
  std::string manifest = "{\n  \"format\": 1,\n  \"licence\": \"CC0-1.0\",\n  \"cases\": [";
  const char* comma = "\n";
  for (const Case& c : cases_) {
    const fs::path base = folder / "vectors" / c.id;
    fs::create_directories(base.parent_path());
    const Answer expected = answer(c);
    if (!expected.as_expected) std::fprintf(stderr, "%s: our decoder does not answer as expected\n", c.id.c_str());
    if (c.input.size() > 65536) std::fprintf(stderr, "%s: %zu bytes, at most 65536\n", c.id.c_str(), c.input.size());
    good = good && expected.as_expected && c.input.size() <= 65536;
    good = write_file(base.string() + ".tct", {reinterpret_cast<const char*>(c.input.data()), c.input.size()}) && good;
    good = write_file(base.string() + ".json", case_json(c)) && good;
    good = write_file(base.string() + ".jsonl", expected.lines) && good;
    manifest += std::string(comma) + "    \"vectors/" + c.id + ".json\"";
    comma = ",\n";
  }
  return write_file(folder / "manifest.json", manifest + "\n  ]\n}\n") && good;
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
  for (const Case& c : cases_) {
    const std::string verdict = c.rejection ? c.rejection->errc + ' ' + c.rejection->rule : "valid";
    table += "| " + c.id + " | " + verdict + " | " + c.what + " |\n";
  }
  return write_file(file, text.substr(0, begin + kIndexBegin.size()) + table + text.substr(end));
}

}  // namespace tactus::conformance
