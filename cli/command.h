// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>

#include "cli/messages.h"
#include "cli/option_needs.h"

namespace tactus::cli {

/// What a subcommand does once it was chosen on the command line.
using Action = std::function<Outcome()>;

/// When `command` is chosen and its options agree, `action` becomes `run` with them.
template <class Options>
void on_chosen(CLI::App& command, Action& action, std::shared_ptr<const Options> options, Outcome (*run)(const Options&)) {
  command.callback([&action, &command, options, run] {
    check_options_agree(command);
    action = [options, run] { return run(*options); };
  });
}

}  // namespace tactus::cli
