// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cerrno>

#include <tactus/base/shown.h>
#include <tactus/seal/key.h>
#include "cli/commands/commands.h"

namespace tactus::cli {
namespace {

struct KeyOptions {
  std::string output, name = "tactus";
  bool quiet = false;
};

Outcome run(const KeyOptions& options) {
  if (options.output.empty() || options.output == "-")
    return refuse_arguments("--output: a key goes to a file that only its owner can read", "Name a file, like lab.key.");
  const auto key = seal::Key::generate(options.name);
  if (!key)
    return refuse_arguments(fmt::format("--name {}: {}", shown(options.name), describe(key.error())), remedy(key.error()));
  if (const auto written = key->write(options.output); !written) {
    if (errno == EEXIST)
      return refuse(shown_path(options.output) + ": already exists",
                    "Choose another name, or remove it: who has that key alone can join no more then.");
    return refuse(options.output, written.error());
  }
  if (!options.quiet)
    fmt::print(stderr, "wrote the key \"{}\" to {}\nCopy it to the other machines by a safe way, such as scp -p.\n", options.name,
               shown_path(options.output));
  return {};
}

}  // namespace

void setup_key(Command& app, Action& action) {
  auto options = std::make_shared<KeyOptions>();
  Command& command = app.add_command("key", "Make a key for sealed sessions: 256 random bits and a name");
  command.add_option("-o,--output", options->output, "File to make; only its owner can read it (mode 0600)")
      ->required()
      ->type_name("FILE");
  command.add_option("--name", options->name, "What the ends call the key: 1 to 64 letters, digits, . _ -")
      ->show_default()
      ->type_name("NAME");
  command.add_flag("-q,--quiet", options->quiet, "Print nothing but errors");
  command.footer(
      "Who has the file can take part in every session of the server that uses it. The name is not secret: it is seen on the "
      "way.\n\n"
      "Example:\n"
      "  tactus key -o lab.key --name lab\n"
      "  scp -p lab.key other:\n"
      "  tactus serve rotate-push-lift --listen 192.0.2.1:7447 --key lab.key       # here\n"
      "  tactus join 192.0.2.1:7447 --key lab.key --scene rotate-push-lift         # on the other machine");
  on_chosen<KeyOptions>(command, action, options, run);
}

}  // namespace tactus::cli
