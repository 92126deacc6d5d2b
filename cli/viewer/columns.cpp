// SPDX-License-Identifier: Apache-2.0
#include "cli/viewer/columns.h"

#include <algorithm>

namespace tactus::cli {

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= count ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

void Column::add(std::int64_t value) {
  const std::int64_t difference = value - last_;
  last_ = value;
  ++count_;
  if (difference == 0) {
    ++zeros_;
    return;
  }
  end_run();
  put(static_cast<std::uint64_t>(difference) << 1 ^ static_cast<std::uint64_t>(difference >> 63));
}

void Column::end_run() {
  if (zeros_ == 0) return;
  put(0);
  put(zeros_ - 1);
  zeros_ = 0;
}

void Column::put(std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) data_ += static_cast<char>(value | 0x80);
  data_ += static_cast<char>(value);
}

nlohmann::ordered_json Column::take() {
  end_run();
  nlohmann::ordered_json out{{"step", step_}, {"count", count_}, {"data", base64(data_)}};
  *this = Column(step_);
  return out;
}

}  // namespace tactus::cli
