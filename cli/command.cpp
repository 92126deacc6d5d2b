// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <string_view>

#include "cli/options/headings.h"

namespace tactus::cli {

void refuse_option(const std::string& option, const std::string& why) { throw CLI::ValidationError(option, why); }
void miss_option(const std::string& option) { throw CLI::RequiredError(option); }

Option* Option::type_name(const std::string& name) {
  option_->type_name(name);
  return this;
}

Option* Option::required() {
  option_->required();
  return this;
}

Option* Option::check(const Check& check) {
  option_->check(CLI::Validator([check](const std::string& typed) { return check(typed); }, ""));
  return this;
}

Option* Option::one_of(const std::vector<std::string>& names) {
  choices_ = names;
  return check([names](const std::string& typed) {
    const bool known = std::find(names.begin(), names.end(), typed) != names.end();
    return known ? std::string() : fmt::format("{} not in {{{}}}{}", typed, fmt::join(names, ","), did_you_mean(typed, names));
  });
}

Option* Option::needs(const Option* other) {
  option_->needs(other->option_);
  return this;
}

Option* Option::excludes(const Option* other) {
  option_->excludes(other->option_);
  return this;
}

Option* Option::show_default() {
  option_->capture_default_str();
  return this;
}

Option* Option::one_value() {
  option_->allow_extra_args(false);
  return this;
}

std::size_t Option::count() const { return option_->count(); }
std::string Option::last() const { return option_->results().back(); }
std::string Option::name() const { return option_->get_name(); }

OptionText Option::text() const {
  OptionText text{.value = option_->get_type_name(),
                  .help = option_->get_description(),
                  .heading = option_->get_group(),
                  .choices = choices_,
                  .is_argument = option_->get_positional(),
                  .is_required = option_->get_required(),
                  .takes_value = option_->get_items_expected_min() > 0,
                  .is_repeated = option_->get_items_expected_max() > 1};
  for (const std::string& name : option_->get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option_->get_lnames()) text.names.push_back("--" + name);
  if (text.is_argument) text.names = {option_->get_name(true)};
  return text;
}

Command& Command::add_command(const std::string& name, const std::string& help) {
  return commands_.emplace_back(*app_->add_subcommand(name, help));
}

Command& Command::command(std::string_view name) {
  return *std::find_if(commands_.begin(), commands_.end(), [&](const Command& c) { return c.app_->get_name() == name; });
}

void Command::leave_out(const std::string& name, const std::string& needs, Action& action) {
  Command& command = add_command(name, "");
  command.needs_ = needs;
  command.app_->group("")->set_help_flag();
  command.app_->prefix_command();  // whatever follows its name
  command.on_chosen([&action, &command] { action = [&command]() -> Outcome { return tl::unexpected(command.lack()); }; });
}

Failure Command::lack() const {
  const bool is_in_group = app_->get_parent()->get_parent() != nullptr;
  return {"this program was built without " + (is_in_group ? app_->get_parent()->get_name() + " " : "") + app_->get_name(),
          "Build it with " + needs_ + ".", Failure::Cause::arguments};
}

void Command::heading(const std::string& heading) { app_->group(heading); }

Option* Command::keep(CLI::Option* option) {
  option->group(app_->get_parent() != nullptr ? heading_of(option->get_name(), app_->get_parent()->get_name()) : "Options");
  return &options_.emplace_back(*option);
}

Option* Command::add_option(const std::string& names, std::string& value, const std::string& help) {
  return keep(app_->add_option(names, value, help));
}

Option* Command::add_option(const std::string& names, std::vector<std::string>& values, const std::string& help) {
  return keep(app_->add_option(names, values, help));
}

Option* Command::add_option(const std::string& names, std::uint8_t& value, const std::string& help) {
  return keep(app_->add_option(names, value, help));
}

Option* Command::add_option(const std::string& names, std::uint32_t& value, const std::string& help) {
  return keep(app_->add_option(names, value, help));
}

Option* Command::add_option(const std::string& names, std::uint64_t& value, const std::string& help) {
  return keep(app_->add_option(names, value, help));
}

Option* Command::add_option(const std::string& names, std::optional<std::int64_t>& value, const std::string& help) {
  return keep(app_->add_option(names, value, help));
}

Option* Command::add_option(const std::string& names, int& value, const std::string& help) {
  return keep(app_->add_option(names, value, help));
}

Option* Command::add_option(const std::string& names, double& value, const std::string& help) {
  return keep(app_->add_option(names, value, help));
}

Option* Command::add_option(const std::string& names, const std::function<void(const std::string&)>& read,
                            const std::string& help) {
  return keep(app_->add_option_function<std::string>(names, read, help));
}

Option* Command::add_flag(const std::string& names, bool& value, const std::string& help) {
  return keep(app_->add_flag(names, value, help));
}

Option* Command::add_flag(const std::string& names, const std::function<void()>& react, const std::string& help) {
  return keep(app_->add_flag_callback(names, react, help));
}

Option* Command::add_flag(const std::string& name, const std::string& otherwise,
                          const std::function<void(const std::string&)>& read, const std::vector<std::string>& choices,
                          const std::string& help) {
  CLI::Option* const flag = app_->add_flag(name, help);
  // CLI11 says "true" where no value was typed.
  flag->transform([otherwise](const std::string& typed) { return typed == "true" ? otherwise : typed; });
  Option* const kept = keep(flag)->one_of(choices);
  flag->each(read);
  return kept;
}

void Command::footer(const std::string& text) { app_->footer(text); }
void Command::on_parsed(const std::function<void()>& look) { app_->parse_complete_callback(look); }
void Command::on_chosen(const std::function<void()>& react) { app_->callback(react); }

const Option* Command::find(const std::string& name) const {
  const CLI::Option* sought = app_->get_option_no_throw(name);
  if (sought == nullptr) return nullptr;
  for (const Option& option : options_)
    if (option.name() == sought->get_name()) return &option;
  return nullptr;
}

std::string Command::help_of_typed() const {
  const auto groups = app_->get_subcommands();
  return groups.empty() ? app_->help() : groups.front()->help(app_->get_name());
}

namespace {

/// The command that was typed: the innermost.
const CLI::App& innermost(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : innermost(*chosen.front());
}

std::string words_of(const CLI::App& app) {
  return (app.get_parent() != nullptr ? words_of(*app.get_parent()) + " " : "") + app.get_name();
}

std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// Commands of a group; those that are left out have no heading.
std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App* c) { return !c->get_group().empty(); }))
    names.push_back(command->get_name());
  return names;
}

