// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/inverse3/inverse3_messages.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include <tactus/base/rule.h>

namespace tactus::device::inverse3 {
namespace {

constexpr std::size_t kMostDepth = 32;
constexpr double kMostPosition = 10, kMostVelocity = 1000;  // [m], [m/s]

enum class Key : std::uint8_t { other, inverse3, device_id, state, position, velocity, x, y, z };

Key key_of(std::string_view name) noexcept {
  constexpr std::array<std::string_view, 9> kNames{"",  "inverse3", "device_id", "state", "cursor_position", "cursor_velocity",
                                                   "x", "y",        "z"};
  const auto found = std::find(kNames.begin() + 1, kNames.end(), name);
  return found == kNames.end() ? Key::other : static_cast<Key>(found - kNames.begin());
}

bool is_id(std::string_view text) noexcept {
  const auto fits = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
  };
  return !text.empty() && text.size() <= kMostId && std::ranges::all_of(text, fits);
}

/// Follows the message; keeps a device when its object ends.
class Handler : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit Handler(std::string_view wanted) : wanted_(wanted) {}

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t number) override { return number_of(static_cast<double>(number)); }
  bool number_unsigned(number_unsigned_t number) override { return number_of(static_cast<double>(number)); }
  bool number_float(number_float_t number, const string_t&) override { return number_of(number); }
  bool string(string_t& text) override {
    if (!is_at({Key::inverse3, Key::other, Key::device_id})) return value();
    if (!is_id(text)) return false;
    device_.id = text;
    return true;
  }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override {
    if (!is_allowed_here() || !enter()) return false;
    if (depth_ == 3 && path_[0] == Key::inverse3) device_ = {}, received_ = 0;
    return true;
  }
  bool key(string_t& name) override {
    path_[depth_ - 1] = key_of(name);
    return true;
  }
  bool end_object() override {
    if (depth_ == 3 && path_[0] == Key::inverse3 && !end_device()) return false;
    return leave();
  }
  bool start_array(std::size_t) override {
    if (is_in_device() && path_[2] != Key::other) return false;
    return enter();
  }
  bool end_array() override { return leave(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override { return false; }

  std::optional<State> found;
  bool is_impossible = false;

 private:
  static constexpr unsigned kWhole = 7;  // all of a vector was received

  bool enter() {
    if (depth_ == kMostDepth) return false;
    path_[depth_++] = Key::other;
    return true;
  }
  bool leave() {
    --depth_;
    return true;
  }
  bool is_at(std::initializer_list<Key> path) const {
    return depth_ == path.size() && std::equal(path.begin(), path.end(), path_.begin());
  }
  bool is_in_device() const { return depth_ >= 3 && path_[0] == Key::inverse3; }
  bool is_vector() const {
    return depth_ >= 4 && is_in_device() && path_[2] == Key::state && (path_[3] == Key::position || path_[3] == Key::velocity);
  }
  /// No text or object stands where a number or an id is expected.
  bool is_allowed_here() const {
    const bool is_device_id = depth_ == 3 && is_in_device() && path_[2] == Key::device_id;
    return !is_device_id && !(is_vector() && depth_ > 4);
  }
  /// A value that is not a number.
  bool value() const { return is_allowed_here() && !(is_vector() && depth_ <= 5); }
  bool number_of(double number) {
    if (!is_vector() || depth_ != 5) return value();
    const bool is_velocity = path_[3] == Key::velocity;
    Vec3& vector = is_velocity ? device_.velocity : device_.position;
    const unsigned shift = is_velocity ? 3 : 0;
    if (!std::isfinite(number) || std::abs(number) > (is_velocity ? kMostVelocity : kMostPosition)) is_impossible = true;
    switch (path_[4]) {
      case Key::x:
        vector.x = number;
        break;
      case Key::y:
        vector.y = number;
        break;
      case Key::z:
        vector.z = number;
        break;
      default:
        return true;
    }
    received_ |= 1u << (shift + static_cast<unsigned>(path_[4]) - static_cast<unsigned>(Key::x));
    return true;
  }
  bool end_device() {
    const bool is_wanted = !device_.id.empty() && (wanted_.empty() || device_.id == wanted_);
    const unsigned position = received_ & kWhole, velocity = received_ >> 3;
    if ((position != 0 && position != kWhole) || (velocity != 0 && velocity != kWhole)) return false;
    if (is_wanted && position == kWhole && !found) found = device_;
    return true;
  }

  std::string_view wanted_;
  std::array<Key, kMostDepth> path_{};  // the key within each object or array that is open
  std::size_t depth_ = 0;
  State device_;
  unsigned received_ = 0;  // of the device: x, y, z of position, then of velocity
};

char* put(char* at, std::string_view text) noexcept { return std::copy(text.begin(), text.end(), at); }

}  // namespace

Result<std::optional<State>> read_state(std::string_view message, std::string_view id) {
  if (message.size() > kMostMessage) return fail(Errc::malformed, "R-DEV-5");
  Handler handler(id);
  if (!nlohmann::json::sax_parse(message, &handler)) return fail(Errc::malformed, "R-DEV-5");
  if (handler.is_impossible) return fail(Errc::invalid, "R-DEV-6");
  return std::move(handler.found);
}

std::size_t write_command(char (&out)[kMostCommand], std::string_view id, const Vec3& force) noexcept {
  constexpr int kDigits = 6;
  char* const end = out + kMostCommand;
  const auto number = [end](char* at, double value) {
    return std::to_chars(at, end, value, std::chars_format::fixed, kDigits).ptr;
  };
  char* at = put(put(put(out, R"({"inverse3":[{"device_id":")"), id), R"(","commands":{"set_cursor_force":{"values":{"x":)");
  at = put(number(at, force.x), R"(,"y":)");
  at = put(number(at, force.y), R"(,"z":)");
  at = put(number(at, force.z), "}}}}]}");
  return static_cast<std::size_t>(at - out);
}

}  // namespace tactus::device::inverse3
