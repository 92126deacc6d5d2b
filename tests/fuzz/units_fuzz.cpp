// SPDX-License-Identifier: Apache-2.0
/// A byte that picks the dimension, then any bytes as a quantity: a sentence, or a finite number that is not negative.
#include <cmath>
#include <cstdint>

#include "cli/options/units.h"
#include "tests/fuzz/require.h"

namespace {

void check(const tactus::cli::Quantity& quantity) { require(std::isfinite(quantity.value) && quantity.value >= 0); }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactus::cli;
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  const auto dimension = static_cast<Dimension>(data[0] % 5);
  const auto quantity = parse_quantity(text, dimension);
  if (quantity) check(*quantity);
  else require(!quantity.error().empty());
  if (const auto bound = parse_pose_bound(text)) check(bound->length), check(bound->angle);
  return 0;
}
