// SPDX-License-Identifier: Apache-2.0
/// Any bytes as a .msh, or as a .node and an .ele with a zero byte between: an error with its line, or a mesh of finite numbers whose
/// tetrahedra name vertices that are there, that reads back the same after writing.
#include <algorithm>
#include <cstdint>
#include <sstream>
#include <string_view>

#include <tactus/sim/tets/tet_files.h>
#include "tests/fuzz/require.h"

namespace {

using Read = tl::expected<tactus::sim::TetFile, tactus::Diagnostic>;

void check(const Read& file, std::string_view text) {
  if (!file) {
    require(file.error().line <=
            static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; })) + 1);
    require(to_string(file.error()).find("R-TET-") != std::string::npos);
    return;
  }
  const tactus::sim::TetMesh& mesh = file->mesh;
  require(!mesh.tets.empty() && mesh.vertices.size() <= text.size() && mesh.tets.size() <= text.size());
  for (const tactus::Vec3& v : mesh.vertices) require(is_finite(v));
  for (const tactus::sim::Tet& tet : mesh.tets)
    for (const std::uint32_t v : tet) require(v < mesh.vertices.size());
  (void)check(mesh);
}

template <class Parse, class... Write>
void check_round_trip(const Read& file, Parse parse, Write... write) {
  if (!file) return;
  const auto written = [&](auto one) {
    std::ostringstream out;
    one(out, file->mesh);
    return out.str();
  };
  const Read again = parse(written(write)...);
  require(again && again->mesh.vertices == file->mesh.vertices && again->mesh.tets == file->mesh.tets);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const std::size_t cut = text.find('\0'); cut != std::string_view::npos && !text.starts_with("$MeshFormat")) {
    const Read file = tactus::sim::parse_node_ele(text.substr(0, cut), text.substr(cut + 1));
    check(file, text);
    check_round_trip(file, tactus::sim::parse_node_ele, tactus::sim::write_node, tactus::sim::write_ele);
    return 0;
  }
  const Read file = tactus::sim::parse_msh(text);
  check(file, text);
  check_round_trip(file, tactus::sim::parse_msh, tactus::sim::write_msh);
  return 0;
}
