// SPDX-License-Identifier: Apache-2.0
/// Packets of objects with elastic bodies, that tell whether what is shown follows a device.
#include <algorithm>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/elastic_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::array kOrder{Following::none, Following::kept,   Following::kept, Following::fading, Following::fading,
                            Following::none, Following::fading, Following::kept, Following::none,   Following::none};

/// From each kind of following to each, with a triangle and residuals now and then.
Bytes transitions(const ElasticItem& item, std::uint64_t seed) {
  ElasticStream stream(only(item));
  Random random(seed);
  std::int64_t tick = 0;
  for (std::size_t i = 0; i < kOrder.size(); ++i) {
    MainStep step{.at = {.tick = tick, .key = i == 0}, .density = random.below(4), .following = kOrder[i]};
    if (random.below(3) == 0) step.triangle = random.below(12);
    for (std::size_t k = 0; k < item.object.modes(); ++k) step.coefficients.push_back(random.integer(5));
    step.residuals = random_residuals(random, 5, 90);
    stream.add(0, step);
    tick += random.below(40);
  }
  return stream.finished();
}

/// Packets that build on older ones, some of which are lost: what counts is the baseline's `following`.
Bytes on_older_packets() {
  RawHeader header = only(cube());
  header.baseline_span = 16;
  ElasticStream stream(header);
  Random random(901);
  for (std::uint32_t i = 0; i < 40; ++i) {
    MainStep step{.at = {.tick = 7 * std::int64_t{i}, .key = i % 17 == 0}, .following = static_cast<Following>(random.below(3))};
    step.at.baseline = i % 17 == 0 ? 1 : 1 + random.below(std::min(i % 17, 16u));
    step.residuals = random_residuals(random, 3, 60);
    stream.add(0, step);
  }
  return stream.finished();
}

/// Only the second object has a body, and so the elements.
Bytes one_of_two() {
  RawHeader header;
  header.objects.clear();
  ElasticItem other = cube();
  other.object.name = "cube";
  other.object.weight_sets = 7;
  ElasticStream stream(with_elastic(header, {{{.shape = sheet(2, 2), .name = "sheet"}}, other}));
  Random random(902);
  for (std::int64_t i = 0; i < 12; ++i) {
    MainStep step{.at = {.tick = 5 * i, .key = i == 0}, .following = static_cast<Following>(i % 3)};
    step.residuals = random_residuals(random, 4, 100);
    step.weight_set = random.below(3);
    stream.add(1, step);
    step.weight_set = 0;
    if (i % 2 == 0) stream.add(0, step);
  }
  return stream.finished();
}

}  // namespace

void add_deformable_following(Catalogue& c) {
  c.section(section::kHead);
  const ElasticItem plain = cube();
  ElasticItem basis = plain, computed = plain, clusters = plain;
  basis.object = with_modes(basis.object, 3, 903);
  basis.object.fade = 4217;
  computed.object.spring_modes = 4;
  computed.object.runs = {{0, 3}};
  clusters.object.clusters = {1, 1};
  c.valid("following", "driven and fades, from each value to each.", transitions(plain, 904));
  c.valid("following-basis", "The same of an object with a declared basis that fades.", transitions(basis, 905));
  c.valid("following-computed-basis", "The same with a computed basis.", transitions(computed, 906));
  c.valid("following-clusters", "The same with clusters.", transitions(clusters, 907));
  c.valid("following-baselines", "Packets that build on any of the 16 before, and key packets between them.", on_older_packets());
  c.valid("following-of-one", "Two objects, one of which has a body.", one_of_two());
}

}  // namespace tactus::conformance
