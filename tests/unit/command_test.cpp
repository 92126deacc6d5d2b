// SPDX-License-Identifier: Apache-2.0
/// The command line.
#include <gtest/gtest.h>

#include <unistd.h>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "cli/command.h"
#include "cli/commands/input.h"
#include "cli/options/headings.h"
#include "cli/report/report.h"

namespace tactus::cli {
namespace {

// ==== command ====

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
  std::string side;
  Command& csv = program.add_command("import", "").add_command("csv", "a table");
  csv.add_option("-s,--side", side, "Which")->one_of({"up", "down"})->type_name("SIDE");
  const CommandText text = program.text().commands.at(0).commands.at(0);
  EXPECT_EQ(text.words, (std::vector<std::string>{"tactus", "import", "csv"}));
  EXPECT_EQ(text.options.at(0).names, (std::vector<std::string>{"-h", "--help"}));
  const OptionText& option = text.options.at(1);
  EXPECT_EQ(option.names, (std::vector<std::string>{"-s", "--side"}));
  EXPECT_EQ(option.value, "SIDE");
  EXPECT_EQ(option.choices, (std::vector<std::string>{"up", "down"}));
  EXPECT_TRUE(option.takes_value);
}

// ==== keys of --tune ====

/// A command with keys, which was given these words.
struct Tuned {
  explicit Tuned(std::vector<std::string> words) {
    Command& command = program.add_command("encode", "");
    command.add_option("-o,--output", output, "The output")->type_name("FILE");
    rings = command.add_option(key("rings"), count, "Rings of neighbours [3]")->check([](const std::string& typed) {
      return typed == "99" ? std::string("'99': too many") : std::string();
    });
    fixed = command.add_option(key("fixed"), bound, "The bound [none]")->type_name("LENGTH,ANGLE");
    command.add_switch(key("layered"), layered, "In layers [off]");
    command.on_chosen([] {});
    words.insert(words.begin(), "encode");
    failure = failure_of(program, action, words);
  }

  Program program{"tactus", ""};
  Action action;
  std::string output, bound;
  std::uint32_t count = 3;
  bool layered = false;
  const Option *rings = nullptr, *fixed = nullptr;
  Failure failure;
};

TEST(Keys, AreGivenOneByOneOrInAList) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--tune", "rings=5", "--tune", "layered=on", "--tune", "fixed=1mm,2deg"},
        {"--tune", "rings=5,fixed=1mm,2deg,layered=on"},
        {"--tune=fixed=1mm,2deg", "--tune=layered=on,rings=5"}}) {
    const Tuned tuned(words);
    EXPECT_EQ(tuned.failure.text, "");
    EXPECT_EQ(tuned.count, 5U);
    EXPECT_EQ(tuned.bound, "1mm,2deg");
    EXPECT_TRUE(tuned.layered);
    EXPECT_EQ(tuned.rings->count(), 1U);
    EXPECT_EQ(tuned.rings->name(), "--tune rings");
    EXPECT_EQ(tuned.rings->last(), "5");
  }
  const Tuned untuned({"-o", "x"});
  EXPECT_EQ(untuned.rings->count(), 0U);
}

TEST(Keys, WrongUsesNameWhatWouldBeRight) {
  const auto failure = [](std::vector<std::string> words) { return Tuned(std::move(words)).failure; };
  EXPECT_EQ(failure({"--tune", "ring=5"}).text, "tactus encode has no key ring of --tune. Did you mean rings?");
  EXPECT_EQ(failure({"--tune", "ring=5"}).remedy, "`tactus encode --help-tune` lists the keys.");
  EXPECT_EQ(failure({"--tune", "rings=99"}).text, "--tune rings: '99': too many");
  EXPECT_EQ(failure({"--tune", "rings=99"}).remedy, "`tactus encode --help-tune` lists the keys.");
  EXPECT_EQ(failure({"--tune", "layered=yes"}).text, "--tune layered: yes not in {on,off}");
  for (const char* typed : {"rings", "rings=", "=5", ",rings=5", "rings=5,"}) {
    EXPECT_EQ(failure({"--tune", typed}).text, std::string("--tune: '") + typed + "': must be KEY=VALUE");
    EXPECT_EQ(failure({"--tune", typed}).remedy, "`tactus encode --help-tune` lists the keys.");
  }
  EXPECT_EQ(failure({"--tune.rings", "5"}).text, "--tune: '5': must be KEY=VALUE") << "a key is no option";
  EXPECT_EQ(failure({"--rings", "5"}).text, "tactus encode has no option --rings");
  EXPECT_EQ(failure({"--rings", "5"}).remedy, "--rings is now --tune rings=...");
  EXPECT_EQ(failure({"--layered"}).remedy, "--layered is now --tune layered=on.");
  EXPECT_EQ(failure({"--jnd-share", "5%"}).text, "tactus encode has no option --jnd-share");
  EXPECT_EQ(failure({"--jnd-share", "5%"}).remedy, "`tactus encode --help` lists what it takes.") << "nor such a key";
}

