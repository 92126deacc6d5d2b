// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>

#include "cli/messages.h"

namespace tactus::cli {

/// What a subcommand does once it was chosen on the command line.
using Action = std::function<Outcome()>;

/// When `command` is chosen, `action` becomes `run` with these options.
template <class Options>
void on_chosen(CLI::App& command, Action& action, std::shared_ptr<const Options> options, Outcome (*run)(const Options&)) {
  command.callback([&action, options, run] { action = [options, run] { return run(*options); }; });
}

}  // namespace tactus::cli
