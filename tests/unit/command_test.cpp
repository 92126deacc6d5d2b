// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <gtest/gtest.h>

namespace tactus::cli {
namespace {

TEST(Command, OneThatIsLeftOutNamesWhatBringsItWhateverFollows) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"bench"}, {"bench", "precision", "-o", "out"}, {"bench", "--help"}}) {
    Program program("tactus", "", "");
    Action action;
    program.leave_out("bench", "TACTUS_WITH_STUDY", action);
    EXPECT_EQ(program.help_of_typed().find("bench"), std::string::npos);
    std::vector<std::string> line{"tactus"};
    line.insert(line.end(), words.begin(), words.end());
    std::vector<char*> arguments;
    for (std::string& word : line) arguments.push_back(word.data());
    ASSERT_EQ(program.parse(static_cast<int>(arguments.size()), arguments.data()), Program::Parsed::go_on);
    ASSERT_TRUE(action);
    const Outcome outcome = action();
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().cause, Failure::Cause::arguments);
    EXPECT_EQ(outcome.error().text, "this program was built without bench");
    EXPECT_NE(outcome.error().remedy.find("TACTUS_WITH_STUDY=ON"), std::string::npos);
  }
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