Failure wrong_use(std::string text, const CLI::App& app) {
  return {std::move(text), fmt::format("`{} --help` lists what it takes.", words_of(app)), Failure::Cause::arguments};
}

Failure unknown_command(const std::string& word, const CLI::App& group) {
  return wrong_use(
      fmt::format("'{}' is not a command of {}{}", word, words_of(group), did_you_mean(word, names_of_commands(group))), group);
}

Failure wrong_use(const CLI::ParseError& error, const CLI::App& app) {
  const auto left = app.remaining();
  const auto option = std::find_if(left.begin(), left.end(), [](const std::string& word) { return word.starts_with("--"); });
  if (option != left.end())
    return wrong_use(fmt::format("{} has no option {}{}", words_of(app), *option,
                                 did_you_mean(option->substr(0, option->find('=')), names_of_options(app))),
                     app);
  if (!left.empty() && !names_of_commands(app).empty()) return unknown_command(left.front(), app);
  return wrong_use(error.what(), app);
}

}  // namespace

tl::expected<std::string, Failure> Command::help_of(std::span<const std::string> words) const {
  if (words.empty()) return app_->get_formatter()->make_help(app_, words_of(*app_), CLI::AppFormatMode::Normal);
  for (const Command& command : commands_) {
    if (command.app_->get_name() != words.front()) continue;
    if (!command.needs_.empty()) return tl::unexpected(command.lack());
    return command.help_of(words.subspan(1));
  }
  return tl::unexpected(unknown_command(words.front(), *app_));
}

CommandText Command::text() const {
  CommandText text{.help = app_->get_description(), .heading = app_->get_group(), .footer = app_->get_footer()};
  for (const CLI::App* app = app_; app != nullptr; app = app->get_parent())
    text.words.insert(text.words.begin(), app->get_name());
  if (CLI::Option* help = app_->get_help_ptr()) text.options.push_back(Option(*help).text());
  for (const Option& option : options_) text.options.push_back(option.text());
  for (const Command& command : commands_)
    if (command.needs_.empty()) text.commands.push_back(command.text());
  return text;
}

Program::Program(const std::string& name, const std::string& help) : Program(std::make_unique<CLI::App>(help, name)) {
  app_->require_subcommand(0, 1);  // so that `help sim` has an argument, not a second command
  app_->get_formatter()->column_width(34);
  app_->get_formatter()->label("SUBCOMMAND", "COMMAND");
  app_->get_formatter()->label("Positionals", "Arguments");
}

Program::Program(std::unique_ptr<CLI::App> app) : Command(*app), owned_(std::move(app)) {}

Program::~Program() = default;

tl::expected<Program::Parsed, Failure> Program::parse(int argc, char** argv) {
  wants_json_ = std::any_of(argv, argv + argc, [](std::string_view word) { return word == "--json"; });
  try {
    app_->parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app_->help());
    return Parsed::done;
  } catch (const CLI::ParseError& e) {
    return tl::unexpected(wrong_use(e, innermost(*app_)));
  }
  return Parsed::go_on;
}

}  // namespace tactus::cli
