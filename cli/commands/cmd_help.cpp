// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <filesystem>

#include "cli/commands/commands.h"
#include "cli/manual/manual.h"
#include "cli/output.h"

namespace tactus::cli {

// ==== cmd help ====

namespace {

struct HelpOptions {
  std::vector<std::string> words;
  std::string man_pages;
};

Outcome write_pages(const CommandText& command, const std::filesystem::path& folder) {
  TACTUS_TRY(OutputFile file, OutputFile::create((folder / man_page_name(command)).string(), OutputFile::Existing::replace));
  TACTUS_TRY(const auto out, file.open());
  *out << man_page(command);
  TACTUS_CHECK(file.keep());
  for (const CommandText& inner : command.commands) TACTUS_CHECK(write_pages(inner, folder));
  return {};
}

Outcome run_help(const Command& app, const HelpOptions& options) {
  if (!options.man_pages.empty()) return write_pages(app.text(), options.man_pages);
  if (!options.words.empty() && is_script(options.words.front())) {
    std::vector<std::string> words(options.words.begin() + 1, options.words.end());
    words.emplace_back("--help");
    return run_script(options.words.front(), words);
  }
  TACTUS_TRY(const std::string help, app.help_of(options.words));
  fmt::print("{}", help);
  return {};
}

}  // namespace

void setup_help(Command& app, Action& action) {
  auto options = std::make_shared<HelpOptions>();
  Command& command = app.add_command("help", "Show the help of a command");
  Option* words = command.add_option("COMMAND", options->words, "Its name; in a group such as `import` two words")->type_name("");
  command.add_option("--man", options->man_pages, "Write the man pages of all commands into this folder")
      ->type_name("FOLDER")
      ->excludes(words);
  command.footer(
      "Examples:\n"
      "  tactus help encode\n"
      "  tactus help import csv");
  command.on_chosen([&action, &app, options] { action = [&app, options] { return run_help(app, *options); }; });
}

// ==== cmd completion ====

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
