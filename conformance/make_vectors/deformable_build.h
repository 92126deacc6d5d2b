// SPDX-License-Identifier: Apache-2.0
/// Streams with deformable objects, made field by field. Nothing here asks an encoder what it would do.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tactus/deformable/main_state.h>
#include <tactus/deformable/main_syntax.h>
#include <tactus/deformable/thesis_syntax.h>
#include "conformance/make_vectors/build.h"

namespace tactus::conformance {

/// Vertices, x 2^-22 m, and triangles.
struct Shape {
  std::vector<Vec3i> rest;
  std::vector<Triangle> triangles;
};

Shape one_vertex();
Shape one_triangle();
/// Open: nx x ny squares of two triangles, `size` grid units wide, bent a little.
Shape sheet(int nx, int ny, std::int32_t size = 4000);
/// Closed: the surface of nx x ny x nz cubes. 16 x 18 x 2 is the membrane of thesis 4.4.3: 714 vertices, 1424 triangles.
Shape box(int nx, int ny, int nz, std::int32_t size = 4000);
/// `triangles` around one vertex, which has the highest number, on a line: every triangle is degenerate. No two triangles share an edge.
Shape flat_fan(int triangles);
/// Triangles a thousand times longer than wide.
Shape slivers(int triangles);
Shape moved(Shape shape, const Vec3i& by);
Shape both(const Shape& a, const Shape& b);

/// A deformable object of a header with any values, valid or not.
struct RawDeformable {
  Shape shape = one_triangle();
  std::uint8_t profile = 1;
  std::string name = "membrane";
  std::uint8_t rings = 2;
  std::uint8_t quant_bits = 8;       ///< thesis
  std::uint8_t models_kept = 0;      ///< thesis
  std::uint32_t frame_period = 256;  ///< main
  std::uint8_t layered = 0;          ///< main
  std::uint16_t fade = 0;            ///< main
  std::uint8_t weight_sets = 1;      ///< main
  std::vector<std::uint16_t> mode_steps{};
  std::vector<std::int32_t> entries{};               ///< modes x vertices x 3
  std::uint8_t spring_modes = 0;                     ///< of a computed basis, in place of a declared one
  std::vector<std::array<std::uint64_t, 2>> runs{};  ///< gap and more of its fixed vertices
  struct Clusters {
    std::uint8_t count = 0;
    std::uint8_t blend = 0;
    std::vector<std::array<std::uint64_t, 2>> surprises{};  ///< gap and cluster
  };
  Clusters clusters{};
  std::optional<Bytes> basis{};           ///< in place of everything from the element `basis` on
  std::optional<Bytes> vertex_count{};    ///< in place of the true number
  std::optional<Bytes> triangle_count{};  ///< in place of the true number
  std::optional<Bytes> mode_count{};      ///< in place of the true number

  Bytes bytes() const;
  std::size_t modes() const {
    return clusters.count > 0 ? std::size_t{12} * clusters.count : spring_modes > 0 ? spring_modes : mode_steps.size();
  }
};

Bytes zigzag_varint(std::int64_t value);
/// `header` with these deformable objects and the flag that says so.
RawHeader with_deformables(RawHeader header, const std::vector<RawDeformable>& items);
/// So many objects of one vertex, each with as many models in its state as there may be.
std::vector<RawDeformable> with_large_states(int count);
/// A header of one deformable object alone.
RawHeader only(const RawDeformable& item, std::uint8_t baseline_span = 1);
/// A header in which these bytes speak of deformable objects.
Bytes around(const Bytes& items);
/// The same of one object of profile main up to `triangle_count`, and what follows.
Bytes counted(std::uint64_t vertices, std::uint64_t triangles, const Bytes& rest);
/// K smooth vectors over the shape, seeded.
RawDeformable with_modes(RawDeformable item, std::size_t modes, std::uint64_t seed);

/// What profile main asks for a vertex: where prediction puts it, and its bound and quantiser step.
struct VertexPrediction {
  std::uint32_t vertex;
  Vec3i predicted;
  std::uint32_t bound;
  std::int64_t step;
};
using Residuals = std::function<Vec3i(const VertexPrediction&)>;

/// Where in a sequence of packets one stands.
struct PacketPlace {
  std::int64_t tick = 0;
  bool key = false;
  std::uint32_t baseline = 1;               ///< packets back, for packets that are not key
  std::optional<std::uint16_t> sequence{};  ///< in place of the next one
};

struct MainStep {
  PacketPlace at;
  Layer layer = Layer::all;  ///< whole: of objects without layers
  bool same_frame = false;
  std::optional<std::uint32_t> triangle{};  ///< touched
  std::uint32_t haptic = 0;                 ///< level
  std::uint32_t visual = 100;
  std::uint32_t density = 1;
  std::uint32_t weight_set = 0;
  Following following = Following::none;     ///< of an object with an elastic body
  std::vector<std::int32_t> coefficients{};  ///< empty: all 0
  Residuals residuals{};                     ///< none: all 0
};

struct ThesisVertex {
  std::uint32_t vertex = 0;
  std::array<std::uint32_t, 3> symbols{};
};

struct ThesisStep {
  PacketPlace at;
  std::int32_t lowest = -100;
  std::uint32_t range = 200;
  std::vector<ThesisVertex> vertices{};  ///< ascending
};

/// Composes the packets of one deformable object of a stream; keeps the states that they may build on.
class DeformableComposer {
 public:
  DeformableComposer(const Scene& header, std::size_t item);
  ~DeformableComposer();
  DeformableComposer(DeformableComposer&&) noexcept;

