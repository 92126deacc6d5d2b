// SPDX-License-Identifier: Apache-2.0
#include "cli/manual/man_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "commit.h"

namespace tactus::cli {
namespace {

std::string title_of(const CommandText& command) { return fmt::format("{}", fmt::join(command.words, "-")); }

/// Text in which nothing is a request or an escape of roff.
std::string plain(std::string_view text) {
  std::string out;
  if (!text.empty() && (text.front() == '.' || text.front() == '\'')) out = "\\&";
  for (const char c : text) {
    if (c == '\\') out += "\\e";
    else if (c == '-') out += "\\-";
    else if (c == '`') out += "\\(ga";
    else if (c == '\'') out += "\\(aq";
    else if (c == '^') out += "\\(ha";
    else if (c == '~') out += "\\(ti";
    else out += c;
  }
  return out;
}

std::string bold(std::string_view text) { return "\\fB" + plain(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + plain(text) + "\\fR"; }

std::string synopsis(const CommandText& command) {
  std::string out = bold(fmt::format("{}", fmt::join(command.words, " ")));
  out += command.commands.empty() ? "" : " " + italic("COMMAND");
  for (const OptionText& option : command.options)
    if (option.is_required && !option.is_argument) out += fmt::format(" {} {}", bold(option.names.front()), italic(option.value));
  out += " [" + italic("OPTIONS") + "]";
  for (const OptionText& option : command.options) {
    if (!option.is_argument) continue;
    const std::string name = italic(option.names.front()) + (option.is_repeated ? " ..." : "");
    out += option.is_required ? " " + name : " [" + name + "]";
  }
  return out;
}

std::string option_entry(const OptionText& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ", ") + (option.is_argument ? italic(name) : bold(name));
  if (option.takes_value) names += " " + italic(option.value);
  else if (!option.choices.empty()) names += fmt::format("[={}]", italic(fmt::format("{}", fmt::join(option.choices, "|"))));
  return fmt::format(".TP\n{}\n{}{}\n", names, plain(option.help), option.is_required ? " (required)" : "");
}

/// In the order in which the headings come first.
std::string options(const CommandText& command) {
  std::vector<std::pair<std::string, std::string>> groups;
  for (const OptionText& option : command.options) {
    const std::string heading = option.is_argument ? "Arguments" : option.heading;
    auto group = std::ranges::find(groups, heading, &std::pair<std::string, std::string>::first);
    if (group == groups.end()) group = groups.insert(option.is_argument ? groups.begin() : groups.end(), {heading, {}});
    group->second += option_entry(option);
  }
  std::string out;
  for (const auto& [heading, entries] : groups) out += fmt::format(".SS {}\n{}", plain(heading), entries);
  return out.empty() ? out : ".SH OPTIONS\n" + out;
}

/// Under their headings, as the help lists them.
std::string commands(const CommandText& group) {
  std::vector<std::string> headings;
  for (const CommandText& command : group.commands)
    if (std::ranges::find(headings, command.heading) == headings.end()) headings.push_back(command.heading);
  std::string out;
  for (const std::string& heading : headings) {
    if (headings.size() > 1) out += ".SS " + plain(heading) + "\n";
    for (const CommandText& command : group.commands)
      if (command.heading == heading) out += fmt::format(".TP\n{}(1)\n{}\n", bold(title_of(command)), plain(command.help));
  }
  return out.empty() ? out : ".SH COMMANDS\n" + out;
}

/// Examples and tables keep their lines.
std::string notes(const CommandText& command) {
  if (command.footer.empty()) return {};
  std::string out = ".SH NOTES\n.nf\n";
  std::istringstream in(command.footer);
  for (std::string line; std::getline(in, line);) out += (line.empty() ? ".sp" : plain(line)) + "\n";
  return out + ".fi\n";
}

std::string see_also(const CommandText& command) {
  if (command.words.size() == 1) return {};
  std::string out = ".SH SEE ALSO\n\\fBtactus\\fR(1)";
  if (command.words.size() > 2) out += ", \\fB" + plain(command.words[0] + "-" + command.words[1]) + "\\fR(1)";
  return out + "\n";
}

}  // namespace

std::string man_page_name(const CommandText& command) { return title_of(command) + ".1"; }

std::string man_page(const CommandText& text) {
  std::string title = title_of(text);
  std::string out = fmt::format(".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}\n", plain(title), plain(text.help), synopsis(text));
  std::ranges::transform(title, title.begin(),
                         [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return fmt::format(".TH \"{}\" 1 \"{}\" \"tactus {}\" \"Tactus\"\n", plain(title), TACTUS_DATE, TACTUS_VERSION) + out +
         commands(text) + options(text) + notes(text) + see_also(text);
}

}  // namespace tactus::cli
