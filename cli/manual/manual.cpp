// SPDX-License-Identifier: Apache-2.0
#include "cli/manual/manual.h"

#include <fmt/format.h>
#include <algorithm>
#include <functional>
#include <sstream>

#include "commit.h"

namespace tactus::cli {

// ==== completion ====

namespace {

/// The words below the program's name: "import csv", empty for the program.
std::string path_of(const CommandText& command) {
  return fmt::format("{}", fmt::join(command.words.begin() + 1, command.words.end(), " "));
}

void for_each(const CommandText& command, const std::function<void(const CommandText&)>& visit) {
  visit(command);
  for (const CommandText& inner : command.commands) for_each(inner, visit);
}

/// In single quotes, for any of the shells.   in  own  how the shell writes such a quote inside them
std::string quoted(std::string_view text, std::string_view own) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') out += own;
    else out += c;
  }
  return out + "'";
}

/// The beginning of a help text, for one line of a list.
std::string brief(const std::string& help) {
  constexpr std::size_t kLongest = 80;
  std::size_t end = std::min(help.size(), kLongest + 1);
  for (const char* stop : {" [", " (", "; ", ": ", ". "}) end = std::min(end, help.find(stop));
  if (end > kLongest) end = std::min(help.rfind(' ', kLongest), kLongest);
  return help.substr(0, end);
}

std::vector<OptionText> options_of(const CommandText& command) {
  std::vector<OptionText> out;
  std::copy_if(command.options.begin(), command.options.end(), std::back_inserter(out),
               [](const OptionText& option) { return !option.is_argument; });
  return out;
}

/// What may stand where no option does: commands inside, or the values of an argument.
std::vector<std::pair<std::string, std::string>> words_of(const CommandText& command) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const CommandText& inner : command.commands) out.emplace_back(inner.words.back(), inner.help);
  for (const OptionText& option : command.options)
    for (const std::string& choice : option.choices)
      if (option.is_argument) out.emplace_back(choice, "");
  return out;
}

/// Patterns of `case` for "COMMAND WORD", the word being one that goes on to a command inside.
std::string steps(const CommandText& program) {
  std::vector<std::string> patterns;
  for_each(program, [&](const CommandText& group) {
    for (const CommandText& command : group.commands)
      patterns.push_back(quoted(path_of(group) + " " + command.words.back(), "'\\''"));
  });
  return fmt::format("{}", fmt::join(patterns, " | "));
}

/// One `case` line for each option with a value: "COMMAND OPTION", and the values or none.
std::string value_lines(const CommandText& program, const std::function<std::string(const OptionText&)>& list) {
  std::string out;
  for_each(program, [&](const CommandText& command) {
    for (const OptionText& option : command.options) {
      if (option.is_argument || (!option.takes_value && option.choices.empty())) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : option.names) {
        const std::string typed = path_of(command) + " " + name;
        if (option.takes_value) patterns.push_back(quoted(typed, "'\\''"));
        if (name.starts_with("--")) patterns.push_back(quoted(typed + "=", "'\\''"));
      }
      out += fmt::format("    {}) {} ;;\n", fmt::join(patterns, " | "), list(option));
    }
  });
  return out;
}

}  // namespace

std::string bash_completion(const CommandText& program) {
  std::string lines;
  for_each(program, [&](const CommandText& command) {
    std::string names, commands;
    for (const OptionText& option : options_of(command)) names += fmt::format(" {}", option.names.back());
    for (const auto& [word, help] : words_of(command)) commands += " " + word;
    lines += fmt::format("    {}) options='{}' commands='{}' ;;\n", quoted(path_of(command), "'\\''"), names.substr(1),
                         commands.empty() ? "" : commands.substr(1));
  });
  const std::string values = value_lines(program, [](const OptionText& option) {
    return option.choices.empty() ? std::string("return") : fmt::format("values='{}'", fmt::join(option.choices, " "));
  });
  return fmt::format(
      R"(# Completion of tactus in bash: source <(tactus completion bash)
_tactus() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} command='' options='' commands='' values='' i
  COMPREPLY=()
  # bash takes the = of --option=value for a word of its own
  if [[ $word == '=' ]]; then
    word='' before+='='
  elif [[ $before == '=' && COMP_CWORD -gt 2 ]]; then
    before="${{COMP_WORDS[COMP_CWORD - 2]}}="
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command ${{COMP_WORDS[i]}}" in
      {steps}) command="${{command:+$command }}${{COMP_WORDS[i]}}" ;;
    esac
  done
  case $command in
{lines}  esac
  case "$command $before" in
{values}  esac
  if [[ -n $values ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$values" -- "$word")
    [[ $values != *=* ]] || compopt -o nospace  # a key, whose value follows
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  elif [[ -n $commands ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$word")
  fi
}}
complete -o default -F _tactus tactus
)",
      fmt::arg("steps", steps(program)), fmt::arg("lines", lines), fmt::arg("values", values));
}

