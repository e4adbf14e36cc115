#pragma once

#include <poll.h>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "cli/heard_states.hpp"
#include "cli/restart_watch.hpp"
#include "cli/settings.hpp"
#include "cli/terminal/console.hpp"
#include "session/open_bus.hpp"
#include "session/session.hpp"

namespace servoctl::session {
class RegisterEnd;
class RingEnd;
}  // namespace servoctl::session

namespace servoctl::cli {

/// What to name as the bus on a machine with these CAN interfaces, and these URLs of Ethernet ports that have
/// a link.
Message bus_hint(std::span<const std::string> can, std::span<const std::string> coe);

/// The bus of a front end: opened when a line needs it and kept for the next one; those of a cabinet all stay
/// open. It knows the drives that were left energised, over a bus that was lost too, and lets none of them go
/// without a word.
class BusHolder {
 public:
  /// `session_options` hold for every bus that is opened, `bus_options.trace` is that of the settings.
  /// `state_folder`: where it is kept what waits for a restart of a drive; may be empty.
  BusHolder(Console& console, session::BusOptions bus_options, session::Options session_options,
            std::filesystem::path state_folder = {})
      : console_(&console),
        bus_options_(std::move(bus_options)),
        options_(std::move(session_options)),
        state_folder_(std::move(state_folder)) {
    bus_options_.trace_failed = [this](const Error& error) { on_trace_failed(error); };
    console_->set_service([this] { return serve(); });
    console_->set_presses([this] { return sends_regularly(); });
    console_->set_pulse([this] { return keep_up(); });
  }
  BusHolder(const BusHolder&) = delete;
  BusHolder& operator=(const BusHolder&) = delete;
  ~BusHolder() {
    console_->set_service({});
    console_->set_presses({});
    console_->set_pulse({});
  }

  /// The nodes that were left energised over this bus or adapter (`slcan:/dev/ttyACM0`), which is open now or
  /// was lost.
  std::vector<std::uint8_t> energised_on(std::string_view url) const;
  /// Whether a bus that is open has this adapter.
  bool has_adapter(std::string_view adapter) const;
  /// Closes it, so that the port is free. Errc::refused where drives are energised over it.
  Result<void> release_adapter(std::string_view adapter);

  /// The devices' end of a bus with Modbus; errors as session::open_register_end().
  Result<std::unique_ptr<session::RegisterEnd>> open_register_end(const Settings& settings);
  /// The session on the bus of the settings. Another bus that is open is let go first, unless the settings
  /// are those of a cabinet's axes. Errors as open_bus(), Errc::usage when the settings name no bus.
  Result<session::Session*> open(const Settings& settings);
  /// The slaves' end of the bus of the settings, beside whatever bus is open; errors as
  /// session::open_ring_end().
  Result<std::unique_ptr<session::RingEnd>> open_ring_end(const Settings& settings);
  /// The bus that was used last; null when none is open.
  session::Session* session() { return session_; }
  /// All that are open.
  std::vector<session::Session*> sessions() const;
  /// What the nodes of the session's bus are called.
  const show::AxisNames& names(const session::Session& session) const;

  /// What the node of the session's bus was last heard to say of its state.
  HeardStates::State heard_state(const session::Session& session, std::uint8_t node,
                                 const HeardStates::Family& family) const;
  /// Tells one opening of a bus from every other one: what was counted since the other, such as restarts of
  /// its nodes, began anew. 0: it is not open.
  std::uint64_t opening(const session::Session& session) const;

  /// Of a session that is open; null elsewhere.
  RestartWatch* restarts(const session::Session& session) const;

  /// Waits for what `wanted` asks of its descriptor, at most so long, while all buses are served. False after
  /// a signal. `lost` is told of each bus that is lost, and gone then.
  bool wait_for(pollfd& wanted, Duration longest, const std::function<void(const Error&)>& lost);

  /// What kept the trace from being written since the last call; what is left for it is written first.
  std::optional<Error> take_trace_failure();
  /// Closes the bus.
  void close() { drop(); }

  bool produces_sync() const;
  static bool produces_sync(session::Session& session);
  /// SYNC, heartbeats or process data are sent.
  bool sends_regularly() const;
  /// Nodes depend on what servoctl sends regularly: while their user is waited for it goes on, and before the
  /// program ends they are let go.
  bool must_go_on() const;
  /// Drives are energised that cannot stay so without servoctl: they are let go before the program ends, also
  /// when what held them has ended already.
  bool holds_drives() const;
  /// Whether a drive was left energised over one of them.
  bool leaves_power() const;
  /// Ends the SYNC that is produced, and says so.
  void stop_sync();

  /// The interface of the bus is gone. What was energised over it is told now, and is still known when the
  /// same bus is opened again.
  void lose(session::Session& session);
  /// Stops and disables the drives that were left energised, and says so; a lost bus is opened again for it.
  void let_go();
  /// Why the program may not end with 0 or as merely interrupted: a drive that was told to be energised
  /// perhaps, and has not been seen otherwise since; or what could not be put back when a bus was closed.
  std::optional<Errc> failure() const;
  /// Whether every drive that may be energised was tried in vain, and told.
  bool has_warned_of_all() const;

 private:
  /// Does what is due on the bus while the user is waited for; the answer is how long it has time.
  Duration serve();
  /// Sends what is due, and hears nothing; how long that can be left alone.
  Duration keep_up();
  /// Serves the buses that cannot wait while another is used.
  Duration serve_beside();
  Result<void> connect(const std::string& url);
  void tell_opened();
  /// Whether a bus is open over the same port, which may not be open twice.
  bool holds_port(std::string_view url) const;
  Result<void> connect_again(const std::string& url, const std::set<std::uint8_t>& nodes);
  void stop_and_disable();
  void stop_and_disable(session::Session& session);
  void stop_sync(session::Session& session);
  void drop();
  /// `is_lost`: what cannot be put back over it was told as its loss.
  void drop(session::Session& session, bool is_lost = false);
  void fail_closing(const show::AxisNames& names, const Error& error);
  void on_trace_failed(const Error& error);
  void warn(session::Session& session, std::uint8_t node, const Error& why);
  void warn(const std::string& url, std::uint8_t node, const Error& why);

  Console* console_;
  session::BusOptions bus_options_;
  session::Options options_;
  std::filesystem::path state_folder_;
  std::optional<Error> trace_failure_;  ///< Outlives the bus, which may tell of it at its very end.
  bool flushing_ = false;
  bool serving_beside_ = false;
  std::map<std::string, std::unique_ptr<session::Session>> open_;  ///< By canonical_url().
  session::Session* session_ = nullptr;                            ///< Of them that was used last.
  std::map<std::string, show::AxisNames> names_;                   ///< By canonical_url().
  struct Opened {
    std::unique_ptr<HeardStates> heard;
    std::unique_ptr<RestartWatch> restarts;
    std::uint64_t number = 0;
  };
  std::map<const session::Session*, Opened> opened_;  ///< Those that are open.
  std::uint64_t openings_ = 0;
  std::map<std::string, session::EnergisedNodes> left_energised_;  ///< By canonical_url() of one not open.
  /// By canonical_url() and node: why a drive was told to be energised perhaps.
  std::map<std::pair<std::string, std::uint8_t>, Errc> warned_;
  std::optional<Errc> closing_failure_;
};

}  // namespace servoctl::cli
