// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/inverse3/web_socket.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include <charconv>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include <tactus/device/real_time.h>

namespace tactus::device::inverse3 {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using Stream = beast::websocket::stream<asio::ip::tcp::socket>;
using boost::system::error_code;

std::chrono::steady_clock::time_point point_of(Time time) {
  return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(time));  // both are CLOCK_MONOTONIC
}

/// HOST:PORT on this machine.
std::optional<asio::ip::tcp::endpoint> endpoint_of(const std::string& service) {
  const std::size_t colon = service.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  std::string host = service.substr(0, colon);
  if (host == "localhost") host = "127.0.0.1";
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  error_code error;
  const auto address = asio::ip::make_address(host, error);
  std::uint16_t port = 0;
  const char* const end = service.data() + service.size();
  const auto [rest, failure] = std::from_chars(service.data() + colon + 1, end, port);
  if (error || !address.is_loopback() || failure != std::errc() || rest != end || port == 0) return std::nullopt;
  return asio::ip::tcp::endpoint(address, port);
}

}  // namespace

struct WebSocket::Impl {
  explicit Impl(std::size_t most) : buffer(most) { stream.read_message_max(most); }

  /// Run what was begun until it has ended, or the time is over.   out  false: it goes on
  bool wait(const bool& has_ended, Time deadline) {
    context.restart();
    while (!has_ended && context.run_one_until(point_of(deadline)) > 0) {
    }
    while (!has_ended && context.poll_one() > 0) {  // what came in time while this thread was held up
    }
    return has_ended;
  }

  asio::io_context context{1};
  Stream stream{context};
  beast::flat_buffer buffer;
  std::string outgoing;
  error_code reading, writing;
  bool has_read = true, has_written = true;  // nothing is under way
  bool is_gone = false;
};

WebSocket::WebSocket(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}

WebSocket::~WebSocket() {
  error_code ignored;
  impl_->stream.next_layer().close(ignored);
  impl_->context.restart();
  impl_->context.poll(ignored);  // what was under way ends with an error
}

tl::expected<std::unique_ptr<WebSocket>, std::string> WebSocket::connect(const std::string& service, std::size_t most,
                                                                         Time deadline) try {
  const auto endpoint = endpoint_of(service);
  if (!endpoint) return tl::unexpected(service + " is not HOST:PORT on this machine");
  auto impl = std::make_unique<Impl>(most);
  bool has_ended = false;
  error_code failed;
  const auto note = [&](const error_code& error) {
    failed = error;
    has_ended = true;
  };
  auto socket = std::unique_ptr<WebSocket>(new WebSocket(std::move(impl)));
  Impl& own = *socket->impl_;
  own.stream.next_layer().async_connect(*endpoint, note);
  if (own.wait(has_ended, deadline) && !failed) {
    own.stream.next_layer().set_option(asio::ip::tcp::no_delay(true), failed);
    has_ended = false;
    own.stream.async_handshake(service, "/", note);
    own.wait(has_ended, deadline);
  }
  if (has_ended && !failed) return socket;
  const std::string why = has_ended ? failed.message() : "it does not answer";
  has_ended = true;
  socket.reset();  // its handlers refer to what is here
  return tl::unexpected(service + ": " + why);
} catch (const std::exception& error) {
  return tl::unexpected(service + ": " + error.what());
}

WebSocket::Status WebSocket::send(std::string_view text, Time deadline) noexcept try {
  Impl& own = *impl_;
  if (own.is_gone || !own.has_written) return Status::gone;
  own.has_written = false;
  own.outgoing.assign(text);
  own.stream.async_write(asio::buffer(own.outgoing), [&own](const error_code& error, std::size_t) {
    own.writing = error;
    own.has_written = true;
  });
  own.is_gone = !own.wait(own.has_written, deadline) || own.writing;
  return own.is_gone ? Status::gone : Status::done;
} catch (const std::exception&) {
  impl_->is_gone = true;
  return Status::gone;
}

WebSocket::Status WebSocket::receive(Time deadline) noexcept try {
  Impl& own = *impl_;
  if (own.is_gone) return Status::gone;
  if (own.has_read) {
    own.has_read = false;
    own.buffer.clear();
    own.stream.async_read(own.buffer, [&own](const error_code& error, std::size_t) {
      own.reading = error;
      own.has_read = true;
    });
  }
  if (!own.wait(own.has_read, deadline)) return Status::timeout;
  own.is_gone = own.reading.failed();
  return own.is_gone ? Status::gone : Status::done;
} catch (const std::exception&) {
  impl_->is_gone = true;
  return Status::gone;
}

std::string_view WebSocket::message() const noexcept {
  const auto data = impl_->buffer.cdata();
  return {static_cast<const char*>(data.data()), data.size()};
}

}  // namespace tactus::device::inverse3
