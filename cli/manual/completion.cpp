// SPDX-License-Identifier: Apache-2.0
#include "cli/manual/completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace tactus::cli {
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

const OptionText kHelp{.names = {"-h", "--help"}, .help = "Print the help"};

std::vector<OptionText> options_of(const CommandText& command) {
  std::vector<OptionText> out{kHelp};
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

/// What stands before the values of an option: its name, or with `=` of a flag that may end in one.
std::string values_after(const OptionText& option, const std::string& name) { return option.takes_value ? name : name + "="; }

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
      for (const std::string& name : option.names)
        patterns.push_back(quoted(path_of(command) + " " + values_after(option, name), "'\\''"));
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
    compadd -a values
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

}  // namespace tactus::cli
