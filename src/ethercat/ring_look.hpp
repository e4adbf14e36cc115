#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "ethercat/al_status.hpp"
#include "ethercat/request.hpp"

namespace servoctl::ethercat {

/// One port of a slave: what its registers 0110h and 0300h to 0313h say of it.
struct PortLook {
  bool link = false;            ///< A cable is plugged in, with somebody at its other end.
  bool open = false;            ///< Frames go out here; else they are turned round.
  bool signal = false;          ///< Somebody answers here.
  std::uint8_t bad_frames = 0;  ///< Counters stop at 255.
  std::uint8_t bad_symbols = 0;
  std::uint8_t forwarded = 0;  ///< Frames that another slave had marked bad.
  std::uint8_t lost_links = 0;
};

/// What one slave says of itself without being changed.
struct SlaveLook {
  std::uint8_t type = 0;  ///< Of its controller (0000h).
  std::uint8_t revision = 0;
  std::uint8_t fmmus = 0;
  std::uint8_t sync_managers = 0;
  std::uint16_t features = 0;  ///< reg::kFeature… bits.
  std::uint16_t station = 0;   ///< 0: nobody gave it one since it was switched on.
  std::uint16_t alias = 0;
  AlStatus al;
  std::array<PortLook, 4> ports;
  std::uint8_t bad_commands = 0;  ///< 030Ch: frames that are no EtherCAT, or damaged inside.
  std::uint8_t pdi_errors = 0;    ///< 030Dh: of its own processor's access.
};

/// Takes the registers apart: 20 bytes from 0000h, 2 from 0110h, 6 from 0130h, 20 from 0300h. What is missing
/// is 0.
SlaveLook parse_slave_look(ByteSpan identity, ByteSpan dl_status, ByteSpan al_status, ByteSpan errors);

/// Looks at all slaves of a ring, in their order, and changes nothing: another master may be at work.
/// Performs no I/O and reads no clock; a Carrier takes its requests.
class RingLook {
 public:
  struct View {
    std::size_t count = 0;  ///< Slaves on the wire; 127 of them at most are looked at.
    std::vector<SlaveLook> slaves;

    /// Somebody exchanges process data with this ring: a slave is in SAFE-OP or OP.
    bool is_in_use() const;
  };

  void start(TimePoint now);
  std::optional<Request> take_request();
  void on_answer(const Answer& answer, TimePoint now);
  bool busy() const { return state_ != State::idle; }
  /// Set once. Errc::bus when nothing comes back or nobody is there, Errc::timeout when a slave goes
  /// meanwhile.
  std::optional<Result<View>> take_result();

 private:
  enum class State : std::uint8_t { idle, count, identity, dl_status, al_status, errors };

  void go(State state);
  void on_counted(const Answer& answer);
  void finish(Result<View> result);
  SlaveAddress present() const {
    return SlaveAddress::at_position(static_cast<std::uint16_t>(view_.slaves.size()));
  }

  State state_ = State::idle;
  bool asking_ = false;
  View view_;
  std::array<Bytes, 3> read_;  ///< Of the present slave.
  std::optional<Result<View>> result_;
};

}  // namespace servoctl::ethercat
