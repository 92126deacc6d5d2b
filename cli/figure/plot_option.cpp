// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/plot_option.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include <tactus/base/shown.h>

namespace tactus::cli {

Check svg_file() {
  return [](const std::string& typed) {
    const std::filesystem::path path(typed);
    return path.extension() == ".svg" && !path.stem().empty() ? "" : shown(typed) + ": give a FILE.svg";
  };
}

void add_plot_option(Command& command, std::string& path, const std::string& what) {
  command.add_option("--plot", path, "Also draw " + what)->check(svg_file())->type_name("FILE.svg");
}

Outcome check_plot_option(const std::string& path, const CommonOptions& common, const std::vector<std::string>& others) {
  return path.empty() ? Outcome() : OutputFile::check_free(path, common.existing(), others);
}

Outcome draw_at(const std::string& path, Plot plot, const CommonOptions& common) {
  const std::filesystem::path file(path);
  plot.name = file.stem().string();
  TACTUS_TRY(const auto drawn, draw(plot, file.has_parent_path() ? file.parent_path().string() : ".", common.existing()));
  if (drawn == Drawn::no) fmt::print(stderr, "note: {}\n", kNoGnuplot);
  return {};
}

}  // namespace tactus::cli
