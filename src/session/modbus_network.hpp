#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drive/rules.hpp"
#include "modbus/client.hpp"
#include "modbus/port.hpp"
#include "session/network.hpp"

namespace servoctl::session {

class ModbusObjectChannel;

/// A line, or a connection, with units of Modbus. A node is a unit address; of 1 to 247 those up to 127 have
/// a number here. Objects are holding registers, as the data of a node's family say; nothing in a register
/// says what a device is, so that without a family there are none.
///
/// One request is on the line at a time, whoever asks. There are no states, no events and no signs of life.
class ModbusNetwork final : public Network {
 public:
  /// `url` stands in messages.
  ModbusNetwork(std::unique_ptr<modbus::Port> port, std::string url);
  ~ModbusNetwork() override;

  TimePoint now() const override { return port_->now(); }
  Result<bool> step(TimePoint deadline) override;
  TimePoint stepped_at() const override { return stepped_at_; }
  TimePoint next_event() const override;
  int poll_fd() const override { return port_->poll_fd(); }
  Result<void> recover(TimePoint deadline) override;
  std::unique_ptr<ObjectChannel> object_channel(std::uint8_t node, Duration timeout) override;
  const NodeRecords& records() const override { return records_; }
  std::optional<NodeEvent> take_event() override { return std::nullopt; }
  /// Errc::usage: there are none.
  Result<void> request_state(std::uint8_t node, NodeState state) override;
  Result<void> ask_state(std::uint8_t) override { return {}; }
  void doubt_state(std::uint8_t) override {}
  bool carries(LifeSign::Kind) const override { return false; }
  Result<void> arm_watchdog(std::uint8_t node, const LifeSign& sign) override;
  void disarm_watchdog(std::uint8_t) override {}
  void send_last_word(std::uint8_t, ObjectAddress, std::uint16_t) noexcept override {}
  std::unique_ptr<ProcessValues> process_values(std::uint8_t node,
                                                std::span<const ObjectAddress> objects) override;
  std::vector<Message> take_notices() override;
  bool takes_turns() const override { return true; }
  std::string silence_hint(std::uint8_t node) const override;
  ModbusNetwork* modbus() override { return this; }

  /// The node is of a family with these rules.
  void learn(std::uint8_t node, const drive::ModbusRules& rules);
  /// Whether somebody said so.
  bool is_known(std::uint8_t node) const { return rules_.count(node) != 0; }
  /// Whether the object has a register; false too where the family is not known.
  bool has_register(std::uint8_t node, ObjectAddress object) const {
    return register_of(node, object).has_value();
  }
  /// The node's, for requests that are not of objects.
  std::unique_ptr<ModbusObjectChannel> request_channel(std::uint8_t node, Duration timeout);
  /// The bytes of a write in hexadecimal; empty for what has no register or is no register's value.
  std::string write_frame(std::uint8_t node, ObjectAddress object, ByteSpan data) const;
  const std::string& url() const { return url_; }
  /// How long one unit of many is waited for, when all are asked whether they are there.
  Duration scan_patience() const;

 private:
  friend class ModbusObjectChannel;

  class Records final : public NodeRecords {
   public:
    std::optional<NodeState> state(std::uint8_t) const override { return std::nullopt; }
    std::uint32_t boots(std::uint8_t) const override { return 0; }
    std::uint32_t heartbeats(std::uint8_t) const override { return 0; }
    const std::deque<canopen::Emergency>& emergencies(std::uint8_t) const override { return none_; }
    std::uint32_t alarms(std::uint8_t) const override { return 0; }

   private:
    std::deque<canopen::Emergency> none_;
  };

  std::optional<std::uint16_t> register_of(std::uint8_t node, ObjectAddress object) const;
  /// One that is read to see whether the unit is there; one that does not have it answers too.
  std::uint16_t presence_register(std::uint8_t node) const;
  /// Sends the next request when its time has come.
  Result<void> pump();
  /// When the channel may ask.
  TimePoint free_at(const ModbusObjectChannel& channel) const;
  bool hand_over_late();
  Bytes check_for(const ModbusObjectChannel& channel) const;
  void leave(ModbusObjectChannel& channel);
  Result<void> check_stream();
  void begin_anew();

  std::unique_ptr<modbus::Port> port_;
  std::string url_;
  modbus::Client client_;
  Records records_;
  std::map<std::uint8_t, drive::ModbusRules> rules_;
  std::deque<ModbusObjectChannel*> waiting_;  ///< In the order in which they asked.
  ModbusObjectChannel* asking_ = nullptr;     ///< Whose request is on the line.
  TimePoint stepped_at_{};
  bool told_echo_ = false;
  std::vector<Message> notices_;
};

}  // namespace servoctl::session
