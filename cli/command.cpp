// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <string_view>

#include "cli/options/headings.h"

namespace tactus::cli {

// A key of --tune is an option with a name that nobody types. Program::parse() writes --tune K=V,L=W as --tune.K=V --tune.L=W.

namespace {

constexpr std::string_view kTune = "--tune", kKey = "--tune.", kShownKey = "--tune ";

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) text.replace(at, from.size(), to);
}

/// As people type them.
std::string shown_keys(std::string text) {
  replace_all(text, kKey, kShownKey);
  return text;
}

bool is_key(const CLI::Option& option) { return ("--" + option.get_single_name()).starts_with(kKey); }

std::string words_of(const CLI::App& app) {
  return (app.get_parent() != nullptr ? words_of(*app.get_parent()) + " " : "") + app.get_name();
}

/// A help without keys.
class Formatter : public CLI::Formatter {
 public:
  std::string make_group(std::string group, bool is_positional, std::vector<const CLI::Option*> options) const override {
    std::erase_if(options, [](const CLI::Option* option) { return is_key(*option); });
    return options.empty() ? std::string() : CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
  }
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string out = shown_keys(CLI::Formatter::make_help(app, std::move(name), mode));
    for (std::size_t at = 0; (at = out.find("\n\n\n\n", at)) != std::string::npos;) out.erase(at, 1);  // where a group was
    return out;
  }
};

}  // namespace

std::string key(std::string_view name) { return std::string(kKey).append(name); }

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
  if (!check.range.empty()) range_ = check.range;
  option_->check(CLI::Validator([look = check.look](const std::string& typed) { return look(typed); }, ""));
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
std::string Option::name() const { return shown_keys(option_->get_name()); }
bool Option::is_key() const { return cli::is_key(*option_); }

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
  if (!is_key()) return text;
  text.names = {name().substr(kShownKey.size())};
  if (!range_.empty()) text.help.insert(std::min(text.help.rfind(" ["), text.help.size()), fmt::format("; {}", range_));
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
  const std::string name = shown_keys(option->get_name());
  option->group(app_->get_parent() != nullptr ? heading_of(name, app_->get_parent()->get_name()) : "Options");
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

Option* Command::add_switch(const std::string& name, bool& value, const std::string& help) {
  const auto read = [&value](const std::string& typed) { value = typed == "on"; };
  return add_option(name, read, help)->one_of({"on", "off"})->type_name("on|off");
}

void Command::add_tune() {
  const std::string list = words_of(*app_) + " --help-tune";
  add_option(std::string(kTune), tuned_, fmt::format("Tune how it is done; repeatable, or K=V,L=W ({} lists the keys)", list))
      ->type_name("KEY=VALUE")
      ->one_value()
      ->check([](const std::string& typed) { return fmt::format("'{}': must be KEY=VALUE", typed); });
  app_->add_flag_callback("--help-tune",
                          [this] {
                            fmt::print("{}", help_of_keys());
                            throw CLI::CallForAllHelp();
                          })
      ->group("");
}

void Command::footer(const std::string& text) { app_->footer(text); }
void Command::on_parsed(const std::function<void()>& look) { app_->parse_complete_callback(look); }
void Command::on_chosen(const std::function<void()>& react) {
  if (std::ranges::any_of(options_, &Option::is_key)) add_tune();
  app_->callback(react);
}

const Option* Command::find(const std::string& name) const {
  const auto found = std::ranges::find(options_, name, &Option::name);
  return found == options_.end() ? nullptr : &*found;
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

std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return !is_key(*o); }))
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<std::string> names_of_keys(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return is_key(*o); }))
    names.push_back(("--" + option->get_single_name()).substr(kKey.size()));
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

std::string list_of_keys(const CLI::App& app) { return fmt::format("`{} --help-tune` lists the keys.", words_of(app)); }

/// in   typed  with its value, if that was typed with it
Failure unknown_option(const std::string& typed, const CLI::App& app) {
  const std::string name = typed.substr(0, typed.find('='));
  const std::vector<std::string> keys = names_of_keys(app);
  if (name.starts_with(kKey) && !keys.empty()) {
    const std::string key = name.substr(kKey.size());
    return {fmt::format("{} has no key {} of --tune{}", words_of(app), key, did_you_mean(key, keys)), list_of_keys(app),
            Failure::Cause::arguments};
  }
  if (name.starts_with(kKey)) return unknown_option(std::string(kTune), app);
  Failure out =
      wrong_use(fmt::format("{} has no option {}{}", words_of(app), typed, did_you_mean(name, names_of_options(app))), app);
  if (const std::string now = key_instead_of(name, keys); !now.empty()) {
    out.text = fmt::format("{} has no option {}", words_of(app), typed);
    out.remedy = fmt::format("{} is now --tune {}{}", name, now, now.ends_with('.') ? "" : ".");
  }
  return out;
}

