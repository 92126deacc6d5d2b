// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/text.h>

#include <algorithm>
#include <utility>

#include <tactus/base/shown.h>

namespace tactus {
namespace {

constexpr char32_t kReplacement = 0xFFFD;
constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF", kLittleMark = "\xFF\xFE", kBigMark = "\xFE\xFF";
constexpr std::size_t kLooked = 4;  // bytes that show the encoding

bool is_zero(std::string_view bytes, std::size_t at) noexcept { return bytes[at] == '\0'; }

}  // namespace

bool is_utf8(std::string_view text) noexcept {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

bool is_plain_name(std::string_view text) noexcept {
  const auto forbidden = [](char c) { return c == '/' || c == 0x7F || static_cast<std::uint8_t>(c) < 0x20; };
  return !text.empty() && text.size() <= 255 && std::none_of(text.begin(), text.end(), forbidden) && is_utf8(text);
}

/// Take away the mark, or recognise it by the zeros of letters and digits.
void TextDecoder::settle() {
  const std::string_view front = kept_;
  std::size_t mark = 2;
  if (front.starts_with(kUtf8Mark)) {
    encoding_ = Encoding::bytes;
    mark = kUtf8Mark.size();
  } else if (front.starts_with(kLittleMark)) {
    encoding_ = Encoding::little;
  } else if (front.starts_with(kBigMark)) {
    encoding_ = Encoding::big;
  } else {
    mark = 0;
    encoding_ = Encoding::bytes;
    if (front.size() >= kLooked && !is_zero(front, 0) && is_zero(front, 1) && !is_zero(front, 2) && is_zero(front, 3))
      encoding_ = Encoding::little;
    if (front.size() >= kLooked && is_zero(front, 0) && !is_zero(front, 1) && is_zero(front, 2) && !is_zero(front, 3))
      encoding_ = Encoding::big;
  }
  kept_.erase(0, mark);
}

void TextDecoder::put(char32_t c, std::string& text) {
  if (c == '\n' && after_return_) {
    after_return_ = false;
    return;
  }
  after_return_ = c == '\r';
  if (c == '\r') c = '\n';
  const auto tail = [&](unsigned shift) { text += static_cast<char>(0x80 | (c >> shift & 0x3F)); };
  if (c < 0x80) {
    text += static_cast<char>(c);
  } else if (c < 0x800) {
    text += static_cast<char>(0xC0 | c >> 6);
    tail(0);
  } else if (c < 0x10000) {
    text += static_cast<char>(0xE0 | c >> 12);
    tail(6);
    tail(0);
  } else {
    text += static_cast<char>(0xF0 | c >> 18);
    tail(12);
    tail(6);
    tail(0);
  }
}

void TextDecoder::take_unit(std::uint32_t unit, std::string& text) {
  const bool is_low = unit >= 0xDC00 && unit < 0xE000;
  if (high_ != 0 && is_low) {
    put(0x10000 + ((high_ - 0xD800) << 10) + (unit - 0xDC00), text);
    high_ = 0;
    return;
  }
  if (high_ != 0) put(kReplacement, text);
  high_ = unit >= 0xD800 && unit < 0xDC00 ? unit : 0;
  if (high_ == 0) put(is_low ? kReplacement : static_cast<char32_t>(unit), text);
}

void TextDecoder::take(std::string_view bytes, std::string& text) {
  if (encoding_ == Encoding::bytes) {
    for (const char c : bytes) {
      if (c == '\n' && after_return_) {
        after_return_ = false;
        continue;
      }
      after_return_ = c == '\r';
      text += after_return_ ? '\n' : c;
    }
    return;
  }
  kept_ += bytes;
  const auto byte = [&](std::size_t i) { return std::uint32_t{static_cast<std::uint8_t>(kept_[i])}; };
  std::size_t at = 0;
  for (; at + 2 <= kept_.size(); at += 2)
    take_unit(encoding_ == Encoding::little ? byte(at) | byte(at + 1) << 8 : byte(at) << 8 | byte(at + 1), text);
  kept_.erase(0, at);
}

void TextDecoder::add(std::string_view bytes, std::string& text) {
  if (encoding_ == Encoding::unknown) {
    kept_ += bytes;
    if (kept_.size() < kLooked) return;
    settle();
    const std::string begun = std::exchange(kept_, {});
    take(begun, text);
    return;
  }
  take(bytes, text);
}

bool TextDecoder::end(std::string& text) {
  if (encoding_ == Encoding::unknown) {
    settle();
    const std::string begun = std::exchange(kept_, {});
    take(begun, text);
  }
  const bool is_whole = kept_.empty() && high_ == 0;
  if (!is_whole) put(kReplacement, text);
  kept_.clear();
  high_ = 0;
  return is_whole;
}

std::string decode_text(std::string_view bytes) {
  TextDecoder decoder;
  std::string text;
  text.reserve(bytes.size());
  decoder.add(bytes, text);
  decoder.end(text);
  return text;
}

}  // namespace tactus
