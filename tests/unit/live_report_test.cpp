// SPDX-License-Identifier: Apache-2.0
#include "cli/live/live_report.h"

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <string>

namespace tactus::cli {
namespace {

Failure port_failure(int cause, std::uint16_t port) { return refuse_port("--listen 80", port, cause, "udp").value(); }

TEST(LiveReport, APortThatCannotBeOpenedHasARemedyOfItsOwn) {
  EXPECT_EQ(port_failure(EADDRINUSE, 7447).text, "--listen 80: another program has this port");
  EXPECT_NE(port_failure(EADDRINUSE, 7447).remedy.find("ss -ulpn sport = :7447"), std::string::npos);
  EXPECT_NE(port_failure(EACCES, 1023).remedy.find("1024"), std::string::npos);
  EXPECT_EQ(port_failure(EACCES, 1024).remedy.find("1024"), std::string::npos) << "it is not its number";
  EXPECT_NE(port_failure(EADDRNOTAVAIL, 1).remedy.find("ip address"), std::string::npos);
  EXPECT_NE(port_failure(EAFNOSUPPORT, 1).text.find("IPv6"), std::string::npos);
  EXPECT_NE(port_failure(ENOBUFS, 1).text.find("buffer"), std::string::npos) << "as the system says";
  for (const int cause : {EADDRINUSE, EACCES, EPERM, EADDRNOTAVAIL, EAFNOSUPPORT, ENETUNREACH, ENOBUFS})
    EXPECT_FALSE(port_failure(cause, 7447).remedy.empty()) << cause;
}

TEST(LiveReport, EachCauseOfNoSessionHasARemedyOfItsOwn) {
  const auto remedy = [](LeaveReason reason) { return failure_of({.server = "a:1", .ended = reason}).remedy; };
  EXPECT_NE(remedy(LeaveReason::full).find("--clients"), std::string::npos);
  EXPECT_NE(remedy(LeaveReason::version).find("--version"), std::string::npos);
  EXPECT_NE(remedy(LeaveReason::limits).find("smaller scene"), std::string::npos);
  EXPECT_NE(remedy(LeaveReason::silence).find("--key"), std::string::npos);
  EXPECT_EQ(failure_of({.server = "a:1", .ended = LeaveReason::silence, .has_key = true}).remedy.find("--key"),
            std::string::npos);
  const Failure alone = failure_of({.server = "a:1", .ended = LeaveReason::silence, .is_refused = true});
  EXPECT_EQ(alone.text, "a:1: no session: nobody listens there");
  EXPECT_NE(alone.remedy.find("Start `tactus serve`"), std::string::npos);
  EXPECT_EQ(failure_of({.server = "a:1", .ended = LeaveReason::full, .is_refused = true}).text,
            "a:1: no session: the server has no room");
  const Failure halfway =
      failure_of({.server = "a:1", .ended = LeaveReason::silence, .declaration = 5'000'000, .received = 12'000});
  EXPECT_EQ(halfway.text, "a:1: no session: nothing was heard for too long, with 12.0 kB of 5.0 MB of the scene here");
  EXPECT_EQ(failure_of({.server = "a:1", .ended = {}}).text, "a:1: no session: interrupted");
}

TEST(LiveReport, ProgressIsAFractionAndATime) {
  EXPECT_EQ(progress_text(0, 0, 0), "receiving the scene: 0 % of 0.0 kB");
  EXPECT_EQ(progress_text(0, 10'000, 5'000'000), "receiving the scene: 0 % of 10.0 kB");
  EXPECT_EQ(progress_text(2500, 10'000, 5'000'000), "receiving the scene: 25 % of 10.0 kB, 15 s left");
  EXPECT_EQ(progress_text(3'000'000, 3'000'000, 5'000'000), "receiving the scene: 100 % of 3.0 MB, 0 s left");
}

TEST(LiveReport, AnAddressThatIsNoneGetsWhatIsWrong) {
  const auto why = [](const std::string& typed) { return session_address("SERVER", typed, "a.key").error().text; };
  EXPECT_EQ(why("no-such-host.invalid:7447"), "SERVER no-such-host.invalid:7447: no host of this name is known");
  EXPECT_EQ(why("::1:7447"), "SERVER ::1:7447: an IPv6 address stands in brackets");
  EXPECT_EQ(why("fe80::1"), "SERVER fe80::1: an IPv6 address stands in brackets");
  EXPECT_EQ(why("192.0.2.1"), "SERVER 192.0.2.1: there is no port");
  EXPECT_EQ(why(""), "SERVER : there is no port");
  for (const char* typed : {"70000", "127.0.0.1:70000", "[::1]", "[::1]7447", "host:", ":7447"})
    EXPECT_NE(why(typed).find("not a port and not HOST:PORT"), std::string::npos) << typed;
  EXPECT_EQ(session_address("SERVER", "7447", "").value().text(), "127.0.0.1:7447");
  EXPECT_EQ(session_address("SERVER", "[::1]:7447", "").value().text(), "[::1]:7447");
}

}  // namespace
}  // namespace tactus::cli