TEST(Keys, AreListedApartFromTheOptions) {
  Tuned tuned({});
  Command& command = tuned.program.command("encode");
  const std::vector<std::string> words{"encode"};
  const std::string help = tuned.program.help_of(words).value();
  EXPECT_EQ(help.find("rings"), std::string::npos) << help;
  EXPECT_NE(help.find("--tune KEY=VALUE"), std::string::npos) << help;
  EXPECT_NE(help.find("tactus encode --help-tune lists the keys"), std::string::npos) << help;
  const std::string keys = command.help_of_keys();
  EXPECT_NE(keys.find("  fixed=LENGTH,ANGLE              The bound [none]\n"), std::string::npos) << keys;
  EXPECT_EQ(keys.find("--output"), std::string::npos);
  const CommandText text = command.text();
  ASSERT_EQ(text.keys.size(), 3U);
  EXPECT_EQ(text.keys[1].names, std::vector<std::string>{"fixed"});
  EXPECT_EQ(text.options.back().names, std::vector<std::string>{"--tune"});
  EXPECT_EQ(text.options.back().choices, (std::vector<std::string>{"rings=", "fixed=", "layered="}));
}

// ==== suggestion ====

const std::vector<std::string> kNames{"encode", "decode", "sim", "serve", "--quiet"};

TEST(Suggestion, OneSlipIsSeen) {
  for (const char* typed : {"encod", "encodee", "enocde", "encide"})
    EXPECT_EQ(did_you_mean(typed, kNames), ". Did you mean encode?") << typed;
  EXPECT_EQ(did_you_mean("smi", kNames), ". Did you mean sim?");
  EXPECT_EQ(did_you_mean("--quit", kNames), ". Did you mean --quiet?");
}

TEST(Suggestion, WhatIsFarFromEveryNameSuggestsNothing) {
  for (const std::string& typed : {std::string("juggle"), std::string(), std::string("s"), std::string(100000, 'e')})
    EXPECT_EQ(did_you_mean(typed, kNames), "");
  EXPECT_EQ(did_you_mean("encode", {}), "");
}

// ==== rereadable input ====

constexpr std::string_view kText = "once";

/// What remains of a pipe, whose writer is gone.
class Pipe {
 public:
  Pipe() {
    int ends[2]{};
    EXPECT_EQ(pipe(ends), 0);
    EXPECT_EQ(write(ends[1], kText.data(), kText.size()), static_cast<ssize_t>(kText.size()));
    close(ends[1]);
    end_ = ends[0];
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() { close(end_); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(end_); }

 private:
  int end_ = -1;
};

TEST(RereadableInput, APipeIsReadAgainAndAgain) {
  const Pipe pipe;
  const auto input = RereadableInput::open(pipe.path(), kText.size());
  ASSERT_TRUE(input);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(read_file(input->path()), std::string(kText));
}

TEST(RereadableInput, APipeLongerThanTheLimitIsRefused) {
  const Pipe pipe;
  EXPECT_FALSE(RereadableInput::open(pipe.path(), kText.size() - 1));
  const auto endless = RereadableInput::open("/dev/zero", 1 << 20);
  ASSERT_FALSE(endless);
  EXPECT_EQ(endless.error().text, "/dev/zero: more than 1 MiB from a pipe");
}

// ==== step times ====

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(StepTimes, StepsOfManySecondsAreWhole) {
  StepTimes times;
  for (const std::int64_t seconds : {7, 90, 20'000}) times.add({seconds * kSecond, 2 * seconds * kSecond});
  EXPECT_DOUBLE_EQ(times.quantile(TimeOf::wall, 0.5), 90);
  EXPECT_DOUBLE_EQ(times.quantile(TimeOf::wall, 1), 20'000);
  EXPECT_DOUBLE_EQ(times.quantile(TimeOf::cpu, 0), 14);
  EXPECT_DOUBLE_EQ(times.total(TimeOf::wall), 20'097);
  EXPECT_DOUBLE_EQ(times.total(TimeOf::cpu), 40'194);
}

TEST(StepTimes, WaitingTakesWallTimeButNoCpuTime) {
  using namespace std::chrono_literals;
  StepTimes times;
  times.measure([] { return std::this_thread::sleep_for(50ms), 0; });
  EXPECT_GE(times.total(TimeOf::wall), 0.05);
  EXPECT_LT(times.total(TimeOf::cpu), 0.05);
}

TEST(StepTimes, WorkOfEveryThreadTakesCpuTime) {
  StepTimes times;
  times.measure([] {
    std::thread([] {
      timespec used{};
      while (used.tv_nsec < 10'000'000) clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    }).join();
    return 0;
  });
  EXPECT_GE(times.total(TimeOf::cpu), 0.01);
}

}  // namespace
}  // namespace tactus::cli
