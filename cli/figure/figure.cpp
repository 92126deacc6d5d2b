// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/figure.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include <tactus/base/shown.h>
#include "cli/commands/commands.h"
#include "cli/report/json.h"

namespace tactus::cli {
namespace {

std::string ending_of(const std::string& path) { return std::filesystem::path(path).extension().string(); }

std::string check_figure_file(const std::string& typed) {
  constexpr std::array<std::string_view, 4> kEndings{".svg", ".png", ".pdf", ".json"};
  const bool is_known = std::ranges::find(kEndings, ending_of(typed)) != kEndings.end();
  return is_known ? "" : shown(typed) + ": give a FILE.svg, .png, .pdf or .json";
}

Json to_json(const Figure& figure) {
  Json out{{"schema", "tactus.figure/1"},
           {"heading", figure.heading},
           {"x", {{"label", figure.x_label}, {"logarithmic", figure.logarithmic_x}}},
           {"panels", Json::array()}};
  for (const Panel& panel : figure.panels) {
    if (panel.lines.empty()) continue;
    Json entry{{"label", panel.label}, {"lines", Json::array()}};
    for (const Panel::Line& line : panel.lines) entry["lines"].push_back({{"name", line.name}, {"points", line.points}});
    if (panel.bound == panel.bound) entry["bound"] = panel.bound;
    out["panels"].push_back(std::move(entry));
  }
  return out;
}

std::string text_of(const Json& document) { return document.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n'; }

}  // namespace

std::string text_of_figure(const Figure& figure) { return text_of(to_json(figure)); }

void add_plot_option(Command& command, std::string& path, const std::string& what) {
  command.add_option("--plot", path, "Also draw " + what + " (SVG, PNG or PDF; JSON: their numbers)")
      ->check(check_figure_file)
      ->type_name("FILE");
}

Outcome check_plot_option(const std::string& path, const CommonOptions& common, const std::vector<std::string>& others) {
  if (path.empty()) return {};
  TACTUS_CHECK(OutputFile::check_free(path, common.existing(), others));
  return ending_of(path) == ".json" ? Outcome() : check_can_draw();
}

Outcome check_can_draw() { return feed_script("plot", {"--check"}, ""); }

Outcome draw(const std::string& path, const Json& figure, OutputFile::Existing existing) {
  const std::string text = text_of(figure);
  if (ending_of(path) == ".json") return write_file(path, text, existing);
  std::vector<std::string> arguments{"-", "--output=" + path};
  if (existing == OutputFile::Existing::replace) arguments.emplace_back("--force");
  return feed_script("plot", arguments, text);
}

Outcome draw(const std::string& path, const Figure& figure, const CommonOptions& common) {
  if (path.empty()) return {};
  const Json document = to_json(figure);
  if (document["panels"].empty())
    return refuse(shown_path(path) + ": there is nothing to draw", "Give a recording with something that moves.");
  return draw(path, document, common.existing());
}

}  // namespace tactus::cli
