// SPDX-License-Identifier: Apache-2.0
/// Our profiles beside codecs made by others, all vertices of every frame, on one grid, one packet per frame.
///   peers_bench [--bits N] [--grid rest|frames] [--frames N] [--csv FILE] INPUT...      INPUT as in animation.h
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <map>
#include <string_view>

#include "tests/bench/peers/measure.h"

namespace {

using namespace tactus::peers;

struct Options {
  GridBox box = GridBox::rest;
  unsigned bits = 10;
  std::size_t frames = 2000;
  std::string csv;
  std::vector<std::string> inputs;
};

struct Row {
  std::string data;
  std::size_t vertices = 0, frames = 0;
  const Scheme* scheme = nullptr;
  std::optional<Measurement> result;
};

int usage() {
  std::fputs("usage: peers_bench [--bits N] [--grid rest|frames] [--frames N] [--csv FILE] INPUT...\n", stderr);
  return 2;
}

bool parse(int argc, char** argv, Options& out) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (!name.starts_with("--")) {
      out.inputs.emplace_back(name);
      continue;
    }
    if (++i == argc) return false;
    const std::string_view value = argv[i];
    const auto number = [value](auto& into) {
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), into);
      return error == std::errc{} && end == value.data() + value.size();
    };
    if (name == "--csv") out.csv = value;
    else if (name == "--grid" && (value == "rest" || value == "frames"))
      out.box = value == "rest" ? GridBox::rest : GridBox::frames;
    else if (name == "--bits" ? !number(out.bits) || out.bits > 16 : name != "--frames" || !number(out.frames)) return false;
  }
  return !out.inputs.empty();
}

std::string survives(const Measurement& m) { return !m.survives ? "-" : *m.survives ? "yes" : "no"; }

/// Of every codec, plain and predicted, the setting with the fewest bytes.
void print_table(const std::vector<Row>& rows) {
  std::map<std::pair<std::string, bool>, const Row*> best;
  std::vector<const Row*> order;
  for (const Row& row : rows) {
    const Row*& kept = best[{row.scheme->name, row.scheme->predicted}];
    if (kept == nullptr || (row.result && (!kept->result || row.result->bytes < kept->result->bytes))) kept = &row;
  }
  for (const auto& [key, row] : best) order.push_back(row);
  std::ranges::sort(order, [](const Row* a, const Row* b) {
    if (a->result.has_value() != b->result.has_value()) return a->result.has_value();
    return a->result && a->result->bytes < b->result->bytes;
  });
  std::printf("\n%s, %zu vertices, %zu frames\n", rows[0].data.c_str(), rows[0].vertices, rows[0].frames);
  std::printf("  %-33s %-10s %-17s %9s %9s %10s %10s %6s %9s\n", "codec", "values", "setting", "B/packet", "bits/v", "encode us",
              "decode us", "error", "survives");
  for (const Row* row : order) {
    const Scheme& s = *row->scheme;
    std::printf("  %-33s %-10s %-17s ", s.name.c_str(), s.predicted ? "predicted" : "plain", s.setting.c_str());
    if (!row->result) std::puts("cannot carry this mesh");
    else
      std::printf("%9.1f %9.3f %10.1f %10.1f %6.3f %7.3f %9s\n", row->result->bytes, row->result->bits_per_vertex,
                  row->result->encode_us, row->result->decode_us, row->result->error, row->result->kg_percent,
                  survives(*row->result).c_str());
  }
}

void write_csv(std::ofstream& out, const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    out << row.data << ',' << row.vertices << ',' << row.frames << ",\"" << row.scheme->name << "\"," << row.scheme->setting
        << ',' << (row.scheme->predicted ? "predicted" : "plain");
    if (row.result)
      out << ',' << row.result->bytes << ',' << row.result->bits_per_vertex << ',' << row.result->encode_us << ','
          << row.result->decode_us << ',' << row.result->error << ',' << row.result->kg_percent << ',' << survives(*row.result)
          << '\n';
    else out << ",,,,,,,\n";
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, options)) return usage();
  std::ofstream csv;
  if (!options.csv.empty()) {
    csv.open(options.csv);
    csv << "data,vertices,frames,codec,setting,values,bytes,bits_per_vertex,encode_us,decode_us,error,kg_percent,survives_loss\n";
  }
  const auto schemes = all_schemes();
  for (const std::string& input : options.inputs) {
    const auto whole = read_animation(input, options.box, options.bits, options.frames);
    if (!whole) {
      std::fprintf(stderr, "error: %s\n", whole.error().c_str());
      return 1;
    }
    for (const std::size_t count : {std::size_t{10}, std::size_t{50}, std::size_t{100}, whole->rest.size()}) {
      const Animation animation = patch_of(*whole, count);
      std::vector<Row> rows;
      rows.reserve(schemes.size());
      for (const Scheme& scheme : schemes)
        rows.push_back({animation.name, animation.rest.size(), animation.frames.size(), &scheme, measure(animation, scheme)});
      print_table(rows);
      write_csv(csv, rows);
    }
  }
  for (const std::string& absent : absent_peers()) std::printf("\nleft out: %s", absent.c_str());
  std::printf(
      "\nCPU time of one thread, median; error: largest distance from the position before\nrounding, grid units; survives: a "
      "packet decodes though the one before was lost.\n");
  csv.flush();
  if (!options.csv.empty() && !csv) {
    std::fprintf(stderr, "error: %s cannot be written\n", options.csv.c_str());
    return 1;
  }
  return 0;
}