Failure wrong_use(const CLI::ParseError& error, const CLI::App& app) {
  const auto left = app.remaining();
  const auto option = std::find_if(left.begin(), left.end(), [](const std::string& word) { return word.starts_with("--"); });
  if (option != left.end()) return unknown_option(*option, app);
  if (!left.empty() && !names_of_commands(app).empty()) return unknown_command(left.front(), app);
  Failure out = wrong_use(shown_keys(error.what()), app);
  if (out.text.starts_with(kTune)) out.remedy = list_of_keys(app);
  return out;
}

/// "nugget=5%,fixed=1mm,2deg" as two options. What has no "=" belongs to the value before it.   out  nothing: it is no such list
std::vector<std::string> options_of(std::string_view list) {
  std::vector<std::string> out;
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    const std::string_view part = list.substr(0, comma);
    if (const std::size_t sign = part.find('='); sign != std::string_view::npos) {
      if (sign == 0 || part.starts_with('-') || sign + 1 == part.size()) return {};
      out.push_back(key(part));
    } else {
      if (out.empty()) return {};
      out.back().append(",").append(part);
    }
    if (comma == std::string_view::npos) return out;
    list.remove_prefix(comma + 1);
  }
  return {};  // ends with a comma
}

/// Words as they are parsed, the last one first: each list of keys is written out.
std::vector<std::string> written_out(int argc, char** argv) {
  std::vector<std::string> out;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool has_next = word == kTune && i + 1 < argc, has_own = word.starts_with("--tune=");
    const auto options =
        has_next || has_own ? options_of(has_own ? word.substr(kTune.size() + 1) : argv[i + 1]) : std::vector<std::string>{};
    if (options.empty()) {
      out.emplace_back(word.starts_with(kKey) ? kTune : word);  // the names of keys are nobody's to type
      continue;
    }
    out.insert(out.end(), options.begin(), options.end());
    if (has_next) ++i;
  }
  std::ranges::reverse(out);
  return out;
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
  for (const Option& option : options_) (option.is_key() ? text.keys : text.options).push_back(option.text());
  for (OptionText& option : text.options)
    if (option.names.front() == kTune)
      for (const OptionText& key : text.keys) option.choices.push_back(key.names.front() + "=");
  for (const Command& command : commands_)
    if (command.needs_.empty()) text.commands.push_back(command.text());
  return text;
}

std::string Command::help_of_keys() const {
  std::string out =
      fmt::format("Keys of {} --tune KEY=VALUE; repeat it, or separate pairs by commas: --tune K=V,L=W\n", words_of(*app_));
  std::vector<std::string> headings;
  const std::vector<OptionText> keys = text().keys;
  for (const OptionText& key : keys)
    if (std::ranges::find(headings, key.heading) == headings.end()) headings.push_back(key.heading);
  for (const std::string& heading : headings) {
    out += fmt::format("\n{}:\n", heading);
    for (const OptionText& key : keys) {
      if (key.heading != heading) continue;
      const std::string name = fmt::format("{}={}", key.names.front(), key.value);
      constexpr std::size_t kColumn = 32;
      out += fmt::format("  {:<{}}{}{}\n", name, kColumn, name.size() < kColumn ? "" : "\n" + std::string(kColumn + 2, ' '),
                         key.help);
    }
  }
  return out;
}

Program::Program(const std::string& name, const std::string& help) : Program(std::make_unique<CLI::App>(help, name)) {
  app_->require_subcommand(0, 1);  // so that `help sim` has an argument, not a second command
  app_->formatter(std::make_shared<Formatter>());
  app_->get_formatter()->column_width(34);
  app_->get_formatter()->label("SUBCOMMAND", "COMMAND");
  app_->get_formatter()->label("Positionals", "Arguments");
}

Program::Program(std::unique_ptr<CLI::App> app) : Command(*app), owned_(std::move(app)) {}

Program::~Program() = default;

tl::expected<Program::Parsed, Failure> Program::parse(int argc, char** argv) {
  wants_json_ = std::any_of(argv, argv + argc, [](std::string_view word) { return word == "--json"; });
  try {
    app_->parse(written_out(argc, argv));
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app_->help());
    return Parsed::done;
  } catch (const CLI::CallForAllHelp&) {  // the keys were listed
    return Parsed::done;
  } catch (const CLI::ParseError& e) {
    return tl::unexpected(wrong_use(e, innermost(*app_)));
  }
  return Parsed::go_on;
}

}  // namespace tactus::cli
