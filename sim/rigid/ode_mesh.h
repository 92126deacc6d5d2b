// SPDX-License-Identifier: Apache-2.0
/// Solids of any shape in ODE. Internal to rigid_world.cpp.
///
/// They collide as triangle meshes, not as convex hulls: a bracket's inner corner must hold an object that lies in it, and ODE's
/// hull-hull test yields a single point where two faces meet. On a mesh ODE finds a contact at every corner and edge, hundreds on
/// a fine mesh. A few of them suffice.
#pragma once

#include <ode/ode.h>

#include <memory>
#include <span>

#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

struct TriMeshDataEnd {
  void operator()(dTriMeshDataID data) const noexcept { dGeomTriMeshDataDestroy(data); }
};
/// ODE's view of a mesh; the mesh must outlive it and stay where it is.
using OdeMesh = std::unique_ptr<dxTriMeshData, TriMeshDataEnd>;

OdeMesh make_ode_mesh(const TriMesh& mesh);

/// Mass properties of the enclosed solid at constant density, about the origin, which is its centre of mass.
/// in  geom  of the mesh, where it was made
dMass mass_of_mesh(dGeomID geom, double mass);

/// Move the best supporting contacts to the front: the deepest, then repeatedly the one farthest from those chosen.
/// out  their number: at most `most`.   time O(contacts * most)
int keep_outermost(std::span<dContact> contacts, int most) noexcept;

}  // namespace tactus::sim
