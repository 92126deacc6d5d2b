// SPDX-License-Identifier: Apache-2.0
#include "cli/live/monitor.h"
#include "cli/live/notify.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <thread>

#include "tests/property/allocated.h"

namespace tactus::cli {
namespace {

// ==== figures ====

TEST(Durations, ABucketHoldsItsBound) {
  Durations durations;
  for (const std::uint64_t us : {0u, 10u, 11u, 10'000u, 10'001u, 5'000'000u}) durations.add(us);
  EXPECT_EQ(durations.counts(), (std::array<std::uint64_t, 11>{2, 1, 0, 0, 0, 0, 0, 0, 0, 1, 2}));
  EXPECT_EQ(durations.sum(), 5'020'022u);
}

Traffic traffic(std::uint64_t all) {
  return {.datagrams_sent = all, .bytes_sent = 10 * all, .payload_sent = all, .lost = all / 2};
}

TEST(TrafficTotal, GoesOnWhenASessionBeginsAnew) {
  TrafficTotal total(2);
  total.add(0, traffic(100));
  total.add(0, traffic(100));
  total.add(1, traffic(50));
  total.add(0, traffic(110));
  EXPECT_EQ(total.sum().datagrams_sent, 160u);
  total.add(0, traffic(8));  // another session
  EXPECT_EQ(total.sum().datagrams_sent, 168u);
  EXPECT_EQ(total.sum().bytes_sent, 1680u);
  total.add(0, traffic(9));
  EXPECT_EQ(total.sum().lost, 55u + 25u + 4u);
}

ServerFigures figures_of_two() {
  ServerFigures out;
  out.clients.resize(3);
  ClientStatus& live = out.clients[1];
  live.client = 1;
  live.state = SessionState::live;
  live.role = Role::participant;
  live.seat = 2;
  live.round_trip = RoundTrip{.smoothed = 12'500};
  live.loss = 0.25;
  live.bound_scale = 4;
  out.clients[2].state = SessionState::receiving;
  for (const std::uint64_t us : {5u, 60u, 60u, 20'000u}) out.work.add(us);
  out.traffic = {.datagrams_sent = 10, .bytes_sent = 1000, .payload_sent = 300};
  out.refused[static_cast<std::size_t>(LeaveReason::full)] = 3;
  return out;
}

bool has_line(const std::string& text, const std::string& line) {
  return ('\n' + text).find('\n' + line + '\n') != std::string::npos;
}

TEST(PrometheusText, CountsAsItsFormatSays) {
  const std::string text = prometheus_text(figures_of_two(), {.scene = "desk", .objects = 4, .headers = 48, .seal = 29});
  for (const char* line : {
           "tactus_info{version=\"" TACTUS_VERSION "\",scene=\"desk\"} 1",
           "tactus_clients{state=\"live\"} 1",
           "tactus_clients{state=\"receiving\"} 1",
           "tactus_clients_limit 3",
           "tactus_client_round_trip_seconds{client=\"1\",role=\"participant\"} 0.0125",
           "tactus_client_loss_ratio{client=\"1\",role=\"participant\"} 0.25",
           "tactus_client_bound_scale_ratio{client=\"1\",role=\"participant\"} 4",
           "tactus_client_seat{client=\"1\",role=\"participant\"} 2",
           "tactus_joins_refused_total{reason=\"full\"} 3",
           "tactus_sent_bytes_total{layer=\"payload\"} 300",
           "tactus_sent_bytes_total{layer=\"session\"} 700",
           "tactus_sent_bytes_total{layer=\"seal\"} 290",
           "tactus_sent_bytes_total{layer=\"udp_ip\"} 480",
           "# TYPE tactus_tick_work_seconds histogram",
           "tactus_tick_work_seconds_bucket{le=\"1e-05\"} 1",
           "tactus_tick_work_seconds_bucket{le=\"5e-05\"} 1",
           "tactus_tick_work_seconds_bucket{le=\"0.0001\"} 3",
           "tactus_tick_work_seconds_bucket{le=\"0.01\"} 3",
           "tactus_tick_work_seconds_bucket{le=\"+Inf\"} 4",
           "tactus_tick_work_seconds_count 4",
       })
    EXPECT_TRUE(has_line(text, line)) << line << "\n" << text;
  EXPECT_EQ(text.find("tactus_seal_"), std::string::npos) << "nothing is sealed";
  EXPECT_EQ(text.back(), '\n');
}

TEST(PrometheusText, ANameOfASceneBreaksNoLine) {
  const std::string text = prometheus_text({}, {.scene = "a\"b\\c\nd\xff\x01"});
  EXPECT_NE(text.find("scene=\"a\\\"b\\\\c\\nd??\"} 1\n"), std::string::npos) << text.substr(0, 200);
}

TEST(Health, ReportsWhatIsWrong) {
  ServerFigures figures = figures_of_two();
  figures.recent_ticks = 10'000;
  figures.recent_missed = 1000;
  EXPECT_TRUE(health_of(figures, 5'000'000, 6'000'000).is_well) << "ten in a hundred, and a second";
  EXPECT_NE(health_of(figures, 5'000'000, 5'000'000).text.find("1 of 3 clients live"), std::string::npos);
  const Health still = health_of(figures, 5'000'000, 6'000'001);
  EXPECT_FALSE(still.is_well);
  EXPECT_NE(still.text.find("stands still"), std::string::npos) << still.text;
  figures.recent_missed = 1001;
  const Health late = health_of(figures, 5'000'000, 5'000'000);
  EXPECT_FALSE(late.is_well);
  EXPECT_NE(late.text.find("1001 of the last 10000 ticks"), std::string::npos) << late.text;
  EXPECT_FALSE(health_of(figures, 0, 5'000'000).is_well) << "there was no tick";
}

// ==== monitor ====

TEST(Monitor, ShowsFiguresOnceASecond) {
  Monitor monitor(2);
  EXPECT_EQ(monitor.figures().clients.size(), 2u);
  std::uint64_t shown = 0;
  for (std::uint64_t ms = 1; ms <= 12'000; ++ms) {
    // From the second second on every tenth tick is missed.
    const std::uint64_t missed = ms > 2000 ? (ms - 2000) / 10 : 0;
    ServerFigures* const figures = monitor.tick(1000 * ms, {.lateness = 20, .work = 100, .ticks = ms - missed, .missed = missed});
    if (figures == nullptr) continue;
    ++shown;
    figures->seats = shown;
    monitor.show();
  }
  const ServerFigures figures = monitor.figures();
  EXPECT_EQ(shown, 12u);
  EXPECT_EQ(figures.seats, 12u);
  EXPECT_EQ(figures.ticks + figures.missed, 11'001u);
  EXPECT_EQ(figures.recent_ticks, 10'000u);
  EXPECT_EQ(figures.recent_missed, 900u);
  EXPECT_EQ(figures.lateness.counts()[1], 11'001u);
  EXPECT_TRUE(monitor.health(12'500'000).is_well);
  EXPECT_FALSE(monitor.health(13'500'000).is_well);
}

TEST(Monitor, TheLoopNeitherAllocatesNorWaits) {
  Monitor monitor(64);
  const std::uint64_t before = testing::allocated_bytes();
  for (std::uint64_t ms = 1; ms <= 3000; ++ms)
    if (monitor.tick(1000 * ms, {.ticks = ms}) != nullptr) monitor.show();
  EXPECT_EQ(testing::allocated_bytes(), before);
}

TEST(Monitor, WhoReadsSeesFiguresOfOneTime) {
  Monitor monitor(64);
  std::atomic<bool> ends{false};
  std::thread loop([&] {
    for (std::uint64_t second = 1; second <= 20'000; ++second) {
      ServerFigures* const figures = monitor.tick(1'000'000 * second, {.ticks = second});
      for (ClientStatus& client : figures->clients) client.heard = second;
      monitor.show();
    }
    ends = true;
  });
  std::uint64_t last = 0;
  bool is_whole = true, rises = true;
  while (!ends) {
    const ServerFigures figures = monitor.figures();
    for (const ClientStatus& client : figures.clients) is_whole = is_whole && client.heard == figures.ticks;
    rises = rises && figures.ticks >= last;
    last = figures.ticks;
  }
  loop.join();
  EXPECT_TRUE(is_whole);
  EXPECT_TRUE(rises);
}

// ==== service manager ====

/// A socket of a service manager, at an abstract name.
class Listener {
 public:
  Listener() : handle_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    ::bind(handle_, reinterpret_cast<sockaddr*>(&address), sizeof address.sun_family);  // Linux finds a name
    socklen_t size = sizeof address;
    ::getsockname(handle_, reinterpret_cast<sockaddr*>(&address), &size);
    name_ = '@' + std::string(address.sun_path + 1, size - offsetof(sockaddr_un, sun_path) - 1);
    ::setenv("NOTIFY_SOCKET", name_.c_str(), 1);
  }
  ~Listener() {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) ::unsetenv(name);
    ::close(handle_);
  }
  std::string next() const {
    std::array<char, 200> text{};
    const auto size = ::recv(handle_, text.data(), text.size(), 0);
    return size < 0 ? "nothing" : std::string(text.data(), static_cast<std::size_t>(size));
  }

 private:
  int handle_;
  std::string name_;
};

TEST(ServiceManager, IsNotifiedThatTheServiceIsReadyLivesAndEnds) {
  Listener listener;
  ::setenv("WATCHDOG_USEC", "2000000", 1);
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  ServiceManager manager;
  manager.ready("serving desk");
  EXPECT_EQ(listener.next(), "READY=1\nSTATUS=serving desk");
  manager.alive(5'000'000);
  EXPECT_EQ(listener.next(), "WATCHDOG=1");
  manager.alive(5'999'999);
  EXPECT_EQ(listener.next(), "nothing");
  manager.alive(6'000'000);
  EXPECT_EQ(listener.next(), "WATCHDOG=1");
  manager.stopping();
  EXPECT_EQ(listener.next(), "STOPPING=1");
}

TEST(ServiceManager, AWatchdogOfAnotherProgramAndNoManagerAreLeftAlone) {
  {
    Listener listener;
    ::setenv("WATCHDOG_USEC", "2000000", 1);
    ::setenv("WATCHDOG_PID", "1", 1);
    ServiceManager manager;
    manager.alive(5'000'000);
    EXPECT_EQ(listener.next(), "nothing");
  }
  for (const char* name : {"", "/nowhere/notify", "relative", "@"}) {
    ::setenv("NOTIFY_SOCKET", name, 1);
    ServiceManager manager;
    manager.ready("x");
    manager.alive(1);
    ::unsetenv("NOTIFY_SOCKET");
  }
}

}  // namespace
}  // namespace tactus::cli
