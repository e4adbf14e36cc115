#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "can/frame.hpp"
#include "canopen/lss.hpp"
#include "sim/drive_model.hpp"

namespace servoctl::sim {

/// What answers LSS (CiA 305) for a simulated drive: its identity is that of 1018h, what it is told to store
/// goes to the drive's memory. A bitrate of table 0 is taken, and nothing follows from it: a simulated bus
/// has none. Performs no I/O and reads no clock.
class LssSlave {
 public:
  /// `model` outlives it.
  explicit LssSlave(DriveModel& model) : model_(&model) { restart(); }

  /// The communication begins anew, with the node-ID that the model has by now.
  void restart();
  void on_frame(const can::Frame& frame);
  std::optional<can::Frame> take_frame();

  /// What its node-ID is from the next reset of the communication on; canopen::kUnconfigured: none.
  std::uint8_t pending_node() const { return pending_; }
  /// Set once, when a drive without a node-ID has been given one and is to start with it.
  bool take_start() { return std::exchange(starts_, false); }

 private:
  using Service = canopen::LssService;

  canopen::LssAddress address() const;
  bool is_unconfigured() const;
  void switch_to(std::uint8_t state);
  void on_select(Service service, std::uint32_t number);
  void on_identify(Service service, std::uint32_t number);
  void on_fastscan(const can::Frame& frame);
  void on_configuration(Service service, const can::Frame& frame);
  void on_inquiry(Service service);
  void answer(Service service, std::uint32_t value = 0);

  DriveModel* model_;
  canopen::LssState state_ = canopen::LssState::waiting;
  std::uint8_t pending_ = canopen::kUnconfigured;
  int selected_ = 0;    ///< Numbers of a selection that fitted so far.
  int identified_ = 0;  ///< The same of an identification.
  int position_ = 0;    ///< Which number fastscan is to ask it for.
  bool starts_ = false;
  std::deque<can::Frame> tx_;
};

}  // namespace servoctl::sim
