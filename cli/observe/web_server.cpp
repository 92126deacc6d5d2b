// SPDX-License-Identifier: Apache-2.0
#include "cli/observe/web_server.h"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <optional>
#include <utility>
#include <vector>

namespace tactus::cli {

// ==== web request ====

WebAnswer judge(const WebRequest& request, std::uint16_t port, const WebSite& site) {
  const std::string suffix = ':' + std::to_string(port);
  const bool is_here = request.host == "127.0.0.1" + suffix || request.host == "localhost" + suffix;
  if (request.hosts != 1 || !is_here) return {421, "This server answers to http://127.0.0.1 and its port alone.\n"};
  if (std::ranges::find(site.targets, request.target) == site.targets.end()) return {404, site.nothing};
  if (request.method != "GET") return {405, "Only GET is answered.\n"};
  if (request.target != kLiveTarget) return {kPageAnswer};
  if (!request.upgrades) return {426, "This is a WebSocket; open / in a browser.\n"};
  if (request.origins != 1 || request.origin != "http://" + std::string(request.host))
    return {403, "Only the page of this server may observe it.\n"};
  return {kLiveAnswer};
}

// ==== web server ====

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::system::error_code;
using namespace std::chrono_literals;

constexpr std::size_t kMostVisitors = 32, kMostObservers = 8;
constexpr std::uint32_t kMostHeader = 8192;                       // [bytes] of a request
constexpr std::size_t kMostHeard = 125;                           // [bytes] of a message from an observer
constexpr int kSystemBuffer = 1 << 17;                            // [bytes] what the system may hold beside that
constexpr std::size_t kMostWaiting = 90, kMostBytes = 16U << 20;  // messages and bytes for one observer: three seconds
// For a request, for the page to be taken, and without a keep-alive.
constexpr auto kTimeout = 5s, kPageTimeout = 15s, kIdle = 20s;

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

websocket::stream_base::timeout timeouts() { return {kTimeout, kIdle, true}; }

class Observer;

}  // namespace

struct WebServer::Impl {
  explicit Impl(asio::io_context& context) : acceptor(context), pause(context) {}

  void accept();
  void leave(const Observer* observer);

  asio::ip::tcp::acceptor acceptor;
  asio::steady_timer pause;  // after a failure to accept
  std::uint16_t port = 0;
  WebSite site;
  std::shared_ptr<std::size_t> visitors = std::make_shared<std::size_t>();  // connections, those of observers too
  std::vector<std::shared_ptr<Observer>> observers;
  bool is_closed = false;
  Counts counts;
};

namespace {

/// One connection of those that the server counts; it may outlive the server.
class Visit {
 public:
  explicit Visit(std::shared_ptr<std::size_t> visitors) : visitors_(std::move(visitors)) { ++*visitors_; }
  Visit(Visit&&) noexcept = default;
  Visit& operator=(Visit&&) = delete;
  ~Visit() {
    if (visitors_) --*visitors_;
  }

 private:
  std::shared_ptr<std::size_t> visitors_;
};

/// A page that observes.
class Observer : public std::enable_shared_from_this<Observer> {
 public:
  Observer(WebServer::Impl& server, Visit visit, beast::tcp_stream stream)
      : server_(server), visit_(std::move(visit)), stream_(std::move(stream)) {
    stream_.next_layer().expires_never();
    error_code ignored;
    stream_.next_layer().socket().set_option(asio::socket_base::send_buffer_size(kSystemBuffer), ignored);
    stream_.set_option(timeouts());
    stream_.read_message_max(kMostHeard);
    stream_.text(true);
  }

  void begin(const http::request<http::empty_body>& request) {
    stream_.async_accept(request, [self = shared_from_this()](const error_code& error) {
      if (error) return self->server_.leave(self.get());
      self->is_open_ = true;
      self->listen();
    });
  }

  void send(const Outbox::Message& message, bool is_key, const std::string& hello) {
    if (!is_open_ || farewell_ || (!has_begun_ && !is_key)) return;
    bool has_room = true;
    if (!std::exchange(has_begun_, true)) has_room = outbox_.push(std::make_shared<const std::string>(hello));
    if (has_room && outbox_.push(message)) return write();
    ++server_.counts.too_slow;
    outbox_.clear();
    close({websocket::close_code::try_again_later, "too slow"});
  }

  /// After what waits to be sent.
  void close(const websocket::close_reason& reason) {
    if (farewell_) return;
    farewell_ = reason;
    if (is_open_) return write();
    error_code ignored;
    stream_.next_layer().socket().close(ignored);
  }
  void close_after(const Outbox::Message& last) {
    if (has_begun_ && !farewell_) outbox_.push(last);
    close({websocket::close_code::going_away, "the server has ended"});
  }

 private:
  /// For keep-alives and the end; an observer has nothing to send.
  void listen() {
    stream_.async_read(buffer_, [self = shared_from_this()](const error_code& error, std::size_t) {
      if (error) return self->server_.leave(self.get());
      self->outbox_.clear();
      self->close({websocket::close_code::policy_error, "an observer has nothing to send"});
    });
  }

  void write() {
    if (is_writing_) return;
    is_writing_ = true;
    if (outbox_.is_empty() && farewell_) {
      stream_.async_close(*farewell_, [self = shared_from_this()](const error_code&) { self->server_.leave(self.get()); });
      return;
    }
    in_flight_ = outbox_.pop();
    stream_.async_write(asio::buffer(*in_flight_), [self = shared_from_this()](const error_code& error, std::size_t) {
      if (error) return self->server_.leave(self.get());
      self->is_writing_ = false;
      if (!self->outbox_.is_empty() || self->farewell_) self->write();
    });
  }

