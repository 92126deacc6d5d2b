// SPDX-License-Identifier: Apache-2.0
/// What one point of a study is asked for: a JSON object from the command line, whose keys are all known or refused.
#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tl/expected.hpp>
#include <type_traits>
#include <utility>

#include "cli/report/messages.h"

namespace tactus::study {

using Json = nlohmann::ordered_json;

/// Why a point was not computed. Thrown anywhere in this program, and caught by its main() alone.
struct Refused {
  cli::Failure failure;
};
[[noreturn]] inline void refuse_request(std::string text, std::string remedy) {
  throw Refused{cli::refuse_arguments(std::move(text), std::move(remedy)).value()};
}

/// The value, or the error in the words of cli::refuse(location..., error).
template <class Expected, class... Location>
auto need(Expected expected, const Location&... location) {
  if (!expected) throw Refused{cli::refuse(location..., expected.error()).value()};
  if constexpr (!std::is_void_v<typename Expected::value_type>) return *std::move(expected);
}

class Request {
 public:
  explicit Request(Json json) : json_(std::move(json)) {}

  bool has(const std::string& key) {
    asked_.insert(key);
    return json_.contains(key);
  }
  template <class T>
  T get(const std::string& key) {
    if (!has(key)) refuse_request("the request lacks \"" + key + "\"", "lab/study/README.md lists what each study takes.");
    return as<T>(key, json_.at(key));
  }
  template <class T>
  T get(const std::string& key, T otherwise) {
    return has(key) ? as<T>(key, json_.at(key)) : otherwise;
  }
  /// An object below this one; check_all_known() is for the caller to call.
  Request part(const std::string& key) { return Request(get<Json>(key)); }

  void check_all_known() const {
    for (const auto& [key, value] : json_.items())
      if (!asked_.contains(key))
        refuse_request("the study takes no \"" + key + "\"", "lab/study/README.md lists what each study takes.");
  }

 private:
  template <class T>
  static T as(const std::string& key, const Json& value) {
    bool fits = true;
    if constexpr (std::same_as<T, bool>) fits = value.is_boolean();
    else if constexpr (std::unsigned_integral<T>)
      fits = value.is_number_unsigned() && value.get<std::uint64_t>() <= std::numeric_limits<T>::max();
    else if constexpr (std::integral<T>) fits = value.is_number_integer();
    else if constexpr (std::floating_point<T>) fits = value.is_number();
    try {
      if (fits) return value.get<T>();
    } catch (const Json::exception&) {  // another type: refused below
    }
    refuse_request("\"" + key + "\": " + value.dump() + " is of another type or range",
                   "lab/study/README.md lists what each study takes.");
  }

  Json json_;
  std::set<std::string> asked_;
};

}  // namespace tactus::study
