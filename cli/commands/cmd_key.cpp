// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>

#include <tactus/base/shown.h>
#include <tactus/seal/key_list.h>
#include "cli/commands/commands.h"
#include "cli/output.h"

namespace tactus::cli {
namespace {

struct KeyOptions {
  std::string list, add, remove, role = "touch", output, name = "tactus";
  bool quiet = false;
};

template <class... Arguments>
void say(const KeyOptions& options, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
  if (!options.quiet) fmt::print(stderr, text, std::forward<Arguments>(arguments)...);
}

/// A new key in a new file.
tl::expected<seal::Key, Failure> make_key(const std::string& option, const std::string& name, const std::string& path) {
  if (path.empty() || path == "-")
    return refuse_arguments("--output: a key goes to a file that only its owner can read", "Name a file, like lab.key.");
  auto key = seal::Key::generate(name);
  if (!key) return refuse_arguments(fmt::format("{} {}: {}", option, shown(name), describe(key.error())), remedy(key.error()));
  if (const auto written = key->write(path); !written) {
    if (errno == EEXIST)
      return refuse(shown_path(path) + ": already exists",
                    "Choose another name, or remove it: who has that key alone can join no more then.");
    return refuse(path, written.error());
  }
  return std::move(*key);
}

tl::expected<seal::KeyList, Failure> read_list(const std::string& path) {
  auto list = seal::KeyList::read(path);
  if (list) return std::move(*list);
  if (list.error().error.code == Errc::io) return refuse(path, list.error().error);  // with the system's reason
  return refuse(list.error());
}

Outcome make_one(const KeyOptions& options) {
  if (options.output.empty()) return refuse_arguments("--output is required", "`tactus key --help` lists what it takes.");
  TACTUS_CHECK(make_key("--name", options.name, options.output));
  say(options, "wrote the key \"{}\" to {}\nCopy it to the other machines by a safe way, such as scp -p.\n", options.name,
      shown_path(options.output));
  return {};
}

Outcome add(const KeyOptions& options) {
  const Descriptor lock = lock_beside(options.list);
  std::error_code ignored;
  const bool is_new = !std::filesystem::exists(std::filesystem::symlink_status(options.list, ignored));
  seal::KeyList list;
  if (!is_new) {
    TACTUS_TRY(list, read_list(options.list));
  }
  const bool was_key = seal::Key::read(options.list).has_value();
  if (list.find(options.add) != nullptr)
    return refuse(
        fmt::format("{}: it has a user \"{}\" already", shown_path(options.list), options.add),
        fmt::format("Choose another name, or remove that user first: --remove {}. To change a role, write touch or observe "
                    "in the user's line of {}.",
                    options.add, shown_path(options.list)));
  const std::string path = options.output.empty() ? options.add + ".key" : options.output;
  const auto whole = [&](const std::string& name) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(name, ignored), ignored);
  };
  if (whole(path) == whole(options.list))
    return refuse_arguments("--output: it is the list", "Name another file for the user's key, like " + options.add + ".key.");
  TACTUS_TRY(auto key, make_key("--add", options.add, path));
  const auto added = list.add(std::move(key), options.role == "touch" ? seal::Role::touch : seal::Role::observe);
  const auto written = added ? list.write(options.list) : added;
  if (!written) {
    const int cause = errno;
    std::remove(path.c_str());
    errno = cause;
    return refuse(options.list, written.error());
  }
  const std::string shown_list = shown_path(options.list);
  say(options, "added \"{}\"{} to {} and wrote the key to {}\n", options.add,
      options.role == "touch" ? "" : " (who may only look on)", shown_list, shown_path(path));
  if (was_key)
    say(options, "{} was the key of \"{}\" and is a list now, with that user in it: copies of it go on working for clients\n",
        shown_list, list.users().front().name());
  say(options,
      "Copy {0} to the user's machine by a safe way, such as scp -p, and remove it here. There: tactus join SERVER --key {0}\n",
      shown_path(path));
  if (is_new) say(options, "Here: tactus serve SCENE --key {}\n", shown_list);
  else say(options, "A server that runs with {} takes the user within 2 s.\n", shown_list);
  return {};
}

