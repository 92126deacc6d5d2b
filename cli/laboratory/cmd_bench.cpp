// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/cmd_bench.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <ostream>
#include <string_view>
#include <system_error>
#include <thread>

#include "cli/commands/commands.h"
#include "cli/version.h"

namespace tactus::cli {
namespace {

/// "AMD EPYC" of "AMD EPYC 9R14 96-Core Processor": makers write clock rates and counts behind the name.
std::string short_name(std::string_view model) {
  std::string out;
  std::size_t words = 0;
  for (std::size_t at = 0; at < model.size() && words < 2; ++words) {
    const std::size_t end = std::min(model.find(' ', at), model.size());
    out += (out.empty() ? "" : " ") + std::string(model.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

std::string machine() {
  std::ifstream in("/proc/cpuinfo");
  std::string model = "unknown processor", line;
  bool is_virtual = false;
  while (std::getline(in, line)) {
    const std::string_view text = line;
    if (const auto colon = text.find(": "); text.starts_with("model name") && colon != std::string_view::npos)
      model = short_name(text.substr(colon + 2));
    if (text.starts_with("flags")) is_virtual = text.find(" hypervisor") != std::string_view::npos;
  }
  const unsigned cores = std::thread::hardware_concurrency();
  return fmt::format("{} core{} of an {}{}", cores, cores == 1 ? "" : "s", model, is_virtual ? ", virtual machine" : "");
}

std::string compiler() {
#ifdef __clang__
  return fmt::format("clang++ {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

}  // namespace

std::map<std::string, std::string> bench_context() {
  return {{"machine", machine()}, {"compiler", compiler()}, {"build", TACTUS_BUILD_TYPE}, {"tactus", version_and_commit()}};
}

Outcome make_folder(const std::string& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) return refuse(directory + ": the folder cannot be made: " + error.message(), "Check the path and your permissions.");
  return {};
}

void setup_bench(Command& app, Action&) {
  Command& bench = app.add_command("bench", "Measure the simulation, sessions and signals");
  bench.footer("Example:\n  tactus bench stability --help");
}

}  // namespace tactus::cli
