// SPDX-License-Identifier: Apache-2.0
/// A probe on a mesh, and what tests of it share.
#pragma once

#include <gtest/gtest.h>

#include <tactus/sim/contact/mesh_proxy.h>
#include "tests/unit/contact_mesh_fixture.h"

namespace tactus::testing {

/// A probe on a body; positions are exact to the skin (6 nm at 0.1 m), which every tolerance below names.
struct Hand {
  const Body& body;
  sim::MeshProxy proxy;
  double skin;

  Hand(const Body& b, const sim::MeshProxyOptions& options) : body(b), proxy(options, b.extent()), skin(proxy.skin()) {}
  sim::ProxyTouch move_to(const Vec3& probe) { return proxy.move_to(probe, body.inside, body.mesh.vertices, body.tree); }
  sim::ProxyTouch move(const Vec3& probe) { return proxy.move(probe, body.mesh.vertices, body.tree); }
  sim::ProxyTouch move_along(const Vec3& from, const Vec3& to, int ticks) {
    sim::ProxyTouch out;
    for (int i = 0; i <= ticks; ++i) out = move(from + (static_cast<double>(i) / ticks) * (to - from));
    return out;
  }
};

inline void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_LE(norm(a - b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

inline TriMesh flat() {
  return sheet(20, 0.01, [](double, double) { return 0.0; });
}

}  // namespace tactus::testing
