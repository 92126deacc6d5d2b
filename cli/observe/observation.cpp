// SPDX-License-Identifier: Apache-2.0
#include "cli/observe/observation.h"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/system/system_error.hpp>

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "cli/live/live_report.h"
#include "cli/observe/observed_stream.h"
#include "cli/observe/web_server.h"
#include "cli/report/json.h"
#include "cli/viewer/page.h"
#include "cli/viewer/shapes.h"

namespace tactus::cli {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::milliseconds kSpacing(33);  // of batches
constexpr int kFarewells = 50;                     // times that an end waits for observers to hear it
constexpr std::chrono::milliseconds kFarewell(20);

std::string end_text(const std::string& why) { return page_json({{"end", why}}); }

class LiveObservation final : public Observation {
 public:
  LiveObservation(const Setup& setup, ObservedScene scene)
      : scene_(std::move(scene)),
        queue_(*setup.like, scene_.declared->loads ? scene_.declared->objects.size() : 0, setup.like->users.size()) {
    const std::uint16_t port = server_.open(setup.port);
    address_ = fmt::format("http://127.0.0.1:{}/", port);
    server_.serve({.targets = {kPageTarget, kLiveTarget},
                   .nothing = "There is / and nothing else.\n",
                   .page = [page = WebPage{live_page(port), "text/html; charset=utf-8"}](std::string_view) { return page; }});
    thread_ = std::thread([this] { work(); });
  }
  ~LiveObservation() override { finish(); }

  const std::string& address() const noexcept override { return address_; }
  void offer(const TraceFrame& frame, std::span<const ObjectLoad> loads) noexcept override { queue_.offer(frame, loads); }
  ObservationReport finish() override;

 private:
  void work();
  void wait();
  void look();
  Result<void> take_ticks();
  void end(const std::string& why);
  void leave(int farewells);

  ObservedScene scene_;
  std::string address_, failure_;
  TickQueue queue_;
  // The rest is of the thread, while it runs.
  asio::io_context context_{1};
  asio::steady_timer timer_{context_};
  WebServer server_{context_};
  std::unique_ptr<ObservedStream> stream_;  // while somebody observes
  bool watches_ = false;
  std::thread thread_;
};

void LiveObservation::work() try {
  wait();
  context_.run();
} catch (const std::exception& error) {
  queue_.end_watch();
  failure_ = error.what();
}

void LiveObservation::wait() {
  timer_.expires_after(kSpacing);
  timer_.async_wait([this](const boost::system::error_code& stopped) {
    if (stopped) return;
    look();
    wait();
  });
}

/// Nothing is coded while nobody looks.
void LiveObservation::look() {
  if (!server_.has_observers()) {
    if (std::exchange(watches_, false)) queue_.end_watch();
    stream_.reset();
    return;
  }
  if (!std::exchange(watches_, true)) return queue_.begin_watch();
  const Result<void> taken = take_ticks();
  if (!taken) end("the ticks cannot be coded for a page: " + refuse(scene_.name, taken.error()).value().text);
}

Result<void> LiveObservation::take_ticks() {
  if (queue_.front() == nullptr) return {};
  while (const ObservedTick* tick = queue_.front()) {
    if (!stream_) {
      TACTUS_TRY(stream_, ObservedStream::create(scene_, *tick));
    }
    TACTUS_CHECK(stream_->add(*tick));
    queue_.pop();
  }
  ObservedStream::Batch batch = stream_->take(queue_.left_out());
  server_.send(std::make_shared<const std::string>(std::move(batch.text)), batch.is_key, stream_->hello());
  return {};
}

void LiveObservation::end(const std::string& why) {
  failure_ = why;
  if (std::exchange(watches_, false)) queue_.end_watch();
  timer_.cancel();
  server_.close(std::make_shared<const std::string>(end_text(why)));
}

/// When all observers have heard it, or do not in time.
void LiveObservation::leave(int farewells) {
  if (farewells == 0 || !server_.has_observers()) return context_.stop();
  timer_.expires_after(kFarewell);
  timer_.async_wait([this, farewells](const boost::system::error_code&) { leave(farewells - 1); });
}

ObservationReport LiveObservation::finish() {
  if (thread_.joinable()) {
    asio::post(context_, [this] {
      timer_.cancel();
      server_.close(std::make_shared<const std::string>(end_text("the server has ended")));
      leave(kFarewells);
    });
    thread_.join();
  }
  const WebServer::Counts& counts = server_.counts();
  return {address_,          counts.observers, counts.most_at_a_time, counts.too_slow, counts.requests_refused,
          queue_.left_out(), failure_};
}

}  // namespace

tl::expected<std::unique_ptr<Observation>, Failure> Observation::create(const Setup& setup) try {
  TACTUS_TRY(auto shapes, scene_shapes(setup.scene));
  ObservedScene scene{setup.info, setup.declared, setup.sender, setup.name, std::move(shapes)};
  return std::make_unique<LiveObservation>(setup, std::move(scene));
} catch (const boost::system::system_error& error) {
  return refuse_port(fmt::format("--observe {}", setup.port), setup.port, error.code().value(), "tcp");
}

}  // namespace tactus::cli
