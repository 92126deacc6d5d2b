// SPDX-License-Identifier: Apache-2.0
#include "cli/observe/observed_stream.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include <tactus/receiver.h>

namespace tactus::cli {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes from_base64(const std::string& text) {
  static const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  Bytes out;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6 | static_cast<std::uint32_t>(kDigits.find(c));
    bits += 6;
    if (bits >= 8) out.push_back(static_cast<std::uint8_t>(group >> (bits -= 8)));
  }
  return out;
}

std::vector<std::int64_t> column(const nlohmann::json& json) {
  const Bytes bytes = from_base64(json["data"]);
  std::vector<std::int64_t> out;
  std::size_t at = 0;
  const auto number = [&] {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      value |= std::uint64_t{bytes[at] & 127U} << shift;
      if (bytes[at++] < 128) return value;
    }
  };
  std::int64_t value = 0;
  while (out.size() < json["count"].get<std::size_t>()) {
    const std::uint64_t code = number();
    if (code == 0) out.insert(out.end(), number() + 1, value);
    else out.push_back(value += static_cast<std::int64_t>(code >> 1) ^ -static_cast<std::int64_t>(code & 1));
  }
  return out;
}

/// A server with two objects, of which one rests.
class ObservedStreamTest : public ::testing::Test {
 protected:
  ObservedStreamTest() {
    scene_.info.objects = {{"cube", Dof::all}, {"rest", Dof::all}};
    scene_.info.users = {{"hand"}};
    scene_.name = "<test>";
    scene_.shapes = {{"objects", nlohmann::ordered_json::array()}};
    auto builder = scene_builder(scene_.info, tick(0).frame);
    scene_.declared = builder->declare_bounds(RigidTriggers{}, DeformableThresholds{}).baselines(64).build().value();
    stream_ = ObservedStream::create(scene_, tick(0)).value();
  }
  static ObservedTick tick(std::int64_t number) {
    ObservedTick out;
    out.frame.tick = number;
    out.frame.objects.resize(2);
    out.frame.objects[0].pose.position = {0.1 * std::sin(5e-3 * static_cast<double>(number)), 0, 0.3};
    out.frame.users.resize(1);
    out.frame.users[0].device.position = {0, 0, 1e-5 * static_cast<double>(number)};
    return out;
  }
  /// Batches of 33 ticks.
  std::vector<nlohmann::json> run(std::int64_t ticks) {
    std::vector<nlohmann::json> out;
    for (; next_ < ticks; ++next_) {
      EXPECT_TRUE(stream_->add(tick(next_)));
      if (next_ % 33 != 32) continue;
      const ObservedStream::Batch batch = stream_->take(7);
      out.push_back(nlohmann::json::parse(batch.text));
      EXPECT_EQ(out.back()["key"], batch.is_key);
    }
    return out;
  }

  ObservedScene scene_;
  std::unique_ptr<ObservedStream> stream_;
  std::int64_t next_ = 0;
};

TEST_F(ObservedStreamTest, AKeyBatchComesAtOnceAndThenEverySecond) {
  std::vector<std::int64_t> ends;
  for (const auto& batch : run(3300)) {
    EXPECT_EQ(batch["left_out"], 7);
    EXPECT_EQ(batch.contains("hashes"), batch["key"].get<bool>());
    if (batch["key"]) ends.push_back(batch["last_tick"]);
  }
  EXPECT_EQ(ends, (std::vector<std::int64_t>{32, 1055, 2078, 3101}));  // the first batch that begins a second after the last one
}

TEST_F(ObservedStreamTest, WhoBeginsLateHasTheServersStates) {
  const auto hello = nlohmann::json::parse(stream_->hello());
  EXPECT_EQ(stream_->hello().find('<'), std::string::npos);
  EXPECT_EQ(hello["name"], "<test>");
  EXPECT_EQ(from_base64(hello["scene"]), from_base64(declaration_of(*scene_.declared).value()));
  run(990);
  auto late = Receiver::create(scene_.declared).value();
  bool has_begun = false;
  int checked = 0;
  for (const auto& batch : run(4950)) {
    has_begun = has_begun || batch["key"];
    if (!has_begun) continue;
    const Bytes stream = from_base64(batch["stream"]);
    const auto offsets = column(batch["packets"]["offsets"]), sizes = column(batch["packets"]["sizes"]),
               numbers = column(batch["packets"]["numbers"]);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const auto at = static_cast<std::size_t>(offsets[i]), size = static_cast<std::size_t>(sizes[i]);
      ASSERT_LE(at + size, stream.size());
      ASSERT_TRUE(late.push(static_cast<std::uint64_t>(numbers[i]), std::span(stream).subspan(at, size)));
    }
    if (!batch["key"]) continue;
    EXPECT_EQ(batch["hashes"], nlohmann::json::array({fmt::format("{:016x}", late.state_hash(0))}));
    ++checked;
  }
  EXPECT_EQ(checked, 4);
}

TEST_F(ObservedStreamTest, ABatchHasTheTruthOfItsTicksAlone) {
  const auto batches = run(66);
  const auto& truth = batches[1]["truth"];
  std::vector<std::int64_t> ticks = column(truth["ticks"]);
  ASSERT_EQ(ticks.size(), 33u);
  EXPECT_EQ(ticks.front(), 33);
  EXPECT_EQ(column(truth["users"][0]["device"][2]).back(), 65);  // in steps of 10 um
  EXPECT_EQ(column(truth["errors"]["position"]).size(), 33u);
}

}  // namespace
}  // namespace tactus::cli
