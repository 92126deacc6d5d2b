// SPDX-License-Identifier: Apache-2.0
/// tactus-study STUDY [REQUEST]: one point of one study as one JSON object. The scripts of lab/ run it, once for each point.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <span>
#include <string>
#include <string_view>

#include "cli/output.h"
#include "lab/study/program/points.h"

namespace tactus::study {
namespace {

struct Study {
  std::string_view name, about;
  Json (*run)(Request&);
};
constexpr Study kStudies[]{
#ifdef TACTUS_HAS_FEM
    {"precision", "error against run time of a method at a step, its reference, or the error of a mesh", precision_point},
#endif
    {"stability", "limits of stability of one part of the simulation", stability_point},
    {"delay", "what a round trip does to force and picture, by kind of client", delay_point},
    {"session", "a session over one network, against the truth", session_point},
    {"scale", "what a server of many clients and objects costs", scale_point},
    {"join", "how long a client takes to join over a line", join_point},
    {"signals", "what the devices and forces of a recording cost", signals_point},
    {"push", "a push along x, tick by tick", push_point},
    {"interpolations", "kinds of interpolation, sent the same packets", interpolations_point},
    {"rates", "packets to a client that is sent object states or forces", rates_point},
    {"touch", "what users of a scene feel behind a network", touch_point},
    {"press", "users press a one-dimensional object through a network", press_point},
    {"impedance", "what delay does to the impedance of an object at a client", impedance_point},
    {"round-trips", "round trips over a network with varying delay", round_trips_point},
    {"stiffness-map", "stiffness of a deformable object at each vertex of its surface", stiffness_map_point},
};

constexpr int kFailed = 1, kUsage = 2;

int fail(const cli::Failure& failure) {
  fmt::print(stderr, "error: {}\n", cli::printable(failure.text));
  if (!failure.remedy.empty()) fmt::print(stderr, "       {}\n", cli::printable(failure.remedy));
  return failure.cause == cli::Failure::Cause::arguments ? kUsage : kFailed;
}

void print_usage(std::FILE* out) {
  fmt::print(out,
             "Usage: tactus-study STUDY [REQUEST]\n"
             "Compute one point of a study. REQUEST is a JSON object, such as '{{\"scene\": \"push-cube\", \"round_trip_us\": "
             "50000}}'.\n\n");
  for (const Study& study : kStudies) fmt::print(out, "  {:<15}{}\n", study.name, study.about);
}

Json parse(const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) refuse_request("the request is no JSON object", "Give one such as '{\"scene\": \"push-cube\"}'.");
  return json;
}

int run(std::span<char*> arguments) {
  if (arguments.size() == 2 && std::string_view(arguments[1]) == "--help") return print_usage(stdout), 0;
  if (arguments.size() < 2 || arguments.size() > 3) return print_usage(stderr), kUsage;
  for (const Study& study : kStudies) {
    if (study.name != arguments[1]) continue;
    Request request(parse(arguments.size() == 3 ? arguments[2] : "{}"));
    const Json result = study.run(request);
    fmt::print("{}\n", result.dump(-1, ' ', false, Json::error_handler_t::replace));
    if (const auto written = cli::check_standard_output(); !written) return fail(written.error());
    return 0;
  }
  refuse_request(fmt::format("there is no study \"{}\"", arguments[1]), "`tactus-study --help` lists them.");
}

}  // namespace
}  // namespace tactus::study

int main(int argc, char** argv) {
  using namespace tactus;
  try {
    return study::run({argv, static_cast<std::size_t>(argc)});
  } catch (const study::Refused& refused) {
    return study::fail(refused.failure);
  } catch (const std::exception& e) {
    return study::fail(cli::refuse(std::string("the program has a defect: ") + e.what(), "Report it with the request.").value());
  }
}
