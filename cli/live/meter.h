// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "cli/progress.h"

namespace tactus::cli {

/// One line on standard error that tells how a session does; drawn only on a terminal, five times per second, gone afterwards.
class Meter {
 public:
  explicit Meter(Visibility visibility);
  ~Meter();
  Meter(const Meter&) = delete;
  Meter& operator=(const Meter&) = delete;

  bool is_due(std::uint64_t now) const noexcept { return visible_ && now >= next_; }  ///< [us]
  void draw(std::uint64_t now, const std::string& text);

 private:
  bool visible_, drawn_ = false;
  std::uint64_t next_ = 0;
};

}  // namespace tactus::cli
