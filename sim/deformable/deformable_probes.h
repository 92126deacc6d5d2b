// SPDX-License-Identifier: Apache-2.0
/// The proxies of all users on the surfaces of deformable objects at one end: on each surface as it is, or at clients on a cut-out of it
/// that approaches it linearly over one period (sim/contact/intermediate_model.h). Internal to the simulation.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tactus/elastic/elastic_touch.h>
#include <tactus/scene/scene_objects.h>
#include <tactus/sim/contact/intermediate_model.h>
#include <tactus/sim/contact/mesh_proxy.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/touchable.h>

namespace tactus::sim {

// ==== deformable probes ====

/// A surface as one end sees it now.
struct SeenSurface {
  std::span<const Vec3> vertices;  // V x 3 [m], world frame
  const AabbTree& tree;            // fitted to them
  const InsideTest& inside;
  bool is_new = false;  // the shape is the one that this tick began with
};

/// What a proxy needs of an object.
struct TouchedSurface {
  const TriMesh& rest;
  const MeshTopology& topology;
  double stiffness = 0;    // [N/m] of the coupling
  double friction = 0;     // mu
  std::uint32_t rate = 1;  // ticks from shape to shape
  bool as_body = false;    // touched as clients touch an elastic body that they step themselves, not by a MeshProxy
};

/// The touch of an elastic body, spec/55-elastic.md section 4: server and clients then differ in nothing but the shape.
class BodyTouch {
 public:
  explicit BodyTouch(const TouchedSurface& surface);
  BodyTouch(const BodyTouch&) = delete;  // its touch refers to its object
  BodyTouch& operator=(const BodyTouch&) = delete;
  ProxyTouch move(const Vec3& device, const SeenSurface& seen) noexcept;

 private:
  DeformableObject object_;
  ElasticTouch touch_;
  ElasticTouch::State state_;
};

enum class Following : std::uint8_t {
  at_once,  // a new shape, as soon as it is there
  linearly  // over the period that follows it, where a period has several ticks
};

class DeformableProbes {
 public:
  /// Objects first, then users.   pre  what an object refers to outlives this
  DeformableProbes(std::span<const TouchedSurface> objects, std::size_t users, Following following);

  /// Move a user's probe: it touches the object that it touched before, or the first one met.
  /// in   see  SeenSurface of an object, by number
  /// time O(log triangles), about 3 us; no allocation
  template <class See>
  Touch touch(std::size_t user, const Vec3& device, See&& see) noexcept {
    User& probe = users_[user];
    std::optional<std::uint32_t> touched;
    ProxyTouch proxy_touch;
    for (std::uint32_t i = 0; i < stiffness_.size(); ++i) {
      const ProxyTouch touch = move(probe, i, see(i), device);
      if (!touch.touched || (touched && probe.touched != i)) continue;
      touched = i;
      proxy_touch = touch;
    }
    probe.placed = true;
    probe.touched = touched;
    return result(touched, proxy_touch, device);
  }

  /// Announce a motion of the surface that they see.   in  reach [m] largest displacement of a vertex
  void expect(std::uint32_t object, double reach, std::span<const Vec3> vertices, std::span<const Vec3> next,
              const AabbTree& tree) noexcept;
  /// Take over a new shape.
  void update(std::uint32_t object, std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  /// Report that a shape was due and did not change.
  void update_at_rest(std::uint32_t object, std::span<const Vec3> vertices, const AabbTree& tree) noexcept;

 private:
  struct Proxy {
    MeshProxy direct;
    std::unique_ptr<IntermediateModel> cut_out;  // none: direct
    std::unique_ptr<BodyTouch> body;             // in their place
  };
  struct User {
    std::vector<Proxy> proxies;  // one per object
    std::optional<std::uint32_t> touched;
    bool placed = false;
  };
  static ProxyTouch move(User& user, std::uint32_t object, const SeenSurface& seen, const Vec3& device) noexcept;
  Touch result(std::optional<std::uint32_t> object, const ProxyTouch& proxy_touch, const Vec3& device) const noexcept;

  std::vector<double> stiffness_;  // of each object's coupling [N/m]
  std::vector<User> users_;
};

// ==== deformable view ====
// Deformable objects as shown at a client; the rest shape before the first show(). Needs no finite elements.

class DeformableView final : public Touchable {
 public:
  /// in   objects  surfaces at rest, one per deformable object of the scene; they outlive the view
  DeformableView(const Scene& scene, std::span<const TraceDeformable> objects);

  /// Set the shape that users see from now on.   in  displacements  V x 3, as Replica::displacements, 2^-position_exp m   no
  /// allocation
  void show(std::size_t object, std::span<const std::array<std::int32_t, 3>> displacements, unsigned position_exp) noexcept;
  Touch touch(std::size_t user, const DeviceSample& device, bool held) noexcept override;

 private:
  struct Surface {
    explicit Surface(const TriMesh& mesh)
        : rest(mesh), topology(mesh), inside(mesh, topology), vertices(mesh.vertices), next(mesh.vertices), tree(mesh) {}

    const TriMesh& rest;
    MeshTopology topology;
    InsideTest inside;
    std::vector<Vec3> vertices, next;
    AabbTree tree;
  };
  static std::vector<std::unique_ptr<Surface>> surfaces(std::span<const TraceDeformable> objects);
  std::vector<TouchedSurface> touched(const Scene& scene) const;

  std::vector<std::unique_ptr<Surface>> surfaces_;  // others refer to them
  DeformableProbes probes_;
};

}  // namespace tactus::sim
