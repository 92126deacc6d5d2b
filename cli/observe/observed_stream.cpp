// SPDX-License-Identifier: Apache-2.0
#include "cli/observe/observed_stream.h"

#include <utility>

#include "cli/viewer/page.h"

namespace tactus::cli {

using Json = nlohmann::ordered_json;

Result<std::unique_ptr<ObservedStream>> ObservedStream::create(const ObservedScene& scene, const ObservedTick& first) {
  SenderOptions options = scene.sender;
  options.policy = {.key_interval = 0};  // keys are asked for at the beginning of a batch
  TACTUS_TRY(PacketLog packets, PacketLog::create(scene.declared, options));
  TACTUS_TRY(TruthData truth, TruthData::create(scene.info, first.frame, *scene.declared));
  TACTUS_TRY(std::string declaration, declaration_of(*scene.declared));
  TACTUS_TRY(Json ghost, truth.declare());
  ghost["name"] = "server";
  std::unique_ptr<ObservedStream> stream(new ObservedStream(scene, std::move(packets), std::move(truth)));
  stream->hello_ = page_json({{"version", 1},
                              {"name", scene.name},
                              {"scene", std::move(declaration)},
                              {"shapes", scene.shapes},
                              {"truth", std::move(ghost)}});
  return stream;
}

ObservedStream::ObservedStream(const ObservedScene& scene, PacketLog packets, TruthData truth)
    : frame_truth_(scene.info),
      has_loads_(scene.declared->loads.has_value()),
      key_spacing_(scene.info.tick_rate),
      packets_(std::move(packets)),
      truth_(std::move(truth)) {}

Result<void> ObservedStream::add(const ObservedTick& tick) {
  if (!is_begun_ && (key_tick_ < 0 || tick.frame.tick - key_tick_ >= key_spacing_)) {
    is_key_ = true;
    key_tick_ = tick.frame.tick;
    packets_.request_key();
    truth_.request_key();
  }
  is_begun_ = true;
  tick_ = tick.frame.tick;
  Truth truth = frame_truth_.of(tick.frame);
  if (has_loads_) truth.loads = tick.loads;
  TACTUS_CHECK(packets_.add(tick_, truth));
  return truth_.add(tick.frame, packets_.replica());
}

ObservedStream::Batch ObservedStream::take(std::uint64_t left_out) {
  Json out = packets_.take();
  out["last_tick"] = tick_;
  out["left_out"] = left_out;
  out["key"] = is_key_;
  if (is_key_) out["hashes"] = packets_.hashes();
  out["truth"] = truth_.take();
  is_begun_ = false;
  return {page_json(out), std::exchange(is_key_, false)};
}

}  // namespace tactus::cli
