// SPDX-License-Identifier: Apache-2.0
/// Writes the conformance vectors: `make_vectors FOLDER INDEX` fills FOLDER/manifest.json and FOLDER/vectors/, and the table in the
/// file INDEX (spec/90-test-vectors.md). The same bytes every time.
#include <cstdio>

#include "conformance/make_vectors/catalogue.h"

int main(int argc, char** argv) {
  using namespace tactus::conformance;
  if (argc != 3) {
    std::fputs("usage: make_vectors FOLDER INDEX\n", stderr);
    return 2;
  }
  Catalogue catalogue;
  catalogue.begin("stream");
  add_stream_header(catalogue);
  add_stream_file(catalogue);
  add_stream_bounds(catalogue);
  add_stream_orders(catalogue);
  add_stream_header_orders(catalogue);
  catalogue.begin("range");
  add_range(catalogue);
  catalogue.begin("rigid");
  add_rigid(catalogue);
  add_rigid_rules(catalogue);
  add_rigid_outages(catalogue);
  add_rigid_orders(catalogue);
  add_rigid_edges(catalogue);
  add_rigid_packet_orders(catalogue);
  catalogue.begin("client");
  add_client(catalogue);
  catalogue.begin("mesh");
  add_mesh_header(catalogue);
  add_mesh_main(catalogue);
  add_mesh_split(catalogue);
  add_mesh_thesis(catalogue);
  add_mesh_parts(catalogue);
  add_mesh_rules(catalogue);
  add_memory(catalogue);
  add_mesh_outages(catalogue);
  add_mesh_orders(catalogue);
  add_mesh_edges(catalogue);
  add_mesh_start_rows(catalogue);
  add_mesh_header_orders(catalogue);
  add_mesh_packet_orders(catalogue);
  add_mesh_repeats(catalogue);
  const bool written = catalogue.write(argv[1]);
  return catalogue.write_index(argv[2]) && written ? 0 : 1;
}
