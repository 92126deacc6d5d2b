// SPDX-License-Identifier: Apache-2.0
/// A service like the vendor's, on a free port of the loopback: a first message unasked, then one after each command.
#pragma once

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <tactus/device/real_time.h>

namespace tactus::device::inverse3::testing {

inline std::string state_message(double x, const std::string& id = "0D42") {
  return R"({"inverse3":[{"device_id":")" + id + R"(","state":{"cursor_position":{"x":)" + std::to_string(x) +
         R"(,"y":0.02,"z":-0.03},"cursor_velocity":{"x":0,"y":0.5,"z":0}}}],"session":[1,{"a":null}]})";
}

class Service {
 public:
  /// in   answer  to the n-th command, counted from 1; nothing: none
  explicit Service(
      std::function<std::optional<std::string>(std::uint64_t)> answer =
          [](std::uint64_t n) { return state_message(1e-5 * static_cast<double>(n)); },
      std::string first = state_message(0))
      : answer_(std::move(answer)),
        first_(std::move(first)),
        acceptor_(context_, {boost::asio::ip::make_address("127.0.0.1"), 0}),
        thread_([this] { run(); }) {}
  ~Service() {
    stop();
    thread_.join();
  }
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  std::string address() const { return "127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port()); }
  /// The connection ends at once, as when the service dies.
  void stop() {
    ends_ = true;
    boost::system::error_code ignored;
    const std::scoped_lock lock(mutex_);
    if (socket_ != nullptr) socket_->shutdown(boost::asio::ip::tcp::socket::shutdown_both, ignored);
    boost::asio::io_context context;
    boost::asio::ip::tcp::socket waker(context);
    waker.connect(acceptor_.local_endpoint(), ignored);
  }
  std::string last_command() const {
    const std::scoped_lock lock(mutex_);
    return last_;
  }
  std::uint64_t commands() const { return commands_; }
  std::uint64_t pushes() const { return pushes_; }  ///< commands of 2 N along z
  bool has_force() const { return last_command().find(kNoForce) == std::string::npos && commands() > 0; }

  static constexpr const char* kNoForce = R"({"x":0.000000,"y":0.000000,"z":0.000000})";
  static constexpr const char* kPush = R"({"x":0.000000,"y":0.000000,"z":2.000000})";

 private:
  void run() {
    while (!ends_) serve();
  }
  void serve() {
    boost::system::error_code error;
    boost::asio::ip::tcp::socket socket(context_);
    acceptor_.accept(socket, error);
    if (error || ends_) return;
    boost::beast::websocket::stream<boost::asio::ip::tcp::socket&> stream(socket);
    {
      const std::scoped_lock lock(mutex_);
      socket_ = &socket;
    }
    stream.accept(error);
    if (!error) stream.write(boost::asio::buffer(first_), error);
    while (!error && !ends_) {
      boost::beast::flat_buffer buffer;
      stream.read(buffer, error);
      if (error) break;
      {
        const std::scoped_lock lock(mutex_);
        last_ = boost::beast::buffers_to_string(buffer.cdata());
        if (last_.find(kPush) != std::string::npos) ++pushes_;
      }
      const auto answer = answer_(++commands_);
      if (answer) stream.write(boost::asio::buffer(*answer), error);
    }
    const std::scoped_lock lock(mutex_);
    socket_ = nullptr;
  }

  std::function<std::optional<std::string>(std::uint64_t)> answer_;
  std::string first_;
  boost::asio::io_context context_;
  boost::asio::ip::tcp::acceptor acceptor_;
  mutable std::mutex mutex_;
  boost::asio::ip::tcp::socket* socket_ = nullptr;
  std::string last_;
  std::atomic<std::uint64_t> commands_{0}, pushes_{0};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace tactus::device::inverse3::testing
