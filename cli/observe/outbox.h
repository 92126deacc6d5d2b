// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>

namespace tactus::cli {

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

}  // namespace tactus::cli
