// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/peers/measure.h"

#include <time.h>

#include <algorithm>
#include <cmath>

namespace tactus::peers {
namespace {

/// This thread's, so that other programs on the machine weigh less.
double cpu_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e6 + static_cast<double>(t.tv_nsec) * 1e-3;
}

double median(std::vector<double>& values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

double largest_error(std::span<const Vec3i> truth, std::span<const Vec3i> shown) {
  double out = 0;
  for (std::size_t v = 0; v < truth.size(); ++v) {
    const auto off = [&](std::size_t axis) { return static_cast<double>(truth[v][axis] - shown[v][axis]) / kFine; };
    out = std::max(out, norm(Vec3{off(0), off(1), off(2)}));
  }
  return out;
}

/// Sums of squares: of the errors, and of the vertices about their mean, over all frames.
struct Squares {
  double error = 0, spread = 0;

  void add(std::span<const Vec3i> truth, std::span<const Vec3i> shown) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double mean = 0;
      for (const Vec3i& p : truth) mean += p[axis];
      mean /= static_cast<double>(truth.size());
      for (std::size_t v = 0; v < truth.size(); ++v) {
        error += std::pow(truth[v][axis] - shown[v][axis], 2);
        spread += std::pow(truth[v][axis] - mean, 2);
      }
    }
  }
};

struct Recording {
  std::vector<Bytes> packets;
  std::vector<std::vector<Vec3i>> shown;
};

/// Loses the first packet from frame 5 on that changes something and that another one follows.
std::optional<bool> survives_loss(const Animation& animation, const Scheme& scheme, const Recording& recording) {
  const auto is_empty = [&](std::size_t f) {
    return recording.packets[f].empty() || recording.packets[f + 1].empty() || recording.shown[f] == recording.shown[f - 1];
  };
  std::size_t lost = 5;
  while (lost + 1 < recording.packets.size() && is_empty(lost)) ++lost;
  if (lost + 1 >= recording.packets.size()) return {};
  const auto link = scheme.make(animation);
  std::vector<Vec3i> shown(animation.rest.size());
  for (std::size_t f = 0; f < lost; ++f)
    if (!link->decode(f, recording.packets[f], shown)) return {};
  return link->decode(lost + 1, recording.packets[lost + 1], shown) && shown == recording.shown[lost + 1];
}

}  // namespace

std::optional<Measurement> measure(const Animation& animation, const Scheme& scheme) {
  const auto sender = scheme.make(animation), receiver = scheme.make(animation);
  Recording recording;
  std::vector<double> encode_us, decode_us;
  Measurement out;
  Squares squares;
  for (std::size_t f = 0; f < animation.frames.size(); ++f) {
    std::vector<Vec3i> shown(animation.rest.size());
    const double start = cpu_us();
    Bytes packet = sender->encode(f, animation.frames[f], animation.fine[f]);
    const double middle = cpu_us();
    if (!receiver->decode(f, packet, shown)) return {};
    decode_us.push_back(cpu_us() - middle);
    encode_us.push_back(middle - start);
    if (f > 0) out.bytes += static_cast<double>(packet.size());
    squares.add(animation.fine[f], shown);
    out.error = std::max(out.error, largest_error(animation.fine[f], shown));
    recording.packets.push_back(std::move(packet));
    recording.shown.push_back(std::move(shown));
  }
  out.bytes /= static_cast<double>(animation.frames.size() - 1);
  out.bits_per_vertex = 8 * out.bytes / static_cast<double>(animation.rest.size());
  out.kg_percent = 100 * std::sqrt(squares.error / squares.spread);
  out.encode_us = median(encode_us);
  out.decode_us = median(decode_us);
  out.survives = survives_loss(animation, scheme, recording);
  return out;
}

}  // namespace tactus::peers
