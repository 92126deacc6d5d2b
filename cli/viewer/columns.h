// SPDX-License-Identifier: Apache-2.0
/// Numbers over time, small enough for a page: each a multiple of a step, coded as the difference to the one before.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include <tactus/base/geometry.h>

namespace tactus::cli {

std::string base64(std::string_view bytes);

/// Zigzag LEB128 of the differences; a run of n zeros is the byte 0 and n - 1. The page reads it: read_columns.js.
class Column {
 public:
  explicit Column(double step = 1) : step_(step) {}

  void add(std::int64_t value);
  /// pre  finite   Values beyond +-2^52 steps are limited to that.
  void add_real(double value) { add(std::llround(std::fmin(std::fmax(value / step_, -0x1p52), 0x1p52))); }
  std::size_t size() const noexcept { return count_; }
  std::size_t bytes() const noexcept { return data_.size(); }
  /// The column so far; it begins anew.
  nlohmann::ordered_json take();

 private:
  void put(std::uint64_t value);
  void end_run();

  double step_;
  std::int64_t last_ = 0;
  std::uint64_t zeros_ = 0;
  std::size_t count_ = 0;
  std::string data_;
};

/// Three columns.
class VectorColumn {
 public:
  explicit VectorColumn(double step) : x_(step), y_(step), z_(step) {}
  void add(const Vec3& v) {
    x_.add_real(v.x);
    y_.add_real(v.y);
    z_.add_real(v.z);
  }
  std::size_t bytes() const noexcept { return x_.bytes() + y_.bytes() + z_.bytes(); }
  nlohmann::ordered_json take() { return {x_.take(), y_.take(), z_.take()}; }

 private:
  Column x_, y_, z_;
};

}  // namespace tactus::cli
