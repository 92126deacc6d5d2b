// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/hid/report_descriptor.h>

#include <algorithm>
#include <array>

#include <tactus/base/rule.h>

namespace tactus::device::hid {
namespace {

constexpr std::size_t kMostNesting = 64;  // of collections, and of saved states

/// An item's data, whose sign depends on where it stands.
struct Value {
  std::uint32_t plain = 0;
  std::int32_t extended = 0;
};

struct Item {
  unsigned kind = 0;  // its first byte without the size
  std::size_t size = 0;
  Value value{};
};
// Kinds: tag and type.
constexpr unsigned kInput = 0x80, kOutput = 0x90, kFeature = 0xb0, kCollection = 0xa0, kEndCollection = 0xc0;
constexpr unsigned kUsagePage = 0x04, kLogicalLow = 0x14, kLogicalHigh = 0x24, kPhysicalLow = 0x34, kPhysicalHigh = 0x44,
                   kExponent = 0x54, kUnit = 0x64, kReportSize = 0x74, kReportId = 0x84, kReportCount = 0x94, kPush = 0xa4,
                   kPop = 0xb4;
constexpr unsigned kUsage = 0x08, kUsageLow = 0x18, kUsageHigh = 0x28;
constexpr std::uint8_t kLongItem = 0xfe;
constexpr std::uint32_t kConstant = 1, kVariable = 2;  // of an input
constexpr std::uint32_t kApplication = 1;              // of a collection

struct Globals {
  Value page, logical_low, logical_high, physical_low, physical_high, exponent, unit, size, count;
  std::uint8_t report = 0;
};

struct Usages {
  std::uint32_t low = 0, high = 0;  // with their page, or without: that of the main item counts
  bool has_page = false;
};

bool is_axis(std::uint32_t usage) noexcept { return usage >= kAxisX && usage <= kAxisRz; }
bool is_button(std::uint32_t usage) noexcept { return usage > kButtons && usage <= kButtons + kMostButtons; }

/// A limit is a plain number where the lower one is not negative.
std::int64_t upper(std::int64_t low, const Value& high) noexcept {
  return low < 0 ? std::int64_t{high.extended} : std::int64_t{high.plain};
}

class Parser {
 public:
  explicit Parser(std::span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  Result<std::vector<Field>> parse() {
    if (bytes_.size() > kMostDescriptor) return broken();
    while (at_ < bytes_.size()) {
      TACTUS_TRY(const Item item, next());
      TACTUS_CHECK(take(item));
    }
    if (depth_ != 0) return broken();
    return std::move(fields_);
  }

 private:
  tl::unexpected<Error> broken() const noexcept { return fail(Errc::malformed, "R-DEV-5", 8 * std::min(at_, bytes_.size())); }

  Result<Item> next() {
    const std::uint8_t head = bytes_[at_++];
    if (head == kLongItem) return long_item();
    constexpr std::array<std::size_t, 4> kSizes{0, 1, 2, 4};
    Item out{head & ~3u, kSizes[head & 3u]};
    if (bytes_.size() - at_ < out.size) return broken();
    for (std::size_t i = 0; i < out.size; ++i) out.value.plain |= std::uint32_t{bytes_[at_ + i]} << 8 * i;
    at_ += out.size;
    const unsigned free = static_cast<unsigned>(32 - 8 * out.size);
    out.value.extended = out.size == 0 ? 0 : static_cast<std::int32_t>(out.value.plain << free) >> free;
    return out;
  }

  /// Reserved: it says how long it is, and nothing that is known.
  Result<Item> long_item() {
    if (bytes_.size() - at_ < 2) return broken();
    const std::size_t size = bytes_[at_];
    at_ += 2;
    if (bytes_.size() - at_ < size) return broken();
    at_ += size;
    return Item{kLongItem};
  }

  Result<void> take(const Item& item) {
    switch (item.kind) {
      case kInput:
        return take_input(item.value.plain);
      case kCollection:
        return open_collection(item.value.plain);
      case kEndCollection:
        return close_collection();
      case kOutput:
      case kFeature:
        usages_.clear();
        return {};
      case kUsage:
      case kUsageLow:
      case kUsageHigh:
        return take_usage(item);
      default:
        return take_global(item);
    }
  }

  Result<void> take_global(const Item& item) {
    switch (item.kind) {
      case kUsagePage:
        now_.page = item.value;
        break;
      case kLogicalLow:
        now_.logical_low = item.value;
        break;
      case kLogicalHigh:
        now_.logical_high = item.value;
        break;
      case kPhysicalLow:
        now_.physical_low = item.value;
        break;
      case kPhysicalHigh:
        now_.physical_high = item.value;
        break;
      case kExponent:
        now_.exponent = item.value;
        break;
      case kUnit:
        now_.unit = item.value;
        break;
      case kReportSize:
        now_.size = item.value;
        break;
      case kReportCount:
        now_.count = item.value;
        break;
      case kReportId:
        return take_report_id(item.value.plain);
      case kPush:
        if (saved_.size() >= kMostNesting) return broken();
        saved_.push_back(now_);
        break;
      case kPop:
        if (saved_.empty()) return broken();
        now_ = saved_.back();
        saved_.pop_back();
        break;
      default:
        break;  // designators, strings, delimiters, long items
    }
    return {};
  }

  Result<void> take_report_id(std::uint32_t id) {
    if (id == 0 || id > 255 || used_[0] > 0) return broken();
    now_.report = static_cast<std::uint8_t>(id);
    return {};
  }

  Result<void> take_usage(const Item& item) {
    const std::uint32_t usage = item.value.plain;
    const bool has_page = item.size == 4;
    if (item.kind == kUsageHigh) {
      if (usages_.empty() || usages_.back().high != usages_.back().low || usage < usages_.back().low) return broken();
      usages_.back().high = usage;
    } else {
      usages_.push_back({usage, usage, has_page});
    }
    return {};
  }

  std::uint32_t with_page(const Usages& usages, std::uint32_t usage) const noexcept {
    return usages.has_page ? usage : now_.page.plain << 16 | usage;
  }

  Result<void> open_collection(std::uint32_t kind) {
    if (depth_ >= kMostNesting) return broken();
    if (depth_++ == 0)
      application_ = kind == kApplication && !usages_.empty() ? with_page(usages_.front(), usages_.front().low) : 0;
    usages_.clear();
    return {};
  }

  Result<void> close_collection() {
    if (depth_ == 0) return broken();
    --depth_;
    usages_.clear();
    return {};
  }

  Result<void> take_input(std::uint32_t flags) {
    const std::uint32_t size = now_.size.plain, count = now_.count.plain;
    std::uint32_t& used = used_[now_.report];
    if (size > kMostReport || count > kMostReport || std::uint64_t{size} * count > kMostReport - used) return broken();
    if (now_.report != 0 && used_[0] > 0) return broken();
    const std::uint32_t begin = used;
    used += size * count;
    const bool has_values = (flags & kConstant) == 0 && (flags & kVariable) != 0 && size >= 1 && size <= 32;
    std::uint32_t index = 0;
    for (const Usages& usages : usages_) {
      for (std::uint32_t k = 0; has_values && k <= usages.high - usages.low && index < count; ++k, ++index)
        TACTUS_CHECK(add(with_page(usages, usages.low + k), begin + index * size));
    }
    usages_.clear();
    return {};
  }

  Result<void> add(std::uint32_t usage, std::uint32_t bit) {
    if (!is_axis(usage) && !is_button(usage)) return {};
    Field out;
    out.usage = usage;
    out.application = depth_ > 0 ? application_ : 0;
    out.report = now_.report;
    out.bit = bit;
    out.size = static_cast<std::uint8_t>(now_.size.plain);
    out.logical_low = now_.logical_low.extended;
    out.logical_high = upper(out.logical_low, now_.logical_high);
    out.physical_low = now_.physical_low.extended;
    out.physical_high = upper(out.physical_low, now_.physical_high);
    out.unit = now_.unit.plain;
    if (out.physical_low >= out.physical_high) {
      out.physical_low = out.logical_low;
      out.physical_high = out.logical_high;
    }
    const std::int32_t exponent = now_.exponent.plain < 16
                                      ? static_cast<std::int32_t>(now_.exponent.plain << 28) >> 28  // four bits
                                      : now_.exponent.extended;
    if (exponent < -8 || exponent > 7 || fields_.size() >= kMostFields) return broken();
    if (is_axis(usage) && out.logical_low >= out.logical_high) return broken();
    out.exponent = static_cast<std::int8_t>(exponent);
    fields_.push_back(out);
    return {};
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  Globals now_{};
  std::vector<Globals> saved_;
  std::vector<Usages> usages_;
  std::array<std::uint32_t, 256> used_{};  // bits of each report so far
  std::size_t depth_ = 0;
  std::uint32_t application_ = 0;
  std::vector<Field> fields_;
};

}  // namespace

Result<std::vector<Field>> parse_report_descriptor(std::span<const std::uint8_t> bytes) { return Parser(bytes).parse(); }

std::optional<std::int64_t> value_in(std::span<const std::uint8_t> report, const Field& field) noexcept {
  if (field.report != 0) {
    if (report.empty() || report[0] != field.report) return std::nullopt;
    report = report.subspan(1);
  }
  const std::size_t first = field.bit / 8, last = (field.bit + field.size - 1) / 8;
  if (last >= report.size()) return std::nullopt;
  std::uint64_t bits = 0;
  for (std::size_t i = last + 1; i-- > first;) bits = bits << 8 | report[i];
  const unsigned free = 64u - field.size;
  const std::uint64_t shifted = bits >> field.bit % 8 << free;
  return field.logical_low < 0 ? static_cast<std::int64_t>(shifted) >> free : static_cast<std::int64_t>(shifted >> free);
}

}  // namespace tactus::device::hid
