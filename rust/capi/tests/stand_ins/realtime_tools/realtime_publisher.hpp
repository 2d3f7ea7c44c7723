// Stands in for realtime_tools: publishes at once, and every second message finds the one before being sent.
#pragma once
#include <memory>
namespace realtime_tools {
template <class Message>
struct RealtimePublisher {
  explicit RealtimePublisher(std::shared_ptr<rclcpp::Publisher<Message>> publisher) : publisher_(publisher) {}
  bool trylock() { return busy_ = !busy_; }
  void unlockAndPublish() { publisher_->published.push_back(msg_); }
  Message msg_{};

 private:
  std::shared_ptr<rclcpp::Publisher<Message>> publisher_;
  bool busy_ = false;
};
}  // namespace realtime_tools
