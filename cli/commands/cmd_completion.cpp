// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include "cli/manual/completion.h"

namespace tactus::cli {

void setup_completion(Command& app, Action& action) {
  auto shell = std::make_shared<std::string>();
  Command& command = app.add_command("completion", "Print a script by which a shell completes commands and options");
  command.add_option("SHELL", *shell, "bash, zsh or fish")->one_of({"bash", "zsh", "fish"})->type_name("")->required();
  command.footer(
      "Examples, for the shell in which they are typed:\n"
      "  source <(tactus completion bash)\n"
      "  tactus completion fish | source\n"
      "An installed package brings the scripts to where each shell looks for them.");
  command.on_chosen([&action, &app, shell] {
    action = [&app, shell]() -> Outcome {
      const auto script = *shell == "bash" ? bash_completion : *shell == "zsh" ? zsh_completion : fish_completion;
      fmt::print("{}", script(app.text()));
      return {};
    };
  });
}

}  // namespace tactus::cli
