// SPDX-License-Identifier: Apache-2.0
#include "cli/report/json_parts.h"

#include <nlohmann/json.hpp>

#include "cli/report/figures.h"

namespace tactus::cli {

using Json = nlohmann::ordered_json;

Json time_json(const StepTimes& t, double seconds) {
  Json out{{"count", t.count()}};
  const auto add = [&](const std::string& prefix, TimeOf which) {
    out[prefix + "p50_s"] = t.quantile(which, 0.5);
    out[prefix + "p99_s"] = t.quantile(which, 0.99);
    out[prefix + "max_s"] = t.quantile(which, 1);
    out[prefix + "total_s"] = t.total(which);
    if (seconds > 0) out[prefix + "real_time_factor"] = per(seconds, t.total(which));
  };
  add("", TimeOf::wall);
  add("cpu_", TimeOf::cpu);
  return out;
}

std::string error_json(const Failure& failure) {
  Json error{{"text", failure.text}};
  for (const auto& [name, value] :
       {std::pair("remedy", &Failure::remedy), std::pair("class", &Failure::error_class), std::pair("rule", &Failure::rule),
        std::pair("file", &Failure::file), std::pair("place", &Failure::place)})
    if (!(failure.*value).empty()) error[name] = failure.*value;
  return text_of_json({{"schema", "tactus.error/1"}, {"error", std::move(error)}});
}

std::string text_of_json(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace); }

}  // namespace tactus::cli
