#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "modbus/listener.hpp"
#include "session/open_bus.hpp"
#include "sim/modbus_cell.hpp"

namespace servoctl::session {

/// The devices' end of a line with Modbus.
class RegisterEnd {
 public:
  RegisterEnd(std::unique_ptr<modbus::Listener> line, std::function<bool()> cancelled)
      : line_(std::move(line)), cancelled_(std::move(cancelled)) {}

  TimePoint now() const { return line_->now(); }
  /// Lets simulated drives live on the line until it is cancelled. Errc::bus when the line is lost; somebody
  /// who asks and goes is none.
  Result<void> serve(sim::ModbusCell& cell);

 private:
  struct Due {
    int who;
    sim::ModbusCell::Answer answer;
  };
  /// What one of those who ask has sent so far.
  struct Asker {
    modbus::Deframer in;
    TimePoint heard{};
  };

  void send_due();
  TimePoint next() const;
  void take(int who, Asker& asker, sim::ModbusCell& cell);
  void end_messages(sim::ModbusCell& cell);

  std::unique_ptr<modbus::Listener> line_;
  std::function<bool()> cancelled_;
  std::map<int, Asker> askers_;
  std::vector<Due> due_;
};

/// `cancelled` is asked in every wait. Errors as open_register_listener().
Result<std::unique_ptr<RegisterEnd>> open_register_end(std::string_view url, const BusOptions& options,
                                                       std::function<bool()> cancelled);

}  // namespace servoctl::session
