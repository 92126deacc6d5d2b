// SPDX-License-Identifier: Apache-2.0
/// How fast an end may send: at the rate that it is given, or that it finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <tactus/session/congestion.h>

namespace tactus {
namespace {

// ==== session line rate ====

/// One line of a rate and a delay, on which senders wait for each other; one with a rate by LineRate sends whenever it may.
class SharedLine {
 public:
  /// in   rate  [bit/s];  trip  [us];  senders  by LineRate
  SharedLine(std::uint64_t rate, std::uint64_t trip, std::size_t senders) : rate_(rate), trip_(trip), senders_(senders) {
    for (Sender& sender : senders_) sender.line.begin(0);
  }
  /// in   other  [bit/s] of somebody who sends evenly, whatever happens
  void run(std::uint64_t seconds, std::uint64_t other = 0, std::size_t size = 100) {
    for (const std::uint64_t until = now_ + seconds * 1'000'000; now_ < until; now_ += 1000) {
      arrive();
      for (owed_ += other / 1000; owed_ >= 8000; owed_ -= 8000) put(1000);
      for (std::size_t k = 0; k < senders_.size(); ++k) send((k + now_ / 1000) % senders_.size(), size);
      longest_ = std::max(longest_, std::max(free_at_, now_) - now_);
    }
  }
  void set_rate(std::uint64_t rate) { rate_ = rate; }
  void set_trip(std::uint64_t trip) { trip_ = trip; }
  /// [us], since the last call
  std::uint64_t longest_queue() { return std::exchange(longest_, 0); }
  /// [bit/s] of one sender over so many seconds, since the last call
  std::uint64_t sent(std::size_t sender, std::uint64_t seconds) { return 8 * std::exchange(senders_[sender].bytes, 0) / seconds; }
  std::uint64_t rate(std::size_t sender) const { return senders_[sender].line.rate(); }
  bool is_jammed() const { return senders_[0].line.is_jammed(); }

 private:
  struct Sender {
    LineRate line;
    TokenBucket bucket{0};
    std::uint64_t number = 0, bytes = 0;
  };
  struct Answer {
    std::uint64_t at = 0, number = 0, trip = 0;
    std::size_t sender = 0;
  };
  std::uint64_t put(std::uint64_t bytes) {
    free_at_ = std::max(free_at_, now_) + 8'000'000 * bytes / rate_;
    return free_at_;
  }
  void send(std::size_t k, std::size_t size) {
    Sender& sender = senders_[k];
    const bool held = !sender.bucket.is_open(now_);
    sender.line.tick(held, now_);
    sender.bucket.set_rate(sender.line.rate(), now_);
    if (held) return;
    sender.bucket.take(static_cast<std::int64_t>(8 * size), now_);
    sender.line.sent(++sender.number, size, now_);
    sender.bytes += size;
    const std::uint64_t at = put(size) + trip_;
    answers_.push_back({at, sender.number, at - now_, k});
  }
  void arrive() {
    for (; next_ < answers_.size() && answers_[next_].at <= now_; ++next_) {
      const Answer& answer = answers_[next_];
      Sender& sender = senders_[answer.sender];
      const auto sample = static_cast<std::int64_t>(answer.trip);
      least_.add(sample, now_);
      sender.line.round_trip({sample, 1000, *least_.value()}, sample, answer.number, now_);
    }
  }

