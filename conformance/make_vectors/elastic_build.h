// SPDX-License-Identifier: Apache-2.0
/// Elastic bodies and what a device does to them, made field by field.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "conformance/make_vectors/build.h"
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"

namespace tactus::conformance {

using Corners = std::array<std::uint32_t, 4>;

/// An elastic body of a header with any values, valid or not.
struct RawBody {
  std::uint8_t has_body = 1;
  /// mass_damping, stiffness_damping, gravity along x, y and z, coupling, friction
  std::array<double, 7> constants{20, 0.002, 0, 0, 0, 400, 0};
  std::vector<std::array<double, 3>> materials{{20000, 0.4, 1000}};  ///< young, poisson, density
  std::vector<Vec3i> inner{};
  std::vector<Corners> tets{};
  std::vector<std::pair<std::uint64_t, std::uint8_t>> lengths{};  ///< length and material
  std::vector<std::array<std::uint64_t, 2>> runs{};               ///< gap and more of its fixed vertices
  std::optional<std::uint8_t> material_count{};                   ///< in place of the true number
  std::optional<Bytes> inner_count{}, tet_count{}, run_count{};   ///< the same

  Bytes bytes() const;
};
inline constexpr std::size_t kMassDamping = 0, kStiffnessDamping = 1, kGravityX = 2, kGravityY = 3, kGravityZ = 4, kCoupling = 5,
                             kFriction = 6;

/// A surface, and what fills it.
struct Block {
  Shape shape;
  std::vector<Vec3i> inner{};
  std::vector<Corners> tets{};

  const Vec3i& rest(std::uint32_t vertex) const {
    return vertex < shape.rest.size() ? shape.rest[vertex] : inner[vertex - shape.rest.size()];
  }
};

struct ElasticItem {
  RawDeformable object{};
  std::optional<RawBody> body{};
};

/// nx x ny x nz cubes `size` grid units wide, of six tetrahedra each. The surface is that of box().
Block block(int nx, int ny, int nz, std::int32_t size = 42000);
/// So many tetrahedra between any vertices of a cloud, which overlap; no triangles.
Block tangle(std::uint32_t vertices, std::uint32_t tets, std::uint64_t seed);
/// So many of the tetrahedra of a cloud of 500 vertices: with kMostTets of them the work is just below the limit of 2^30.
ElasticItem heaviest(std::uint32_t tets);
inline constexpr std::uint32_t kMostTets = 2013;
/// Runs of these vertices, ascending.
std::vector<std::array<std::uint64_t, 2>> runs_of(const std::vector<std::uint32_t>& vertices);
/// Of the vertices with z = 0, which are fixed.
RawBody standing(const Block& block);
/// No vertex is fixed.
RawBody loose(const Block& block);

/// `header` with these objects, and the flags that say so.
RawHeader with_elastic(RawHeader header, const std::vector<ElasticItem>& items);
/// A header of one object alone.
RawHeader only(const ElasticItem& item);
/// The cube of eight vertices and six tetrahedra, four vertices fixed.
ElasticItem cube();

/// A stream of a device, if the scene has one, and elastic objects.
class ElasticStream {
 public:
  explicit ElasticStream(const RawHeader& header);

  /// A packet of the device: at a place [position grid], with a velocity [velocity grid].
  ElasticStream& device(std::int64_t tick, const Vec3i& place, const Vec3i& velocity = {});
  ElasticStream& add(std::size_t object, const MainStep& step);
  ElasticStream& add_device(const Step& step) {
    stream_.add_packet(step.tick, of_substream(0, stream_.packet(step)), step.key);
    return *this;
  }
  const Bytes& bytes() const { return stream_.bytes(); }
  Bytes finished() { return stream_.finish().bytes(); }

 private:
  Bytes of_substream(std::size_t number, const Bytes& packet) const;

  Stream stream_;
  std::vector<DeformableComposer> composers_;
  bool has_device_ = false;
};

// ---- What a device does to them ----

inline constexpr std::int32_t kMm = 4194;    // a millimetre on the grid
inline constexpr std::int32_t kSpeed = 131;  // 1 mm/s
inline constexpr std::int32_t kSize = 10 * kMm;

/// A device at a tick.
struct Move {
  std::int64_t tick;
  Vec3i place;
  Vec3i velocity{};
};
/// A packet of the object.
struct Told {
  std::int64_t tick;
  Following following = Following::fading;
  unsigned width = 0;  ///< of its residuals
};

/// With a device, and frames of so many ticks.
RawHeader scene(const ElasticItem& item, std::uint32_t ticks, bool has_device = true);
/// The device's packets and those of the object, by tick; one more of the device at the end.
Bytes played(const RawHeader& header, const std::vector<Move>& moves, const std::vector<Told>& told, std::int64_t end,
             std::uint64_t seed = 910);
/// Blocks of kSize that stand.
ElasticItem pad(int nx = 2, int ny = 1, int nz = 1);
/// An item after one change.
template <class Change>
ElasticItem changed(Change change, ElasticItem item) {
  change(item.object, *item.body);
  return item;
}
/// A vector of a client that knows its device.
void add_device(Catalogue& c, const std::string& name, const char* what, Bytes bytes);

}  // namespace tactus::conformance
