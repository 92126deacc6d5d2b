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
  EXPECT_EQ(program.parse(static_cast<int>(arguments.size()), arguments.data()), Program::Parsed::go_on);
  const Outcome outcome = action ? action() : Outcome();
  return outcome ? Failure() : outcome.error();
}

TEST(Command, OneThatIsLeftOutNamesWhatBringsItWhateverFollows) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"bench"}, {"bench", "precision", "-o", "out"}, {"bench", "--help"}}) {
    Program program("tactus", "", "");
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
  Program program("tactus", "", "");
  Action action;
  program.add_command("import", "").leave_out("mesh", "TACTUS_WITH_SURFACE=ON", action);
  EXPECT_EQ(failure_of(program, action, {"import", "mesh", "folder"}).text, "this program was built without import mesh");
}

TEST(Command, AGroupTakesACommandLater) {
  Program program("tactus", "", "");
  program.add_command("import", "");
  program.add_command("export", "");
  program.command("export").add_command("mesh", "a mesh");
  EXPECT_NE(program.command("export").help_of_typed().find("a mesh"), std::string::npos);
  EXPECT_EQ(program.command("import").help_of_typed().find("a mesh"), std::string::npos);
}

}  // namespace
}  // namespace tactus::cli
