// SPDX-License-Identifier: Apache-2.0
/// Commands, their options and what they do. CLI11 stands behind this, in command.cpp alone: its headers take longer to compile than
/// any file of ours.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/options/option_needs.h"
#include "cli/report/messages.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tactus::cli {

/// What was typed is looked at before it is stored.
struct Check {
  /// in   how     its answer: empty, or a sentence that names what was typed and says what is wrong
  ///      within  what it accepts, for the list of keys: "0.1% to 100%"; empty: the help says it
  template <std::invocable<const std::string&> Look>
  Check(Look how, std::string within = {}) : look(std::move(how)), range(std::move(within)) {}

  std::function<std::string(const std::string& typed)> look;
  std::string range;
};

/// The name of an option that is a key of --tune: key("rings") is typed as --tune rings=M, and called so in messages.
std::string key(std::string_view name);

/// End the parsing: what was typed for an option (or was not) is a wrong use of the command.
[[noreturn]] void refuse_option(const std::string& option, const std::string& why);
[[noreturn]] void miss_option(const std::string& option);

/// What the help says of an option or a positional argument.
struct OptionText {
  std::vector<std::string> names{};        ///< "-o", "--output"; of an argument or a key its name
  std::string value{}, help{}, heading{};  ///< value: how it is called, empty for flags and arguments
  std::vector<std::string> choices{};      ///< all values there are; empty: any. Of --tune the keys, with their "="
  bool is_argument = false, is_required = false, takes_value = false, is_repeated = false;
};

/// What the help says of a command: man pages and shell completion are made from it.
struct CommandText {
  std::vector<std::string> words{};  ///< "tactus", "import", "csv"
  std::string help{}, heading{}, footer{};
  std::vector<OptionText> options{};
  std::vector<OptionText> keys{};  ///< of --tune
  std::vector<CommandText> commands{};
};

/// An option, a key of --tune or a positional argument. Its methods return it, so that they can be chained.
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
  std::string name() const;   ///< the long one: "--deadband", "--tune rings"
  bool is_key() const;
  OptionText text() const;

 private:
  CLI::Option* option_;
  std::vector<std::string> choices_;
  std::string range_;
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
  /// A key of --tune that takes on or off.   in  name  from key()
  Option* add_switch(const std::string& name, bool& value, const std::string& help);
  void footer(const std::string& text);
  void on_parsed(const std::function<void()>& look);  ///< called when all of its options are read
  /// Called when it was typed, after on_parsed.   pre  all of its options were added: --tune comes last
  void on_chosen(const std::function<void()>& react);

  const Option* find(const std::string& name) const;  ///< "--rate", "--tune rings"; nullptr: it has no such option
  std::string help_of_typed() const;                  ///< of the group of commands that was typed, or its own
  /// in   words  of a command below this one: "import", "csv";   err  there is no such command, or it was left out
  tl::expected<std::string, Failure> help_of(std::span<const std::string> words) const;
  CommandText text() const;          ///< of it and of all below it
  std::string help_of_keys() const;  ///< of --tune

 protected:
  CLI::App* app_;

 private:
  Option* keep(CLI::Option* option);
  void add_tune();
  Failure lack() const;  ///< of one that is left out

  std::deque<Option> options_;
  std::deque<Command> commands_;
  std::string needs_;               ///< the option of CMake that would bring it, empty: it is there
  std::vector<std::string> tuned_;  ///< what was typed for --tune and is no list of KEY=VALUE
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
