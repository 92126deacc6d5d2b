// SPDX-License-Identifier: Apache-2.0
/// The server that browsers and monitors on this machine talk to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace boost::asio {
class io_context;
}

namespace tactus::cli {

// ==== outbox ====

/// Messages that wait to be sent to one observer; all observers share their texts. It never holds more than its bounds.
class Outbox {
 public:
  using Message = std::shared_ptr<const std::string>;

  Outbox(std::size_t most_messages, std::size_t most_bytes) : most_messages_(most_messages), most_bytes_(most_bytes) {}

  /// out  false: there is no room, and the message is not in it
  bool push(Message message) {
    if (messages_.size() == most_messages_ || (!messages_.empty() && bytes_ + message->size() > most_bytes_)) return false;
    bytes_ += message->size();
    messages_.push_back(std::move(message));
    return true;
  }
  bool is_empty() const noexcept { return messages_.empty(); }
  /// The oldest leaves it.   pre  not empty
  Message pop() {
    Message first = std::move(messages_.front());
    messages_.pop_front();
    bytes_ -= first->size();
    return first;
  }
  void clear() noexcept {
    messages_.clear();
    bytes_ = 0;
  }

 private:
  std::size_t most_messages_, most_bytes_, bytes_ = 0;
  std::deque<Message> messages_;
};

// ==== web request ====
// Which requests are answered. The server listens on this machine alone, but any page that a browser shows can make it connect: by an
// address of its own that resolves to this machine, or by a script.

struct WebRequest {
  std::string_view method, target;
  std::string_view host, origin;       ///< of the first such field
  std::size_t hosts = 0, origins = 0;  ///< how many fields there are
  bool upgrades = false;               ///< to a WebSocket
};

/// The status of HTTP, and for those that refuse a sentence.
struct WebAnswer {
  unsigned status = 0;
  std::string_view text{};
};
inline constexpr unsigned kPageAnswer = 200, kLiveAnswer = 101;
inline constexpr std::string_view kPageTarget = "/", kLiveTarget = "/live";

/// What is at a target.
struct WebPage {
  std::string text, type = "text/plain; charset=utf-8";
  unsigned status = kPageAnswer;
};

/// What a server has.
struct WebSite {
  std::vector<std::string_view> targets;  ///< kLiveTarget: its pages may observe
  std::string_view nothing;               ///< sentence where none of them is meant
  std::function<WebPage(std::string_view target)> page;
};

/// The host must be this machine by number or as localhost, with our port, and a WebSocket must be asked for by the page from there.
WebAnswer judge(const WebRequest& request, std::uint16_t port, const WebSite& site);

// ==== web server ====
// A server on this machine: pages by HTTP, and a WebSocket for each page that observes. The only file of the program that knows Boost.Beast.
// All of it runs in the thread of its context.
//
// Whoever connects is distrusted: requests are judged, are small, without a body, and come within seconds; so many at a
// time. An observer that sends anything is shown out; one that is too slow as well, and may come again.

class WebServer {
 public:
  struct Counts {
    std::uint64_t observers = 0, most_at_a_time = 0, too_slow = 0, requests_refused = 0;
  };

  explicit WebServer(boost::asio::io_context& context);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// Listen on the loopback.   in  port  0: any free one   out  the port   throws boost::system::system_error
  std::uint16_t open(std::uint16_t port);
  /// Let in from now on.
  void serve(WebSite site);

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
