// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <gtest/gtest.h>

namespace tactus::cli {
namespace {

/// What the command that was typed says.
Failure failure_of(Program& program, const Action& action, std::vector<std::string> words) {
  words.insert(words.begin(), "tactus");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  const auto parsed = program.parse(static_cast<int>(arguments.size()), arguments.data());
  if (!parsed) return parsed.error();
  const Outcome outcome = action ? action() : Outcome();
  return outcome ? Failure() : outcome.error();
}

TEST(Command, OneThatIsLeftOutNamesWhatBringsItWhateverFollows) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"bench"}, {"bench", "precision", "-o", "out"}, {"bench", "--help"}}) {
    Program program("tactus", "");
    Action action;
    program.leave_out("bench", "TACTUS_WITH_STUDY=ON", action);
    EXPECT_EQ(program.help_of_typed().find("bench"), std::string::npos);
    const Failure failure = failure_of(program, action, words);
    EXPECT_EQ(failure.cause, Failure::Cause::arguments);
    EXPECT_EQ(failure.text, "this program was built without bench");
    EXPECT_NE(failure.remedy.find("TACTUS_WITH_STUDY=ON."), std::string::npos);
  }
}

TEST(Command, OneThatIsLeftOutOfAGroupIsNamedWithIt) {
  Program program("tactus", "");
  Action action;
  program.add_command("import", "").leave_out("mesh", "TACTUS_WITH_SURFACE=ON", action);
  EXPECT_EQ(failure_of(program, action, {"import", "mesh", "folder"}).text, "this program was built without import mesh");
}

TEST(Command, AGroupTakesACommandLater) {
  Program program("tactus", "");
  program.add_command("import", "");
  program.add_command("export", "");
  program.command("export").add_command("mesh", "a mesh");
  EXPECT_NE(program.command("export").help_of_typed().find("a mesh"), std::string::npos);
  EXPECT_EQ(program.command("import").help_of_typed().find("a mesh"), std::string::npos);
}

TEST(Command, AWrongWordNamesTheNearestCommandOrOption) {
  Program program("tactus", "");
  Action action;
  std::string file;
  Command& csv = program.add_command("import", "").add_command("csv", "a table");
  csv.add_option("--output", file, "")->required();
  program.leave_out("improve", "TACTUS_WITH_SIM", action);
  const auto text = [&](const std::vector<std::string>& words) { return failure_of(program, action, words).text; };
  EXPECT_EQ(text({"imprt"}), "'imprt' is not a command of tactus. Did you mean import?");
  EXPECT_EQ(text({"improv"}), "'improv' is not a command of tactus. Did you mean import?");  // not what is left out
  EXPECT_EQ(text({"import", "cvs"}), "'cvs' is not a command of tactus import. Did you mean csv?");
  EXPECT_EQ(text({"import", "csv", "--ouput=x"}), "tactus import csv has no option --ouput=x. Did you mean --output?");
  EXPECT_EQ(text({"import", "csv", "--sideways"}), "tactus import csv has no option --sideways");
  EXPECT_EQ(failure_of(program, action, {"import", "csv"}).remedy, "`tactus import csv --help` lists what it takes.");
}

TEST(Command, HelpOfACommandInAGroup) {
  Program program("tactus", "");
  program.add_command("import", "").add_command("csv", "a table");
  const std::vector<std::string> known{"import", "csv"}, unknown{"import", "xml"};
  EXPECT_NE(program.help_of(known)->find("Usage: tactus import csv"), std::string::npos);
  EXPECT_EQ(program.help_of(unknown).error().text, "'xml' is not a command of tactus import");
}

TEST(Command, TextsHoldWhatTheHelpHolds) {
  Program program("tactus", "all");
  std::string way;
  Command& csv = program.add_command("import", "").add_command("csv", "a table");
  csv.add_option("-w,--way", way, "How")->one_of({"up", "down"})->type_name("WAY");
  const CommandText text = program.text().commands.at(0).commands.at(0);
  EXPECT_EQ(text.words, (std::vector<std::string>{"tactus", "import", "csv"}));
  EXPECT_EQ(text.options.at(0).names, (std::vector<std::string>{"-h", "--help"}));
  const OptionText& option = text.options.at(1);
  EXPECT_EQ(option.names, (std::vector<std::string>{"-w", "--way"}));
  EXPECT_EQ(option.value, "WAY");
  EXPECT_EQ(option.choices, (std::vector<std::string>{"up", "down"}));
  EXPECT_TRUE(option.takes_value);
}

}  // namespace
}  // namespace tactus::cli
