// SPDX-License-Identifier: Apache-2.0
// What `tactus bench precision` measures is what it says: orders, the reference's own error, and stops that are reported.
#include "lab/study/precision.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tactus::sim::study {
namespace {

PrecisionScene brief(const char* name) { return *precision_scene(name, Extent::brief); }

/// The order between steps of 2 and 1 ms.
double observed_order(const PrecisionScene& scene, const Reference& reference, const PrecisionMethod& method) {
  const PrecisionPoint coarse = measure(scene, method, 50, reference, {.runs = 1});
  const PrecisionPoint fine = measure(scene, method, 100, reference, {.runs = 1});
  return std::log2(coarse.errors.displacement / fine.errors.displacement);
}

class Precision : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = brief("membrane");
    auto made = make_reference(scene_);
    ASSERT_TRUE(made);
    reference_ = *std::move(made);
  }
  static inline PrecisionScene scene_;
  static inline Reference reference_;
};

TEST_F(Precision, TheReferenceIsOfOrderFourAndFarBelowWhatItMeasures) {
  EXPECT_NEAR(reference_.order, 4, 0.3);
  EXPECT_LT(reference_.floor.displacement, 1e-8);
  EXPECT_LT(reference_.floor.energy, 1e-8);
  EXPECT_LT(reference_.floor.weight, 1e-6);
}

TEST_F(Precision, AnotherMethodEndsWhereTheReferenceIs) {
  for (const Loading loading : {Loading::force, Loading::weight}) {
    const Trajectory& reference = loading == Loading::force ? reference_.load : reference_.weight;
    const auto error = [&](int steps) {
      const auto run = simulate(scene_, {"velocity Verlet", {}}, steps, loading);
      return (run->u.back() - reference.u.back()).norm() / reference.u.back().norm();
    };
    const double coarse = error(1000), fine = error(2000);
    EXPECT_NEAR(coarse / fine, 4, 0.1);
    EXPECT_LT(fine, 1e-6);
  }
}

TEST_F(Precision, TheChosenMethodIsReportedAndIsWhatChooseTakes) {
  const PrecisionMethod chosen = precision_methods(Extent::brief).front();
  ASSERT_TRUE(chosen.chosen);
  const PrecisionPoint fast = measure(scene_, chosen, 100, reference_, {.runs = 1});
  EXPECT_EQ(fast.taken, "velocity-verlet");
  EXPECT_EQ(fast.errors.displacement, measure(scene_, {"velocity Verlet", {}}, 100, reference_, {.runs = 1}).errors.displacement);
  const PrecisionPoint slow = measure(scene_, chosen, 6, reference_, {.runs = 1});
  EXPECT_NE(slow.taken.find("sub-steps"), std::string::npos) << slow.taken;
}

TEST_F(Precision, EveryMethodHasTheOrderThatItsLoadsAreTakenFor) {
  for (const PrecisionMethod& method : precision_methods(Extent::brief)) {
    if (method.elasticity == Elasticity::linear || method.chosen)
      continue;  // differs from the co-rotated reference whatever the step
    const bool first_order = method.options.method == Method::backward_euler || method.options.method == Method::projective;
    EXPECT_NEAR(observed_order(scene_, reference_, method), first_order ? 1 : 2, 0.2) << method.name;
  }
}

TEST_F(Precision, ANonlinearObjectIsNotThatOfLinearElasticity) {
  const PrecisionMethod linear{"linear", {}, Elasticity::linear};
  const PrecisionPoint coarse = measure(scene_, linear, 50, reference_, {.runs = 1});
  const PrecisionPoint fine = measure(scene_, linear, 200, reference_, {.runs = 1});
  EXPECT_GT(fine.errors.displacement, 10 * reference_.floor.displacement);
  EXPECT_NEAR(coarse.errors.displacement / fine.errors.displacement, 1, 0.05);
}

TEST_F(Precision, AStopIsReportedAndHasNoErrors) {
  const PrecisionPoint point = measure(brief("membrane-stiff"), {"velocity Verlet", {}}, 25, reference_, {.runs = 1});
  EXPECT_TRUE(std::isnan(point.errors.displacement));
  EXPECT_NE(point.remark.find("R-FEM-6"), std::string::npos) << point.remark;
  EXPECT_EQ(point.runs, 0);
}

TEST_F(Precision, StepsMeetTheSampleTimes) {
  for (const char* name : kPrecisionScenes) {
    const auto scene = precision_scene(name, Extent::full);
    ASSERT_TRUE(scene);
    for (const int n : scene->steps_per_sample) EXPECT_NEAR(scene->step(n) * n * scene->samples, scene->duration, 1e-15);
    EXPECT_EQ(scene->reference_steps_per_sample % 4, 0);
    double sum = 0;
    for (const double weight : scene->patch.weights) sum += weight;
    EXPECT_NEAR(sum, 1, 1e-14);
  }
  EXPECT_FALSE(precision_scene("trampoline", Extent::full));
}

}  // namespace
}  // namespace tactus::sim::study
