// SPDX-License-Identifier: Apache-2.0
#include "cli/observe/metrics_server.h"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/system/system_error.hpp>

#include <exception>
#include <thread>
#include <utility>

#include "cli/live/live_report.h"
#include "cli/live/ticker.h"
#include "cli/observe/web_server.h"

namespace tactus::cli {
namespace {

constexpr std::string_view kMetrics = "/metrics", kHealth = "/health";
constexpr unsigned kUnwell = 503;

class ListeningMetricsServer final : public MetricsServer {
 public:
  ListeningMetricsServer(std::uint16_t port, const Monitor& monitor, ServerFacts facts)
      : monitor_(monitor), facts_(std::move(facts)) {
    address_ = fmt::format("http://127.0.0.1:{}{}", server_.open(port), kMetrics);
    server_.serve({.targets = {kMetrics, kHealth},
                   .nothing = "There are /metrics and /health.\n",
                   .page = [this](std::string_view target) { return page(target); }});
    thread_ = std::thread([this] { work(); });
  }
  ~ListeningMetricsServer() override {
    context_.stop();
    thread_.join();
  }
  const std::string& address() const noexcept override { return address_; }

 private:
  /// A request that memory does not suffice for ends; the others do not.
  void work() {
    while (!context_.stopped()) try {
        context_.run();
      } catch (const std::exception&) {
      }
  }
  WebPage page(std::string_view target) const {
    if (target == kMetrics) return {prometheus_text(monitor_.figures(), facts_), "text/plain; version=0.0.4; charset=utf-8"};
    const Health health = monitor_.health(microseconds_now());
    WebPage out{.text = health.text + '\n'};
    if (!health.is_well) out.status = kUnwell;
    return out;
  }

  const Monitor& monitor_;
  ServerFacts facts_;
  std::string address_;
  boost::asio::io_context context_{1};
  WebServer server_{context_};
  std::thread thread_;
};

}  // namespace

tl::expected<std::unique_ptr<MetricsServer>, Failure> MetricsServer::create(std::uint16_t port, const Monitor& monitor,
                                                                            ServerFacts facts) try {
  return std::make_unique<ListeningMetricsServer>(port, monitor, std::move(facts));
} catch (const boost::system::system_error& error) {
  return refuse_port(fmt::format("--metrics {}", port), port, error.code().value(), "tcp");
}

}  // namespace tactus::cli