  WebServer::Impl& server_;
  Visit visit_;
  websocket::stream<beast::tcp_stream> stream_;
  beast::flat_buffer buffer_;
  Outbox outbox_{kMostWaiting, kMostBytes};
  Outbox::Message in_flight_;
  std::optional<websocket::close_reason> farewell_;
  bool is_open_ = false, has_begun_ = false, is_writing_ = false;
};

/// A request and its answer.
class Knock : public std::enable_shared_from_this<Knock> {
 public:
  Knock(WebServer::Impl& server, asio::ip::tcp::socket socket)
      : server_(server), visit_(server.visitors), stream_(std::move(socket)) {
    parser_.header_limit(kMostHeader);
    parser_.body_limit(0);
  }

  void begin() {
    stream_.expires_after(kTimeout);
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](const error_code& error, std::size_t) {
      if (!error) return self->answer();
      const bool is_gone = error == beast::error::timeout || error == http::error::end_of_stream || error == asio::error::eof ||
                           error == asio::error::connection_reset || error == asio::error::operation_aborted;
      if (is_gone) return self->end();
      if (error == http::error::header_limit || error == http::error::buffer_overflow)
        return self->refuse({431, "The request is too long.\n"});
      self->refuse({400, "This is no request without a body.\n"});
    });
  }

 private:
  void answer() {
    const auto& request = parser_.get();
    const WebAnswer answer = judge({.method = view_of(request.method_string()),
                                    .target = view_of(request.target()),
                                    .host = view_of(request[http::field::host]),
                                    .origin = view_of(request[http::field::origin]),
                                    .hosts = request.count(http::field::host),
                                    .origins = request.count(http::field::origin),
                                    .upgrades = websocket::is_upgrade(request)},
                                   server_.port, server_.site);
    if (answer.status == kPageAnswer) return say(server_.site.page(view_of(request.target())));
    if (answer.status != kLiveAnswer) return refuse(answer);
    if (server_.is_closed || server_.observers.size() >= kMostObservers) return refuse({503, "So many observe already.\n"});
    const auto observer = std::make_shared<Observer>(server_, std::move(visit_), std::move(stream_));
    server_.observers.push_back(observer);
    ++server_.counts.observers;
    server_.counts.most_at_a_time = std::max<std::uint64_t>(server_.counts.most_at_a_time, server_.observers.size());
    observer->begin(request);
  }

  void refuse(const WebAnswer& answer) {
    ++server_.counts.requests_refused;
    say({.text = std::string(answer.text), .status = answer.status});
  }

  void say(WebPage page) {
    response_.result(page.status);
    response_.version(11);
    response_.keep_alive(false);
    response_.set(http::field::content_type, page.type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("X-Frame-Options", "DENY");
    response_.set("Content-Security-Policy", "frame-ancestors 'none'");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set("Cross-Origin-Opener-Policy", "same-origin");
    response_.set("Referrer-Policy", "no-referrer");
    response_.body() = std::move(page.text);
    response_.prepare_payload();
    stream_.expires_after(kPageTimeout);
    http::async_write(stream_, response_, [self = shared_from_this()](const error_code&, std::size_t) { self->end(); });
  }

  void end() {
    error_code ignored;
    stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  }

  WebServer::Impl& server_;
  Visit visit_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kMostHeader};
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
};

}  // namespace

void WebServer::Impl::accept() {
  acceptor.async_accept([this](const error_code& error, asio::ip::tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) {  // of this machine: no descriptor is left
      pause.expires_after(100ms);
      pause.async_wait([this](const error_code& stopped) {
        if (!stopped) accept();
      });
      return;
    }
    error_code ignored;
    socket.set_option(asio::ip::tcp::no_delay(true), ignored);
    if (*visitors < kMostVisitors) std::make_shared<Knock>(*this, std::move(socket))->begin();
    else ++counts.requests_refused;  // and the socket closes
    accept();
  });
}

void WebServer::Impl::leave(const Observer* observer) {
  std::erase_if(observers, [observer](const auto& one) { return one.get() == observer; });
}

WebServer::WebServer(asio::io_context& context) : impl_(std::make_unique<Impl>(context)) {}
WebServer::~WebServer() = default;

std::uint16_t WebServer::open(std::uint16_t port) {
  const asio::ip::tcp::endpoint local(asio::ip::address_v4::loopback(), port);
  impl_->acceptor.open(local.protocol());
  impl_->acceptor.set_option(asio::socket_base::reuse_address(true));
  impl_->acceptor.bind(local);
  impl_->acceptor.listen();
  impl_->port = impl_->acceptor.local_endpoint().port();
  return impl_->port;
}

void WebServer::serve(WebSite site) {
  impl_->site = std::move(site);
  impl_->accept();
}

bool WebServer::has_observers() const noexcept { return !impl_->observers.empty(); }

void WebServer::send(const Outbox::Message& message, bool is_key, const std::string& hello) {
  for (const auto& observer : std::vector(impl_->observers)) observer->send(message, is_key, hello);
}

void WebServer::close(const Outbox::Message& last) {
  impl_->is_closed = true;
  error_code ignored;
  impl_->acceptor.close(ignored);
  impl_->pause.cancel();
  for (const auto& observer : std::vector(impl_->observers)) observer->close_after(last);
}

const WebServer::Counts& WebServer::counts() const noexcept { return impl_->counts; }

}  // namespace tactus::cli
