// SPDX-License-Identifier: Apache-2.0
#include <tactus/thesis/thesis_syntax.h>

#include <tactus/base/bytes.h>

namespace tactus {

std::vector<BitModel> initial_thesis_models(const DeformableObject& object) {
  return std::vector<BitModel>(kIndexModels + (std::size_t{1} << object.quant_bits) - 1);
}

ThesisState initial_thesis_state(const DeformableObject& object) {
  ThesisState state;
  state.displacement.resize(object.rest.size());
  if (object.models_kept) state.models = initial_thesis_models(object);
  return state;
}

std::uint64_t state_hash(const DeformableObject&, const ThesisState& state) noexcept {
  Fnv1a hash;
  hash.add64(static_cast<std::uint64_t>(state.tick));
  for (const Vec3i& u : state.displacement)
    for (const std::int32_t c : u) hash.add32(c);
  for (const BitModel& m : state.models) hash.add32(static_cast<std::uint32_t>(m.zero | m.rate << 16));
  return hash.value();
}

}  // namespace tactus
