// SPDX-License-Identifier: Apache-2.0
/// The rows of studies as a table, as CSV, JSON and Markdown.
#pragma once

#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "lab/study/study.h"

namespace tactus::cli {

void print_table(std::span<const sim::study::Study> studies, std::FILE* out);
/// One line per row: study, subject, parameters ("N=10; k_o=100 N/m"), verdict, quantity, measured, analytic, unit, deviation, remark.
std::string to_csv(std::span<const sim::study::Study> studies);
/// Schema "tactus.stability/1".
std::string to_json(std::span<const sim::study::Study> studies, sim::study::Extent extent);

/// SVG files of this name, without their ends. Those of a study begin with its name.
struct Picture {
  std::string name, caption;
};
/// A section per study: text, plots and table.
std::string to_markdown(std::span<const sim::study::Study> studies, std::span<const Picture> pictures, sim::study::Extent extent);

}  // namespace tactus::cli