Outcome remove(const KeyOptions& options) {
  const Descriptor lock = lock_beside(options.list);
  TACTUS_TRY(auto list, read_list(options.list));
  if (seal::Key::read(options.list))
    return refuse(shown_path(options.list) + ": the key of one user, not a list",
                  "Stop the server that uses it and delete the file; `tactus key LIST --add NAME` makes a list.");
  if (!list.remove(options.remove))
    return refuse(fmt::format("{}: it has no user \"{}\"", shown_path(options.list), shown(options.remove)),
                  fmt::format("`tactus key {}` shows who is in it.", shown_path(options.list)));
  if (const auto written = list.write(options.list); !written) return refuse(options.list, written.error());
  say(options, "removed \"{}\" from {}: a server that runs ends this user's sessions within 2 s\n", options.remove,
      shown_path(options.list));
  return {};
}

Outcome show(const KeyOptions& options) {
  TACTUS_TRY(const auto list, read_list(options.list));
  std::size_t width = 0;
  for (const seal::KeyList::User& user : list.users()) width = std::max(width, user.name().size());
  for (const seal::KeyList::User& user : list.users()) fmt::print("{:<{}}  {}\n", user.name(), width, name_of(user.role));
  return {};
}

Outcome run_key(const KeyOptions& options) {
  if (options.list.empty()) return make_one(options);
  if (!options.add.empty()) return add(options);
  return options.remove.empty() ? show(options) : remove(options);
}

}  // namespace

void setup_key(Command& app, Action& action) {
  auto options = std::make_shared<KeyOptions>();
  Command& command = app.add_command("key", "Make keys for sealed sessions, one for each user or one for all");
  Option* const list =
      command.add_option("LIST", options->list, "The server's list of users, to be shown or changed")->type_name("");
  Option* const added = command.add_option("--add", options->add, "Add a user: a new key in LIST, and in a file for the user")
                            ->needs(list)
                            ->type_name("NAME");
  command.add_option("--role", options->role, "What the added user may do: touch, or only observe")
      ->one_of({"touch", "observe"})
      ->show_default()
      ->needs(added)
      ->type_name("ROLE");
  Option* const removed =
      command.add_option("--remove", options->remove, "Remove a user from LIST")->needs(list)->excludes(added)->type_name("NAME");
  command
      .add_option("-o,--output", options->output, "File to make for the key; only its owner can read it [with --add: NAME.key]")
      ->excludes(removed)
      ->type_name("FILE");
  command.add_option("--name", options->name, "Without LIST, what the ends call the key: 1 to 64 letters, digits, . _ -")
      ->show_default()
      ->excludes(list)
      ->type_name("NAME");
  command.add_flag("-q,--quiet", options->quiet, "Print nothing but errors and what was asked for");
  command.footer(
      "A key is a name and 256 random bits. The name is not secret: it is seen on the network. All files are for their owner "
      "alone\n"
      "(mode 0600). `tactus serve` looks at its list once a second: users come and go while it runs.\n\n"
      "A key for each user:\n"
      "  tactus key lab.keys --add anna                    # anna.key is hers: scp -p anna.key her-machine:\n"
      "  tactus key lab.keys --add ben --role observe      # he may only look on\n"
      "  tactus key lab.keys                               # who is in it\n"
      "  tactus serve rotate-push-lift --listen 192.0.2.1:7447 --key lab.keys\n"
      "  tactus join 192.0.2.1:7447 --key anna.key --scene rotate-push-lift        # on her machine\n"
      "  tactus key lab.keys --remove ben\n"
      "A role is a word of the user's line in lab.keys: change it there, and the key stays.\n"
      "One key for all, who are equal then:\n"
      "  tactus key -o lab.key --name lab\n"
      "  tactus serve rotate-push-lift --listen 192.0.2.1:7447 --key lab.key");
  on_chosen<KeyOptions>(command, action, options, run_key);
}

}  // namespace tactus::cli
