// SPDX-License-Identifier: Apache-2.0
/// Writes the conformance vectors: `make_vectors FOLDER INDEX` fills FOLDER/manifest.json and FOLDER/vectors/, and the table in the
/// file INDEX (spec/90-test-vectors.md). The same bytes every time.
#include <cstdio>

#include "conformance/make_vectors/catalogue.h"

namespace tactus::conformance {
namespace {

Catalogue all() {
  Catalogue catalogue;
  catalogue.begin("scene", "Scene declarations, the headers of streams: objects, grids, bounds.");
  add_scene(catalogue);
  add_scene_bounds(catalogue);
  add_scene_orders(catalogue);
  add_scene_stiffness(catalogue);
  add_scene_motion(catalogue);
  add_scene_driven(catalogue);
  add_scene_elastic(catalogue);
  add_scene_elastic_faults(catalogue);
  add_scene_elastic_orders(catalogue);
  add_scene_elastic_edges(catalogue);
  catalogue.begin("file", "Stream files: records around packets.");
  add_file(catalogue);
  catalogue.begin("packet", "What packets of every kind have in common: sequence numbers, baselines, outages, substreams.");
  add_packet_rigid(catalogue);
  add_packet_deformable(catalogue);
  add_packet_substreams(catalogue);
  add_packet_overtaken(catalogue);
  catalogue.begin("range", "Payloads of the range coder: symbols, carries, ends.");
  add_range(catalogue);
  catalogue.begin("rigid", "Packets of rigid objects.");
  add_rigid(catalogue);
  add_rigid_rules(catalogue);
  add_rigid_edges(catalogue);
  add_rigid_orders(catalogue);
  add_rigid_predictors(catalogue);
  add_rigid_driven(catalogue);
  catalogue.begin("load", "Loads: their declaration and packets.");
  add_load(catalogue);
  catalogue.begin("client", "What a client shows of rigid objects, at every tick.");
  add_client(catalogue);
  add_client_playout(catalogue);
  add_client_eased(catalogue);
  add_client_curves(catalogue);
  add_client_predictors(catalogue);
  add_client_driven(catalogue);
  add_client_elastic(catalogue);
  add_client_elastic_edges(catalogue);
  catalogue.begin("session", "What the client's end of a session does with datagrams.");
  add_session(catalogue);
  add_session_server(catalogue);
  catalogue.begin("deformable", "Deformable objects: their declaration, and packets of both profiles.");
  add_deformable_header(catalogue);
  add_deformable_limits(catalogue);
  add_deformable_main(catalogue);
  add_deformable_layers(catalogue);
  add_deformable_thesis(catalogue);
  add_deformable_rules(catalogue);
  add_deformable_edges(catalogue);
  add_deformable_start_rows(catalogue);
  add_deformable_fade(catalogue);
  add_deformable_layers_fade(catalogue);
  add_deformable_orders(catalogue);
  add_deformable_springs(catalogue);
  add_deformable_clusters(catalogue);
  add_deformable_following(catalogue);
  return catalogue;
}

}  // namespace
}  // namespace tactus::conformance

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: make_vectors FOLDER INDEX\n", stderr);
    return 2;
  }
  const auto catalogue = tactus::conformance::all();
  const bool written = catalogue.write(argv[1]);
  return catalogue.write_index(argv[2]) && written ? 0 : 1;
}
