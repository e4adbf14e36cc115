#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cabinet/cabinet.hpp"
#include "cabinet/cabinet_check.hpp"
#include "drive/cia402.hpp"
#include "motion/motion_units.hpp"
#include "show/desk.hpp"
#include "show/fault_records.hpp"

namespace servoctl::cabinet {

/// One axis as it is now.
struct AxisState {
  const Axis* axis = nullptr;
  std::string network;  ///< NMT or AL state; empty where it was not heard.
  std::optional<drive::DriveState> state;
  std::optional<std::int8_t> mode;
  std::string mode_word;                     ///< As drive::mode_word().
  std::optional<std::uint16_t> fault;        ///< 603Fh; 0: none.
  show::ToldFault told_fault;                ///< The same in words, and by the state.
  std::optional<motion::Physical> position;  ///< Of the load, where the file says what it moves.
  std::optional<Error> error;                ///< Why nothing is known of it.
};

/// Opens a bus of the cabinet.
using OpenBus = std::function<Result<session::Session*>(const Bus&)>;

/// Looks at axes again and again: all of a bus at the same time, bus after bus. What the units of a drive
/// need is read once.
class AxisStates {
 public:
  AxisStates(const Cabinet& cabinet, std::vector<const Axis*> axes, OpenBus open, LoadProfile load,
             const show::Desk& desk)
      : cabinet_(&cabinet),
        axes_(std::move(axes)),
        open_(std::move(open)),
        load_(std::move(load)),
        desk_(&desk) {}

  /// In the order of the axes. A bus that cannot be opened, or is lost, is the error of each of its axes; it
  /// is opened again by the next look.
  std::vector<AxisState> look();

 private:
  struct Known {
    const drive::Profile* profile = nullptr;
    std::unique_ptr<motion::MotionUnits> units;
  };

  void look_on(const Bus& bus, std::vector<AxisState>& out);
  void take(AxisState& look, session::Session& session, std::span<const Result<Bytes>> answers);
  const Known& known(const Axis& axis, session::Session& session);

  const Cabinet* cabinet_;
  std::vector<const Axis*> axes_;
  OpenBus open_;
  LoadProfile load_;
  const show::Desk* desk_;
  std::map<const Axis*, Known> known_;
};

}  // namespace servoctl::cabinet
