// SPDX-License-Identifier: Apache-2.0
/// Any bytes as a stream header: an error with a rule, or a header that writes and parses to itself.
#include <cstdlib>
#include <vector>

#include <tactus/rigid/rigid_decoder.h>
#include <tactus/rigid/rigid_encoder.h>
#include <tactus/scene/scene_syntax.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactus;
  const std::vector<std::uint8_t> exact(data, data + size);  // an own block, so that one byte too far is seen
  const auto parsed = parse_header(exact);
  if (!parsed) {
    if (parsed.error().rule[0] != 'R' || parsed.error().bit_offset > 8 * size) std::abort();
    return 0;
  }
  if (parsed->size > size) std::abort();
  const auto written = write_header(parsed->header);
  if (!written) std::abort();
  const auto again = parse_header(*written);
  if (!again || write_header(again->header).value() != *written) std::abort();
  const auto decoder = RigidDecoder::create(parsed->header);
  const auto encoder = RigidEncoder::create(parsed->header);
  if (!decoder || decoder->objects().size() != parsed->header.objects.size()) std::abort();
  if (!encoder && encoder.error().code != Errc::invalid_argument) std::abort();  // thresholds finer than the grid
  return 0;
}
