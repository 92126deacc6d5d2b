// SPDX-License-Identifier: Apache-2.0
/// The list of vectors, and how it is written to disk.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "conformance/make_vectors/build.h"

namespace tactus::conformance {

/// What a decoder must answer to a file that breaks a rule. Written from the specification by hand.
struct Rejection {
  std::string errc;
  std::string rule;
  std::string later{};  ///< a rule that the file breaks further on: the order of the two checks is what the vector is for
};

/// What a testee reads. Where `times` copies of `pattern` stand in it at `at`, they are not written to the file but told in the list.
struct Input {
  struct Repeat {
    std::size_t at;
    Bytes pattern;
    std::size_t times;
  };

  Input(Bytes all) : bytes(std::move(all)) {}
  Input(Bytes all, Repeat told) : bytes(std::move(all)), repeat(std::move(told)) {}

  /// The bytes that are written.
  Bytes written() const;

  Bytes bytes;
  std::optional<Repeat> repeat{};
};

struct Case {
  std::string name;  ///< NNN-name
  std::string what;
  std::string section;             ///< of the specification
  std::vector<std::string> rules;  ///< what the vector is for, besides the section
  Input input;
  std::string replica;                 ///< none, device, linear, hermite, blending, playout or empty
  std::optional<Rejection> rejection;  ///< nothing: the file is valid
  bool session = false;                ///< the input is a script for an end of a session, not a stream
};

/// A folder of vectors.
struct Stem {
  std::string name;
  std::string what;
  std::vector<Case> cases;
};

class Catalogue {
 public:
  /// Start a stem: its cases are numbered from 1 in the order in which they are added.
  void begin(const std::string& stem, const std::string& what);
  /// The section of the specification that the following valid cases are about: its chapter's number and its title.
  void section(const std::string& section) { section_ = section; }
  void valid(const std::string& name, const std::string& what, Input input, std::vector<std::string> rules = {},
             const std::string& replica = "");
  /// What a client does with a script of datagrams.
  void session(const std::string& name, const std::string& what, Input script, std::vector<std::string> rules = {});
  void invalid(const std::string& name, const std::string& what, const Rejection& rejection, Input input);

  /// Write manifest.json, vectors/<stem>.json and vectors/<stem>/NNN-name.{tct or script, jsonl} below `folder`. False and a message on
  /// stderr
  /// when our own decoder does not answer as a case expects; everything is written nevertheless.
  bool write(const std::filesystem::path& folder) const;
  /// Replace the table between the two marks of the specification's index.
  bool write_index(const std::filesystem::path& file) const;

 private:
  void add(const std::string& name, Case entry);

  std::vector<Stem> stems_;
  std::string section_;
};

// One ladder per stem.
void add_scene(Catalogue& catalogue);
void add_scene_bounds(Catalogue& catalogue);
void add_scene_orders(Catalogue& catalogue);
void add_scene_stiffness(Catalogue& catalogue);
void add_scene_motion(Catalogue& catalogue);
void add_scene_driven(Catalogue& catalogue);
void add_scene_elastic(Catalogue& catalogue);
void add_scene_elastic_faults(Catalogue& catalogue);
void add_scene_elastic_orders(Catalogue& catalogue);
void add_scene_elastic_edges(Catalogue& catalogue);
void add_file(Catalogue& catalogue);
void add_packet_rigid(Catalogue& catalogue);
void add_packet_deformable(Catalogue& catalogue);
void add_packet_substreams(Catalogue& catalogue);
void add_packet_overtaken(Catalogue& catalogue);
void add_range(Catalogue& catalogue);
void add_rigid(Catalogue& catalogue);
void add_rigid_rules(Catalogue& catalogue);
void add_rigid_edges(Catalogue& catalogue);
void add_rigid_orders(Catalogue& catalogue);
void add_rigid_predictors(Catalogue& catalogue);
void add_rigid_driven(Catalogue& catalogue);
void add_load(Catalogue& catalogue);
void add_client(Catalogue& catalogue);
void add_client_playout(Catalogue& catalogue);
void add_client_eased(Catalogue& catalogue);
void add_client_curves(Catalogue& catalogue);
void add_client_predictors(Catalogue& catalogue);
void add_client_driven(Catalogue& catalogue);
void add_client_elastic(Catalogue& catalogue);
void add_client_elastic_edges(Catalogue& catalogue);
void add_session(Catalogue& catalogue);
void add_session_server(Catalogue& catalogue);
void add_deformable_header(Catalogue& catalogue);
void add_deformable_limits(Catalogue& catalogue);
void add_deformable_main(Catalogue& catalogue);
void add_deformable_layers(Catalogue& catalogue);
void add_deformable_thesis(Catalogue& catalogue);
void add_deformable_rules(Catalogue& catalogue);
void add_deformable_edges(Catalogue& catalogue);
void add_deformable_start_rows(Catalogue& catalogue);
void add_deformable_fade(Catalogue& catalogue);
void add_deformable_layers_fade(Catalogue& catalogue);
void add_deformable_orders(Catalogue& catalogue);
void add_deformable_springs(Catalogue& catalogue);
void add_deformable_clusters(Catalogue& catalogue);
void add_deformable_following(Catalogue& catalogue);

}  // namespace tactus::conformance
