// SPDX-License-Identifier: Apache-2.0
/// The list of vectors, and how it is written to disk.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "conformance/make_vectors/build.h"

namespace tactus::conformance {

/// What a decoder must answer to a file that breaks a rule. Written from the specification by hand.
struct Rejection {
  std::string errc;
  std::string rule;
};

struct Case {
  std::string stem;
  std::string id;  ///< stem/NNN-name
  std::string what;
  std::vector<std::string> rules;
  Bytes input;
  std::string replica;                 ///< none, linear or empty
  std::optional<Rejection> rejection;  ///< nothing: the file is valid
};

class Catalogue {
 public:
  /// Start a stem: its cases are numbered from 1 in the order in which they are added.
  void begin(std::string stem);
  void valid(const std::string& name, const std::string& what, Bytes input, std::vector<std::string> rules = {},
             const std::string& replica = "");
  void invalid(const std::string& name, const std::string& what, const Rejection& rejection, Bytes input);

  /// Write manifest.json and vectors/<stem>/NNN-name.{tct,json,jsonl} below `folder`. False and a message on stderr when our own
  /// decoder does not answer as a case expects; everything is written nevertheless.
  bool write(const std::filesystem::path& folder) const;
  /// Replace the table between the two marks of the specification's index.
  bool write_index(const std::filesystem::path& file) const;

 private:
  void add(const std::string& name, Case entry);

  std::vector<Case> cases_;
  std::string stem_;
  int number_ = 0;
};

// One ladder per stem.
void add_stream_header(Catalogue& catalogue);
void add_stream_file(Catalogue& catalogue);
void add_stream_bounds(Catalogue& catalogue);
void add_stream_orders(Catalogue& catalogue);
void add_stream_header_orders(Catalogue& catalogue);
void add_range(Catalogue& catalogue);
void add_rigid(Catalogue& catalogue);
void add_rigid_rules(Catalogue& catalogue);
void add_rigid_outages(Catalogue& catalogue);
void add_rigid_orders(Catalogue& catalogue);
void add_rigid_edges(Catalogue& catalogue);
void add_rigid_packet_orders(Catalogue& catalogue);
void add_client(Catalogue& catalogue);
void add_mesh_header(Catalogue& catalogue);
void add_mesh_main(Catalogue& catalogue);
void add_mesh_split(Catalogue& catalogue);
void add_mesh_thesis(Catalogue& catalogue);
void add_mesh_parts(Catalogue& catalogue);
void add_mesh_rules(Catalogue& catalogue);
void add_memory(Catalogue& catalogue);
void add_mesh_outages(Catalogue& catalogue);
void add_mesh_orders(Catalogue& catalogue);
void add_mesh_edges(Catalogue& catalogue);
void add_mesh_start_rows(Catalogue& catalogue);
void add_mesh_header_orders(Catalogue& catalogue);
void add_mesh_packet_orders(Catalogue& catalogue);
void add_mesh_repeats(Catalogue& catalogue);

}  // namespace tactus::conformance