  std::uint64_t rate_, trip_, now_ = 1'000'000, free_at_ = 0, longest_ = 0, owed_ = 0;
  WindowedMinimum least_{10'000'000};
  std::vector<Sender> senders_;
  std::vector<Answer> answers_;
  std::size_t next_ = 0;
};

TEST(LineRate, FindsWhatTheLineCarries) {
  for (const std::uint64_t trip : {20'000u, 100'000u, 300'000u})
    for (const std::uint64_t rate : {100'000u, 300'000u, 600'000u}) {
      SharedLine line(rate, trip, 1);
      line.run(12);
      line.longest_queue();
      line.sent(0, 1);
      line.run(20);
      EXPECT_GT(line.sent(0, 20), rate * 8 / 10) << rate << " bit/s, " << trip << " us";
      EXPECT_LT(line.longest_queue(), 200'000u) << rate << " bit/s, " << trip << " us: 800 kbit/s are there to be sent";
      EXPECT_FALSE(line.is_jammed());
    }
}

TEST(LineRate, ALineThatCarriesAllHasNoLimit) {
  SharedLine line(900'000, 40'000, 1);  // 800 kbit/s are sent
  line.run(30);
  EXPECT_EQ(line.rate(0), 0u);
  EXPECT_LT(line.longest_queue(), 2'000u);
}

TEST(LineRate, FollowsALineThatChanges) {
  SharedLine line(400'000, 40'000, 1);
  line.run(10);
  line.set_rate(80'000);
  line.run(10);
  line.longest_queue();
  line.sent(0, 1);
  line.run(10);
  EXPECT_GT(line.sent(0, 10), 60'000u);
  EXPECT_LT(line.longest_queue(), 150'000u);
  line.set_rate(400'000);
  line.run(20);
  line.sent(0, 1);
  line.run(10);
  EXPECT_GT(line.sent(0, 10), 320'000u) << "there is room again";
}

/// Another delay, 100 ms longer, is no queue.
TEST(LineRate, FollowsADelayThatGrows) {
  for (const std::uint64_t rate : {900'000u, 10'000'000u}) {
    SharedLine line(rate, 40'000, 1);  // 800 kbit/s are sent
    line.run(10);
    line.set_trip(140'000);
    line.run(2);
    line.sent(0, 1);
    line.run(20);
    EXPECT_EQ(line.rate(0), 0u);
    EXPECT_GT(line.sent(0, 20), 780'000u);
    EXPECT_FALSE(line.is_jammed());
  }
}

TEST(LineRate, LeavesTheLineToOthers) {
  SharedLine line(200'000, 40'000, 1);
  line.run(10, 100'000);
  line.longest_queue();
  line.sent(0, 1);
  line.run(20, 100'000);
  const std::uint64_t sent = line.sent(0, 20);
  EXPECT_GT(sent, 70'000u);
  EXPECT_LT(sent, 101'000u) << "the other one has its half";
  EXPECT_LT(line.longest_queue(), 200'000u);
}

TEST(LineRate, NobodyStarves) {
  SharedLine line(240'000, 40'000, 3);
  line.run(20);
  line.longest_queue();
  for (std::size_t k = 0; k < 3; ++k) line.sent(k, 1);
  line.run(60);
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint64_t sent = line.sent(k, 60);
    sum += sent;
    EXPECT_GT(sent, 40'000u) << "half of its fair fraction";
  }
  EXPECT_GT(sum, 190'000u);
  EXPECT_LT(line.longest_queue(), 250'000u);
}

// ==== session token bucket ====

/// Bits that pass in ten seconds if a datagram of this size is offered each `every` microseconds.
std::int64_t passed(std::uint64_t rate, std::int64_t bits, std::uint64_t every) {
  TokenBucket bucket(rate);
  std::int64_t out = 0;
  for (std::uint64_t now = 1'000'000; now < 11'000'000; now += every) {
    if (!bucket.is_open(now)) continue;
    bucket.take(bits, now);
    out += bits;
  }
  return out;
}

TEST(TokenBucket, LetsItsRatePass) {
  for (const std::uint64_t rate : {6'000u, 200'000u, 10'000'000u}) {
    const std::int64_t ten_seconds = 10 * static_cast<std::int64_t>(rate), burst = ten_seconds / 200;
    const std::int64_t bits = 8 * 300;
    EXPECT_LE(passed(rate, bits, 100), ten_seconds + burst + bits) << "what it holds, and one datagram too many";
    EXPECT_GE(passed(rate, bits, 100), ten_seconds - bits);
  }
  EXPECT_EQ(passed(200'000, 800, 10'000), 1000 * 800) << "what is less passes at once";
}

TEST(TokenBucket, HoldsWhat50MillisecondsBring) {
  TokenBucket bucket(1'000'000);
  ASSERT_TRUE(bucket.is_open(3'600'000'000));
  std::int64_t burst = 0;
  for (; bucket.is_open(3'600'000'000); burst += 1000) bucket.take(1000, 3'600'000'000);
  EXPECT_EQ(burst, 50'000);
  EXPECT_FALSE(bucket.is_open(3'600'000'000));
  EXPECT_TRUE(bucket.is_open(3'600'000'001));
}

TEST(TokenBucket, ADebtIsPaid) {
  TokenBucket bucket(1'000'000);
  bucket.take(60'000, 0);
  EXPECT_FALSE(bucket.is_open(10'000));
  EXPECT_TRUE(bucket.is_open(10'001));
}

TEST(TokenBucket, ADebtIsPaidWhileNobodyAsksWhetherItIsOpen) {
  TokenBucket bucket(1'000'000);
  for (std::uint64_t now = 0; now < 10'000'000; now += 1000) bucket.take(990, now);  // acknowledgements of a long join
  EXPECT_TRUE(bucket.is_open(10'000'000));
  bucket.take(2'000'000, 10'000'000);
  EXPECT_FALSE(bucket.is_open(11'900'000)) << "a debt is not forgotten either";
  EXPECT_TRUE(bucket.is_open(12'000'001));
}

TEST(TokenBucket, WithoutARateAllPasses) {
  TokenBucket bucket(0);
  for (std::uint64_t now = 0; now < 1000; ++now) {
    ASSERT_TRUE(bucket.is_open(now));
    bucket.take(std::int64_t{1} << 40, now);
  }
}

TEST(TokenBucket, AnotherRateKeepsTheDebt) {
  TokenBucket bucket(0);
  bucket.take(1'000'000, 0);
  bucket.set_rate(100'000, 0);
  bucket.take(15'000, 0);  // it held 5000
  EXPECT_FALSE(bucket.is_open(100'000));
  EXPECT_TRUE(bucket.is_open(100'001));
  bucket.take(10'000, 100'001);
  bucket.set_rate(1'000'000, 100'001);
  EXPECT_TRUE(bucket.is_open(110'003));
  bucket.set_rate(0, 110'003);
  bucket.take(1'000'000, 110'003);
  EXPECT_TRUE(bucket.is_open(110'003));
}

TEST(TokenBucket, TheLargestRateDoesNotOverflow) {
  TokenBucket bucket(1'000'000'000'000);
  for (std::uint64_t now = 0; now < 10'000'000; now += 49'999) {
    ASSERT_TRUE(bucket.is_open(now));
    bucket.take(9600, now);
  }
}

}  // namespace
}  // namespace tactus
