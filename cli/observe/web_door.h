// SPDX-License-Identifier: Apache-2.0
/// A door for browsers on this machine: the page by HTTP, and a WebSocket for each page that observes. The only file of the program that
/// knows Boost.Beast. All of it runs in the thread of its context.
///
/// Whoever knocks is distrusted: requests are judged by web_request.h, are small, without a body, and come within seconds; so many at a
/// time. An observer that sends anything is shown out; one that is too slow as well, and may come again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "cli/observe/outbox.h"

namespace boost::asio {
class io_context;
}

namespace tactus::cli {

class WebDoor {
 public:
  struct Counts {
    std::uint64_t observers = 0, most_at_a_time = 0, too_slow = 0, requests_refused = 0;
  };

  explicit WebDoor(boost::asio::io_context& context);
  ~WebDoor();
  WebDoor(const WebDoor&) = delete;
  WebDoor& operator=(const WebDoor&) = delete;

  /// Listen on the loopback.   in  port  0: any free one   out  the port   throws boost::system::system_error
  std::uint16_t open(std::uint16_t port);
  /// Let in from now on.
  void serve(std::string page);

  bool has_observers() const noexcept;
  /// Send a message to all observers. Those who have had none yet begin with a key message, behind `hello`.
  void send(const Outbox::Message& message, bool is_key, const std::string& hello);
  /// Say goodbye to all; those who come are turned away.
  void close(const Outbox::Message& last);
  const Counts& counts() const noexcept;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus::cli
