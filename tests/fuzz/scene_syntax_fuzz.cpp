// SPDX-License-Identifier: Apache-2.0
/// Any bytes as a scene declaration: an error with a rule, or a scene that writes and parses to itself, and that both ends take.
#include <string_view>
#include <vector>

#include <tactus/receiver.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/sender.h>
#include <tactus/thesis/thesis.h>
#include "tests/fuzz/require.h"

namespace {

using namespace tactus;

constexpr DecodeLimits kLimits{.state_bytes = 1u << 24,
                               .thesis = &thesis_component};  // few bytes can ask for many states, which take long to make
constexpr DecodeLimits kParsed{.basis_work = 1u << 12, .thesis = &thesis_component};  // or for a basis

void check_ends(const SharedScene& scene) {
  const auto receiver = Receiver::create(scene, {.replica = {}, .limits = kLimits});
  if (!receiver) {
    require(state_bytes(*scene) > kLimits.state_bytes && std::string_view(receiver.error().rule) == "R-STR-18");
    return;
  }
  for (std::size_t i = 0; i < scene->deformables.size(); ++i)
    require(receiver->decoded_displacements(i).size() == scene->deformables[i].rest.size());
  const auto sender = Sender::create(scene);
  require(sender || sender.error().code == Errc::invalid_argument);  // thresholds finer than the grid
  for (std::size_t i = 0; sender && i <= scene->deformables.size() + (scene->loads ? 1 : 0); ++i)
    require(sender->state_hash(i) == receiver->state_hash(i));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::uint8_t> exact(data, data + size);  // an own block, so that one byte too far is seen
  const auto parsed = parse_scene(exact, kParsed);
  if (!parsed) {
    require(parsed.error().rule[0] == 'R' && parsed.error().bit_offset <= 8 * size);
    return 0;
  }
  require(parsed->size <= size);
  const auto written = write_scene(*parsed->scene);
  require(written.has_value());
  const auto again = parse_scene(*written, kParsed);
  require(again && write_scene(*again->scene).value() == *written);
  check_ends(parsed->scene);
  return 0;
}
