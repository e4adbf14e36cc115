#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cabinet/cabinet.hpp"
#include "command/keys.hpp"
#include "drive/profile.hpp"
#include "session/session.hpp"
#include "settings/setting_line.hpp"

namespace servoctl::session {
class RegisterEnd;
class RingEnd;
}  // namespace servoctl::session

namespace servoctl::command {

/// What a front end does for commands whose words decide what they need.
class FrontEnd : public settings::LineReader {
 public:
  /// Opens the bus of the line; the context has its session then.
  virtual Result<session::Session*> open_bus() = 0;
  /// The cabinet file of the line: `--cabinet`, $SERVOCTL_CABINET, or `cabinet.toml` in the current folder or
  /// above. Errc::usage where there is none, else as read_cabinet().
  virtual Result<const cabinet::Cabinet*> cabinet() = 0;
  /// Opens a bus of the cabinet, and keeps those that are open; errors as open_network().
  virtual Result<session::Session*> open_bus(const cabinet::Cabinet& cabinet, const cabinet::Bus& bus) = 0;
  /// The URL of the bus of the line; empty when it names none.
  virtual std::string_view bus_url() const = 0;
  /// While it lives a second signal does not end the process; the first one is heard.
  virtual session::Protection::Hold protect() = 0;
  /// To the end of the line nothing that is printed waits for its reader: others are served meanwhile.
  virtual void wait_for_no_reader() = 0;
  /// The nodes that were left energised over this bus or adapter, which is open now or was lost.
  virtual std::vector<std::uint8_t> energised_on(std::string_view url) const = 0;
  /// Whether a bus that is open has this adapter: `slcan:/dev/ttyACM0`.
  virtual bool has_adapter(std::string_view adapter) const = 0;
  /// Closes it, so that the port is free; the next line that needs it opens it again. Errc::refused where
  /// drives are energised over it.
  virtual Result<void> release_adapter(std::string_view adapter) = 0;
  /// Opens the slaves' end of the bus of the line, which is one with EtherCAT; errors as
  /// session::open_ring_end().
  virtual Result<std::unique_ptr<session::RingEnd>> open_ring_end() = 0;
  /// Opens the devices' end of the bus of the line, which is one with Modbus; errors as
  /// session::open_register_end().
  virtual Result<std::unique_ptr<session::RegisterEnd>> open_register_end() = 0;
  /// Holds a family against the identity of these nodes; `changes`: they will be written to. Errc::refused
  /// when they contradict it, or two nodes have one number.
  virtual Result<void> hold_family(std::span<const std::uint8_t> nodes, const drive::Profile* profile,
                                   bool changes) = 0;
  /// The data of a family, loaded once; errors as load_profile().
  virtual Result<const drive::Profile*> family(const std::string& name) = 0;
  /// The keys of the terminal, until the answer is destroyed; null where there is none.
  virtual std::unique_ptr<Keys> open_keys() = 0;
};

}  // namespace servoctl::command