  Bytes packet(const MainStep& step);
  Bytes packet(const ThesisStep& step);
  const DeformableObject& item() const;

 private:
  struct Fixed;

  template <class State>
  const State& baseline(const PacketPlace& at, const std::map<std::uint16_t, State>& states, const State& initial);
  template <class State>
  void keep(const PacketPlace& at, std::map<std::uint16_t, State>& states, State state);

  std::unique_ptr<Fixed> fixed_;                    // the item and what follows from it
  std::map<std::uint16_t, MainState> main_states_;  // by sequence
  std::map<std::uint16_t, ThesisState> thesis_states_;
  std::uint16_t next_sequence_ = 0;
  std::uint16_t sequence_ = 0;  // of the packet at hand
};

/// A stream of one deformable object.
class DeformableStream {
 public:
  explicit DeformableStream(const RawHeader& header) : stream_(header), composer_(stream_.header(), 0) {}

  template <class Step>
  DeformableStream& add(const Step& step) {
    stream_.add_packet(step.at.tick, composer_.packet(step), step.at.key);
    return *this;
  }
  DeformableStream& add_packet(std::int64_t tick, const Bytes& packet) {
    stream_.add_packet(tick, packet);
    return *this;
  }
  /// A packet that is lost on its way.
  template <class Step>
  DeformableStream& lose(const Step& step) {
    composer_.packet(step);
    return *this;
  }
  DeformableComposer& composer() { return composer_; }
  Bytes finished() { return stream_.finish().bytes(); }
  const Bytes& bytes() const { return stream_.bytes(); }

 private:
  Stream stream_;
  DeformableComposer composer_;
};

/// A packet of profile main whose payload `code(coder, models)` writes symbol by symbol.
template <class Code>
Bytes coded_main_packet(std::uint16_t sequence, Code code) {
  return with_payload(sequence, [&](RangeEncoder& coder) {
    MainModels models = main_start_models();
    code(coder, models);
  });
}

/// A packet of profile thesis in pieces, any of which may be wrong.
struct RawThesis {
  std::uint16_t sequence = 0;
  std::uint8_t key = 1;
  std::optional<std::uint8_t> baseline_delta{};
  Bytes tick_delta{0};
  Bytes count{1};
  std::optional<Bytes> list_bytes{};  ///< in place of the true number
  Bytes lowest{0};
  Bytes range{0};
  Bytes list{};
  Bytes errors{};

  Bytes bytes() const;
};

/// `symbols` of 8 bits from cold models, and `symbols` of q bits, as payloads.
Bytes thesis_symbols(const std::vector<std::uint32_t>& symbols, unsigned bits);

/// Random residuals of up to `width` bits for `share` in 256 of the vertices.
Residuals random_residuals(Random& random, unsigned width, std::uint32_t share);
/// The residuals that take every vertex within its bound of `target`.
Residuals towards(std::function<Vec3i(std::uint32_t)> target);

/// A stream of profile main: random residuals, bounds and coefficients, touched now and then, at random intervals.
Bytes random_walk(const RawDeformable& item, std::uint64_t seed, int packets, std::uint8_t span = 1, std::int64_t frame = 1);

/// A deformable object of profile main with 3 triangles and 2 modes.
RawHeader main_scene(std::uint8_t span = 1);
/// Packets 0 and 1, of profile main, at ticks 10 and 30; triangle 0 is touched.
DeformableStream two_main_packets(std::uint8_t span = 1);
/// The same of profile thesis.
DeformableStream two_thesis_packets(std::uint8_t span = 1);

template <class Step>
Bytes then(DeformableStream stream, const Step& step) {
  return stream.add(step).bytes();
}
/// A packet of profile thesis at tick 10, and one more, not key.
Bytes after_one_thesis_packet(std::uint8_t span, RawThesis raw);
inline Bytes then_packet(DeformableStream stream, const Bytes& packet) { return stream.add_packet(30, packet).bytes(); }

}  // namespace tactus::conformance
