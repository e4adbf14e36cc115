#pragma once

#include <algorithm>
#include <utility>

#include "session/can_network.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// While it lives `on_frame` is told every frame that a CAN bus brings, in every wait: transfers as well. Of
/// several each is told, in the order they began. On another network there is nothing to hear.
class Hearing {
 public:
  using OnFrame = CanNetwork::OnFrame;

  Hearing(CanNetwork* network, OnFrame on_frame) : network_(network), on_frame_(std::move(on_frame)) {
    if (network_ != nullptr) network_->listeners_.push_back(&on_frame_);
  }
  Hearing(Session& session, OnFrame on_frame) : Hearing(session.can(), std::move(on_frame)) {}
  Hearing(const Hearing&) = delete;
  Hearing& operator=(const Hearing&) = delete;
  ~Hearing() {
    if (network_ != nullptr) std::erase(network_->listeners_, &on_frame_);
  }

 private:
  CanNetwork* network_;
  OnFrame on_frame_;
};

}  // namespace servoctl::session
