// SPDX-License-Identifier: Apache-2.0
#include "cli/options/options_link.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace tactus::cli {
namespace {

std::string refusal(const std::string& text) {
  const auto link = parse_link(text);
  return link ? "" : link.error();
}

TEST(OptionsLink, EveryPartIsRead) {
  const auto link = parse_link(
      "delay=20ms,jitter=500us,gamma=10ms/4ms/2s,loss=1%,burst=5,duplicates=0.02,late=3%/"
      "40ms,rate=1.5Mbit,queue=32kB,outage=1s+500ms,"
      "outage=3s+1s,seed=7");
  ASSERT_TRUE(link) << link.error();
  EXPECT_EQ(link->delay, 20'000);
  EXPECT_EQ(link->jitter, 500);
  EXPECT_EQ(link->gamma_mean, 10'000);
  EXPECT_EQ(link->gamma_deviation, 4'000);
  EXPECT_EQ(link->gamma_piece, 2'000'000);
  EXPECT_DOUBLE_EQ(link->loss, 0.01);
  EXPECT_EQ(link->burst, 5);
  EXPECT_DOUBLE_EQ(link->duplicates, 0.02);
  EXPECT_DOUBLE_EQ(link->held_back, 0.03);
  EXPECT_EQ(link->held_back_by, 40'000);
  EXPECT_EQ(link->rate, 1.5e6);
  EXPECT_EQ(link->queue, 32'000u);
  ASSERT_EQ(link->outages.size(), 2u);
  EXPECT_EQ(link->outages[0].end, 1'500'000);
  EXPECT_EQ(link->seed, 7u);
  EXPECT_EQ(parse_link("gamma=10ms/4ms")->gamma_piece, 1'000'000);
  EXPECT_EQ(parse_link("")->delay, 0);
}

TEST(OptionsLink, MistakesAreNamed) {
  EXPECT_EQ(refusal("delay=20"), "'delay=20': '20': a time needs its unit: s, ms, us or min");
  EXPECT_EQ(refusal("lag=20ms"),
            "'lag=20ms': not one of delay, jitter, gamma, delays, loss, burst, duplicates, late, rate, queue, outage, seed");
  EXPECT_EQ(refusal("delay=2h"), "'delay=2h': '2h': unknown unit 'h'; use s, ms, us or min");
  EXPECT_EQ(refusal("delay=61min"), "'delay=61min': '61min': at most 3600s");
  EXPECT_EQ(refusal("loss=2"), "'loss=2': '2': must be at most 100 %; four percent is 4% or 0.04");
  EXPECT_EQ(refusal("rate=1Gbit"), "'rate=1Gbit': '1Gbit': not a number above 0 with its unit: bit, kbit or Mbit");
  EXPECT_EQ(refusal("queue=0B"), "'queue=0B': '0B': not a number above 0 with its unit: B, kB or MB");
  EXPECT_EQ(refusal("burst=nan"), "'burst=nan': 'nan': not a number of datagrams from 1");
  EXPECT_EQ(refusal("seed=-1"), "'seed=-1': '-1': not a whole number");
  EXPECT_EQ(refusal("delay=1ms,"), "'delay=1ms,': ends with a comma");
  for (const char* text : {"delay", "=", ",", "gamma=10ms", "late=3%", "outage=3s", "outage=3s+0s", "outage=3s+1s,outage=2s+1s",
                           "loss=90%,burst=2", "gamma=0s/1ms", "gamma=1ms/1ms/10us", "delays=/nowhere/at.csv"})
    EXPECT_NE(refusal(text), "") << text;
}

TEST(OptionsLink, RecordedDelaysComeFromATable) {
  const std::string path = ::testing::TempDir() + "tactus_delays.csv";
  const auto with = [&](const std::string& text) {
    std::ofstream(path) << text;
    return parse_link("delays=" + path);
  };
  const auto link = with("time_s,delay_s\n0,0.02\n0.5,0.03\n1,0.02\n");
  ASSERT_TRUE(link) << link.error();
  ASSERT_EQ(link->recorded.size(), 3u);
  EXPECT_EQ(link->recorded[1].time, 500'000);
  EXPECT_EQ(link->recorded[1].delay, 30'000);
  EXPECT_EQ(with("t,d\n0,1\n").error(), "'delays=" + path + "': '" + path + "': the first line must be time_s,delay_s");
  EXPECT_EQ(with("time_s,delay_s\n0,0.02\n1,nan\n").error(),
            "'delays=" + path + "': '" + path + "': line 3: not a time and a delay in seconds");
  for (const char* rows :
       {"", "0,0.02\n", "1,0.02\n2,0.02\n", "0,0.02\n0,0.02\n", "0,-1\n1,0\n", "0,3601\n1,0\n", "0\n", "0,1,2\n", "0,1x\n"})
    EXPECT_FALSE(with(std::string("time_s,delay_s\n") + rows)) << rows;
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tactus::cli