std::string zsh_completion(const CommandText& program) {
  const auto described = [](std::string name, const std::string& help) {  // a colon ends the name
    for (std::size_t at = 0; (at = name.find(':', at)) != std::string::npos; at += 2) name.insert(at, "\\");
    return quoted(name + ":" + brief(help), "'\\''");
  };
  std::string lines;
  for_each(program, [&](const CommandText& command) {
    std::vector<std::string> names, commands;
    for (const OptionText& option : options_of(command)) names.push_back(described(option.names.back(), option.help));
    for (const auto& [word, help] : words_of(command)) commands.push_back(described(word, help));
    lines += fmt::format("    {})\n      options=({})\n      commands=({}) ;;\n", quoted(path_of(command), "'\\''"),
                         fmt::join(names, " "), fmt::join(commands, " "));
  });
  const std::string values = value_lines(program, [](const OptionText& option) {
    return option.choices.empty() ? std::string("_files; return") : fmt::format("values=({})", fmt::join(option.choices, " "));
  });
  return fmt::format(
      R"(#compdef tactus
# Completion of tactus in zsh: source <(tactus completion zsh), or a file _tactus in $fpath
_tactus() {{
  local -a options commands values
  local command='' before=${{words[CURRENT - 1]}} i
  if [[ $PREFIX == --*=* ]]; then
    before=${{PREFIX%%=*}}=
    compset -P '*='
  fi
  for ((i = 2; i < CURRENT; ++i)); do
    case "$command ${{words[i]}}" in
      {steps}) command="${{command:+$command }}${{words[i]}}" ;;
    esac
  done
  case $command in
{lines}  esac
  case "$command $before" in
{values}  esac
  if (( $#values )); then
    if [[ $values[1] == *= ]]; then compadd -S '' -a values; else compadd -a values; fi
  elif [[ $PREFIX == -* ]]; then
    _describe option options
  elif (( $#commands )); then
    _describe command commands
  else
    _files
  fi
}}
if [[ ${{funcstack[1]}} == _tactus ]]; then _tactus "$@"; else compdef _tactus tactus; fi
)",
      fmt::arg("steps", steps(program)), fmt::arg("lines", lines), fmt::arg("values", values));
}

std::string fish_completion(const CommandText& program) {
  std::string out = fmt::format(
      R"(# Completion of tactus in fish: tactus completion fish | source
function __tactus_at
  set -l command ''
  for word in (commandline -opc)[2..-1]
    switch "$command $word"
      case {steps}
        set command (string trim -- "$command $word")
    end
  end
  test "$command" = "$argv[1]"
end
)",
      fmt::arg("steps", [&] {
        std::string patterns = steps(program);
        for (std::size_t at = 0; (at = patterns.find(" | ", at)) != std::string::npos; ++at) patterns.replace(at, 3, " ");
        return patterns;
      }()));
  for_each(program, [&](const CommandText& command) {
    const std::string at = fmt::format("complete -c tactus -n '__tactus_at \"{}\"'", path_of(command));
    for (const auto& [word, help] : words_of(command))
      out += fmt::format("{} -f -a {} -d {}\n", at, word, quoted(brief(help), "\\'"));
    for (const OptionText& option : options_of(command)) {
      out += at;
      for (const std::string& name : option.names)
        out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!option.choices.empty())
        out += fmt::format(" -{} -a '{}'", option.takes_value ? "x" : "f", fmt::join(option.choices, " "));
      else if (option.takes_value) out += " -r";
      out += fmt::format(" -d {}\n", quoted(brief(option.help), "\\'"));
    }
  });
  return out;
}

// ==== man page ====

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

std::string key_entry(const OptionText& key) {
  return fmt::format(".TP\n{}={}\n{}\n", bold(key.names.front()), italic(key.value), plain(key.help));
}

/// Options or keys, in the order in which their headings come first.
std::string listed(const std::string& title, const std::vector<OptionText>& options,
                   const std::function<std::string(const OptionText&)>& entry) {
  std::vector<std::pair<std::string, std::string>> groups;
  for (const OptionText& option : options) {
    const std::string heading = option.is_argument ? "Arguments" : option.heading;
    auto group = std::ranges::find(groups, heading, &std::pair<std::string, std::string>::first);
    if (group == groups.end()) group = groups.insert(option.is_argument ? groups.begin() : groups.end(), {heading, {}});
    group->second += entry(option);
  }
  std::string out;
  for (const auto& [heading, entries] : groups) out += fmt::format(".SS {}\n{}", plain(heading), entries);
  return out.empty() ? out : fmt::format(".SH {}\n{}", title, out);
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
         commands(text) + listed("OPTIONS", text.options, option_entry) + listed("KEYS OF \\-\\-TUNE", text.keys, key_entry) +
         notes(text) + see_also(text);
}

}  // namespace tactus::cli
