// SPDX-License-Identifier: Apache-2.0
#include "cli/observe/web_server.h"

#include <gtest/gtest.h>

#include <string_view>

namespace tactus::cli {
namespace {

Outbox::Message message(std::size_t size) { return std::make_shared<const std::string>(size, 'x'); }

TEST(Outbox, HoldsSoManyMessages) {
  Outbox outbox(2, 1000);
  EXPECT_TRUE(outbox.push(message(1)));
  EXPECT_TRUE(outbox.push(message(2)));
  EXPECT_FALSE(outbox.push(message(3)));
  EXPECT_EQ(outbox.pop()->size(), 1u);
  EXPECT_TRUE(outbox.push(message(4)));
  EXPECT_EQ(outbox.pop()->size(), 2u);
  EXPECT_EQ(outbox.pop()->size(), 4u);
  EXPECT_TRUE(outbox.is_empty());
}

TEST(Outbox, HoldsSoManyBytesButAlwaysOneMessage) {
  Outbox outbox(10, 100);
  EXPECT_TRUE(outbox.push(message(5000)));
  EXPECT_FALSE(outbox.push(message(1)));
  outbox.clear();
  EXPECT_TRUE(outbox.push(message(60)));
  EXPECT_FALSE(outbox.push(message(41)));
  EXPECT_TRUE(outbox.push(message(40)));
}

const WebSite kSite{.targets = {kPageTarget, kLiveTarget}, .nothing = "nothing", .page = {}};

WebRequest page_request() { return {.method = "GET", .target = "/", .host = "127.0.0.1:8080", .origin = {}, .hosts = 1}; }
WebRequest live_request() {
  WebRequest request = page_request();
  request.target = "/live";
  request.origin = "http://127.0.0.1:8080";
  request.origins = 1;
  request.upgrades = true;
  return request;
}

TEST(WebRequest, ThePageAndItsSocketAreAnswered) {
  EXPECT_EQ(judge(page_request(), 8080, kSite).status, kPageAnswer);
  EXPECT_EQ(judge(live_request(), 8080, kSite).status, kLiveAnswer);
  WebRequest named = live_request();
  named.host = "localhost:8080";
  named.origin = "http://localhost:8080";
  EXPECT_EQ(judge(named, 8080, kSite).status, kLiveAnswer);
}

TEST(WebRequest, ASiteHasItsTargetsAlone) {
  const WebSite figures{.targets = {"/metrics"}, .nothing = "there is /metrics", .page = {}};
  WebRequest request = page_request();
  EXPECT_EQ(judge(request, 8080, figures).status, 404u);
  EXPECT_EQ(judge(request, 8080, figures).text, "there is /metrics");
  EXPECT_EQ(judge(live_request(), 8080, figures).status, 404u) << "nobody may observe there";
  request.target = "/metrics";
  EXPECT_EQ(judge(request, 8080, figures).status, kPageAnswer);
  request.host = "evil.example:8080";
  EXPECT_EQ(judge(request, 8080, figures).status, 421u);
}

TEST(WebRequest, AnotherHostIsRefused) {
  for (const std::string_view host :
       {"", "evil.example", "evil.example:8080", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:8080.evil.example", "localhost",
        "localhost:80800", "LOCALHOST:8080", "127.0.0.2:8080", "[::1]:8080", " 127.0.0.1:8080"})
    for (WebRequest request : {page_request(), live_request()}) {
      request.host = host;
      EXPECT_EQ(judge(request, 8080, kSite).status, 421u) << host;
    }
  WebRequest twice = page_request();
  twice.hosts = 2;
  EXPECT_EQ(judge(twice, 8080, kSite).status, 421u);
  twice.hosts = 0;
  EXPECT_EQ(judge(twice, 8080, kSite).status, 421u);
}

TEST(WebRequest, AnotherPageMayNotObserve) {
  for (const std::string_view origin : {"", "null", "http://evil.example", "https://127.0.0.1:8080", "http://127.0.0.1:8081",
                                        "http://localhost:8080", "file://"}) {
    WebRequest request = live_request();
    request.origin = origin;
    EXPECT_EQ(judge(request, 8080, kSite).status, 403u) << origin;
  }
  WebRequest nameless = live_request();
  nameless.origins = 0;
  EXPECT_EQ(judge(nameless, 8080, kSite).status, 403u);
}

TEST(WebRequest, ThereIsNothingElse) {
  for (const std::string_view target :
       {"", "*", "//", "/index.html", "/live/", "/../etc/passwd", "http://127.0.0.1:8080/", "/?a"}) {
    WebRequest request = page_request();
    request.target = target;
    EXPECT_EQ(judge(request, 8080, kSite).status, 404u) << target;
  }
  for (const std::string_view method : {"HEAD", "POST", "OPTIONS", "get"}) {
    WebRequest request = page_request();
    request.method = method;
    EXPECT_EQ(judge(request, 8080, kSite).status, 405u) << method;
  }
  WebRequest plain = live_request();
  plain.upgrades = false;
  EXPECT_EQ(judge(plain, 8080, kSite).status, 426u);
}

}  // namespace
}  // namespace tactus::cli
