// SPDX-License-Identifier: Apache-2.0
/// A scene declaration in pieces. spec/70-session.md section 6. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/result.h>

namespace tactus {

inline constexpr std::uint64_t kPieceSize = 1024;  ///< [bytes] of all but the last
inline constexpr std::uint64_t kPieceWindow = 64;  ///< pieces that may be on their way

constexpr std::uint64_t piece_count(std::uint64_t size) noexcept { return size / kPieceSize + (size % kPieceSize > 0 ? 1 : 0); }

/// Which of the pieces are there: all below a front, and some of the window above it.
class PieceSet {
 public:
  std::uint64_t front() const noexcept { return front_; }  ///< lowest that is missing
  bool has(std::uint64_t index) const noexcept { return index < front_ || (index < front_ + kPieceWindow && bit(index) != 0); }
  void add(std::uint64_t index) noexcept {  ///< pre  below front() + kPieceWindow
    if (index < front_) return;
    window_ |= std::uint64_t{1} << (index - front_);
    for (; (window_ & 1u) != 0; window_ >>= 1) ++front_;
  }

 private:
  std::uint64_t bit(std::uint64_t index) const noexcept { return window_ >> (index - front_) & 1u; }
  std::uint64_t front_ = 0, window_ = 0;
};

class PieceSender {
 public:
  explicit PieceSender(std::shared_ptr<const std::vector<std::uint8_t>> declaration) noexcept : bytes_(std::move(declaration)) {}

  bool is_done() const noexcept { return arrived_.front() == piece_count(bytes_->size()); }
  /// The next piece to send: new, or known or supposed to be lost.   in  patience  [us] for an acknowledgement   time O(window)
  std::optional<std::uint64_t> next(std::uint64_t now, std::uint64_t patience) const noexcept;
  /// When a piece on its way is supposed to be lost; nothing is on its way: nothing.
  std::optional<std::uint64_t> due(std::uint64_t patience) const noexcept;
  std::span<const std::uint8_t> bytes(std::uint64_t index) const noexcept;
  void sent(std::uint64_t index, std::uint64_t number, std::uint64_t now) noexcept;  ///< in a datagram of this number
  void arrived(std::uint64_t number) noexcept;
  void lost(std::uint64_t number) noexcept;
  void slow_down() noexcept;  ///< pieces wait in a queue on their way: half as many at a time

 private:
  static constexpr std::uint64_t kFirst = 8, kFewest = 4;
  struct OnItsWay {
    std::uint64_t index = 0, number = 0, time = 0;  // number 0: not on its way
  };
  std::shared_ptr<const std::vector<std::uint8_t>> bytes_;
  PieceSet arrived_;
  std::array<OnItsWay, kPieceWindow> on_its_way_{};  // by index modulo the window
  std::uint64_t most_ = kFirst;                      // from the first that has not arrived on
};

class PieceReceiver {
 public:
  /// in   size, hash  of the declaration; nothing is allocated for it before its pieces come
  PieceReceiver(std::uint64_t size, std::uint64_t hash) noexcept : size_(size), hash_(hash) {}

  /// err  invalid R-SES-8: not a piece of this declaration, beyond the window, or of another length; limit_exceeded R-API-11 memory
  Result<void> take(std::uint64_t index, std::span<const std::uint8_t> bytes);
  bool is_complete() const noexcept { return have_.front() == piece_count(size_); }
  /// The declaration.   pre  is_complete()   err  checksum R-SES-10
  Result<std::span<const std::uint8_t>> declaration() const noexcept;
  std::uint64_t received() const noexcept { return have_.front() * kPieceSize; }  ///< [bytes], about
  std::uint64_t size() const noexcept { return size_; }

 private:
  std::uint64_t size_, hash_;
  PieceSet have_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace tactus
