// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/bullet_slab.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>

#include <vector>

namespace tactus::testing {
namespace {

btVector3 bullet(const Vec3& v) { return {v.x, v.y, v.z}; }

btDeformableLinearElasticityForce force_of(const sim::Material& m) {
  btDeformableLinearElasticityForce force(1, 1, 0, 0);
  force.setYoungsModulus(m.young);
  force.setPoissonRatio(m.poisson);
  return force;
}

}  // namespace

struct BulletSlab::Impl {
  explicit Impl(const sim::Material& material) : elasticity(force_of(material)) {}

  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btDeformableBodySolver solver;
  btDeformableMultiBodyConstraintSolver constraints;
  btDeformableLinearElasticityForce elasticity;
  btDeformableMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &constraints, &configuration, &solver};
  std::unique_ptr<btSoftBody> body;
  std::vector<double> rest_z;
};

BulletSlab::BulletSlab(const sim::FemModel& model, const sim::Material& material) : impl_(std::make_unique<Impl>(material)) {
  Impl& b = *impl_;
  b.constraints.setDeformableSolver(&b.solver);
  b.world.setGravity({0, 0, 0});
  b.world.getWorldInfo().m_gravity = {0, 0, 0};
  b.world.getWorldInfo().air_density = 0;
  b.world.setImplicit(false);

  const sim::TetMesh& mesh = model.mesh();
  std::vector<btVector3> positions;
  std::vector<double> masses;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const bool fixed = model.is_fixed(static_cast<std::uint32_t>(v));
    positions.push_back(bullet(mesh.vertices[v]));
    masses.push_back(fixed ? 0 : model.lumped_mass()[3 * static_cast<Eigen::Index>(v)]);
    b.rest_z.push_back(mesh.vertices[v].z);
  }
  b.body =
      std::make_unique<btSoftBody>(&b.world.getWorldInfo(), static_cast<int>(positions.size()), positions.data(), masses.data());
  for (const sim::Tet& t : mesh.tets)
    b.body->appendTetra(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]), static_cast<int>(t[3]));
  b.body->m_tetraScratches.resize(b.body->m_tetras.size());
  b.body->m_tetraScratchesTn.resize(b.body->m_tetras.size());
  b.body->initializeDmInverse();
  b.body->m_cfg.collisions = 0;
  b.body->m_cfg.kDP = b.body->m_cfg.drag = 0;
  b.body->setDampingCoefficient(0);
  b.body->setSelfCollision(false);
  b.body->setActivationState(DISABLE_DEACTIVATION);
  b.world.addSoftBody(b.body.get());
  b.world.addForce(b.body.get(), &b.elasticity);
}

BulletSlab::~BulletSlab() { impl_->world.removeSoftBody(impl_->body.get()); }

void BulletSlab::step(double h, std::uint32_t vertex, double force) {
  btSoftBody::Node& node = impl_->body->m_nodes[static_cast<int>(vertex)];
  node.m_v += btVector3(0, 0, h * force * node.m_im);
  impl_->world.stepSimulation(h, 0);
}

double BulletSlab::z(std::uint32_t vertex) const {
  return impl_->body->m_nodes[static_cast<int>(vertex)].m_x.z() - impl_->rest_z[vertex];
}

}  // namespace tactus::testing
