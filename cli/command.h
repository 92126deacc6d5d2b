// SPDX-License-Identifier: Apache-2.0
/// Commands, their options and what they do. CLI11 stands behind this, in command.cpp alone: its headers take longer to compile than
/// any file of ours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/options/option_needs.h"
#include "cli/report/messages.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tactus::cli {

/// What was typed is looked at before it is stored.   out  empty, or a sentence that names it and says what is wrong
using Check = std::function<std::string(const std::string& typed)>;

/// End the parsing: what was typed for an option (or was not) is a wrong use of the command.
[[noreturn]] void refuse_option(const std::string& option, const std::string& why);
[[noreturn]] void miss_option(const std::string& option);

/// What the help says of an option or a positional argument.
struct OptionText {
  std::vector<std::string> names{};        ///< "-o", "--output"; of an argument its name
  std::string value{}, help{}, heading{};  ///< value: how it is called, empty for flags and arguments
  std::vector<std::string> choices{};      ///< all values there are; empty: any
  bool is_argument = false, is_required = false, takes_value = false, is_repeated = false;
};

/// What the help says of a command: man pages and shell completion are made from it.
struct CommandText {
  std::vector<std::string> words{};  ///< "tactus", "import", "csv"
  std::string help{}, heading{}, footer{};
  std::vector<OptionText> options{};
  std::vector<CommandText> commands{};
};

/// An option or a positional argument. Its methods return it, so that they can be chained.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}
  Option* type_name(const std::string& name);  ///< of its value in the help; "" for positional arguments
  Option* required();
  Option* check(const Check& check);
  Option* one_of(const std::vector<std::string>& names);  ///< accept these only; its help names them
  Option* needs(const Option* other);
  Option* excludes(const Option* other);
  Option* show_default();  ///< the help names the value that its variable holds now
  Option* one_value();     ///< each use of a repeated option takes one value

  std::size_t count() const;  ///< how often it was typed
  std::string last() const;   ///< as typed.   pre  count() > 0
  std::string name() const;   ///< the long one: "--deadband"
  OptionText text() const;

 private:
  CLI::Option* option_;
  std::vector<std::string> choices_;
};

/// What a command does once it was chosen.
using Action = std::function<Outcome()>;

/// A command or a group of commands. What it and its options are given by reference must outlive the parsing.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  Command& add_command(const std::string& name, const std::string& help);
  Command& command(std::string_view name);   ///< pre  it was added
  void heading(const std::string& heading);  ///< of the commands among which its group's help names it
  /// A command that this program was built without: it is in no help, and says what it wants: "TACTUS_WITH_...=ON".
  void leave_out(const std::string& name, const std::string& needs, Action& action);
  Option* add_option(const std::string& names, std::string& value, const std::string& help);
  Option* add_option(const std::string& names, std::vector<std::string>& values, const std::string& help);
  Option* add_option(const std::string& names, std::uint8_t& value, const std::string& help);
  Option* add_option(const std::string& names, std::uint32_t& value, const std::string& help);
  Option* add_option(const std::string& names, std::uint64_t& value, const std::string& help);
  Option* add_option(const std::string& names, std::optional<std::int64_t>& value, const std::string& help);
  Option* add_option(const std::string& names, int& value, const std::string& help);
  Option* add_option(const std::string& names, double& value, const std::string& help);
  /// `read` is handed what was typed, after the checks.
  Option* add_option(const std::string& names, const std::function<void(const std::string&)>& read, const std::string& help);
  Option* add_flag(const std::string& names, bool& value, const std::string& help);
  Option* add_flag(const std::string& names, const std::function<void()>& react, const std::string& help);
  /// A flag that may end in =VALUE; `read` is handed the value, `otherwise` where none was typed.
  Option* add_flag(const std::string& name, const std::string& otherwise, const std::function<void(const std::string&)>& read,
                   const std::vector<std::string>& choices, const std::string& help);
  void footer(const std::string& text);
  void on_parsed(const std::function<void()>& look);   ///< called when all of its options are read
  void on_chosen(const std::function<void()>& react);  ///< called when it was typed, after on_parsed

  const Option* find(const std::string& name) const;  ///< nullptr: it has no such option
  std::string help_of_typed() const;                  ///< of the group of commands that was typed, or its own
  /// in   words  of a command below this one: "import", "csv";   err  there is no such command, or it was left out
  tl::expected<std::string, Failure> help_of(std::span<const std::string> words) const;
  CommandText text() const;  ///< of it and of all below it

 protected:
  CLI::App* app_;

 private:
  Option* keep(CLI::Option* option);
  Failure lack() const;  ///< of one that is left out

  std::deque<Option> options_;
  std::deque<Command> commands_;
  std::string needs_;  ///< the option of CMake that would bring it, empty: it is there
};

/// The program's own command line.
class Program : public Command {
 public:
  Program(const std::string& name, const std::string& help);
  ~Program();
  enum class Parsed { go_on, done };  ///< done: help was asked for and printed
  /// err  a wrong use, with the command or option that was probably meant
  tl::expected<Parsed, Failure> parse(int argc, char** argv);
  bool wants_json() const { return wants_json_; }  ///< --json stands among the arguments

 private:
  explicit Program(std::unique_ptr<CLI::App> app);

  std::unique_ptr<CLI::App> owned_;
  bool wants_json_ = false;
};

/// When `command` is chosen and its options agree, `action` becomes `run` with them.
template <class Options>
void on_chosen(Command& command, Action& action, std::shared_ptr<const Options> options, Outcome (*run)(const Options&)) {
  command.on_chosen([&action, &command, options, run] {
    check_options_agree(command);
    action = [options, run] { return run(*options); };
  });
}

}  // namespace tactus::cli
