// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <string_view>

#include "cli/report/json_parts.h"

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

Command& Command::add_command(const std::string& name, const std::string& help) {
  return commands_.emplace_back(*app_->add_subcommand(name, help));
}

Command& Command::command(std::string_view name) {
  return *std::find_if(commands_.begin(), commands_.end(), [&](const Command& c) { return c.app_->get_name() == name; });
}

void Command::leave_out(const std::string& name, const std::string& needs, Action& action) {
  Command& command = add_command(name, "");
  command.app_->group("")->set_help_flag();
  command.app_->prefix_command();  // whatever follows its name
  const std::string whole = (app_->get_parent() != nullptr ? app_->get_name() + " " : "") + name;
  command.on_chosen([&action, whole, needs] {
    action = [whole, needs] {
      return refuse_arguments("this program was built without " + whole, "Build it with " + needs + ".");
    };
  });
}

Option* Command::keep(CLI::Option* option) { return &options_.emplace_back(*option); }

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
                          const std::function<void(const std::string&)>& read, const Check& check, const std::string& help) {
  const auto meant = [otherwise](const std::string& typed) { return typed == "true" ? otherwise : typed; };  // CLI11's for none
  CLI::Option* const flag = app_->add_flag(name, help);
  Option* const kept = keep(flag)->check([check, meant](const std::string& typed) { return check(meant(typed)); });
  flag->each([read, meant](const std::string& typed) { read(meant(typed)); });
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

Program::Program(const std::string& name, const std::string& help, const std::string& version)
    : Program(std::make_unique<CLI::App>(help, name)) {
  app_->set_version_flag("--version", version);
  app_->get_formatter()->column_width(34);
  app_->failure_message([](const CLI::App* app, const CLI::Error& e) { return printable(CLI::FailureMessage::simple(app, e)); });
}

Program::Program(std::unique_ptr<CLI::App> app) : Command(*app), owned_(std::move(app)) {}

Program::~Program() = default;

Program::Parsed Program::parse(int argc, char** argv) {
  wants_json_ = std::any_of(argv, argv + argc, [](std::string_view word) { return word == "--json"; });
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (wants_json_ && e.get_exit_code() != 0) {
      fmt::print(stderr, "{}\n", error_json({e.what(), "Run with --help for more information.", Failure::Cause::arguments}));
      return Parsed::wrong;
    }
    return app_->exit(e) == 0 ? Parsed::done : Parsed::wrong;
  }
  return Parsed::go_on;
}

}  // namespace tactus::cli
