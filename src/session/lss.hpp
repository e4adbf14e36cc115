#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/lss_fastscan.hpp"
#include "canopen/lss_master.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// An LSS slave that is in the configuration state, and what it told when it was asked.
struct LssSlave {
  canopen::LssAddress address;
  std::optional<std::uint8_t>
      node;  ///< The active node-ID, or canopen::kUnconfigured; empty where it does not say.

  bool is_unconfigured() const { return node == canopen::kUnconfigured; }
};

/// servoctl as the LSS master (CiA 305) of the session's CAN bus, until it is destroyed: on every way out all
/// slaves are back in the waiting state, unless leave() says otherwise. While a slave may be in the
/// configuration state no second Ctrl-C ends the process.
///
/// Requests of another master that are heard end what is under way with Errc::refused: whose answers come
/// nobody could tell.
class LssDialogue {
 public:
  using Answers = canopen::LssMaster::Answers;

  /// `patience` is how long a first answer is waited for. The session is on CAN.
  LssDialogue(Session& session, Duration patience) : session_(&session), patience_(patience) {}
  LssDialogue(const LssDialogue&) = delete;
  LssDialogue& operator=(const LssDialogue&) = delete;
  ~LssDialogue() { (void)leave(); }

  /// All who answer; none is no error. Errors of the bus, and Errc::interrupted.
  Result<Answers> ask(const canopen::LssRequest& request) { return ask(request, patience_); }
  Result<Answers> ask(const canopen::LssRequest& request, Duration patience);

  /// Takes the one slave of this identity, or without one the only slave on the bus, to the configuration
  /// state, and asks what it is. Errc::timeout when nobody answers, Errc::refused when more than one does,
  /// Errc::protocol when it contradicts itself.
  Result<LssSlave> select(const std::optional<canopen::LssAddress>& address);
  /// Takes all slaves to the configuration state.
  Result<void> select_all();

  /// A request to the slave selected that it has to confirm: `what` names it in errors, such as `set the
  /// node-ID`. Errc::timeout, Errc::negative with its reason when it refuses, Errc::refused when two
  /// answered.
  Result<void> order(const canopen::LssRequest& request, std::string_view what) {
    return order(request, what, patience_);
  }
  Result<void> order(const canopen::LssRequest& request, std::string_view what, Duration patience);

  /// Every slave without a node-ID, one after the other (LSS fastscan). They stay in the configuration state,
  /// and so out of the further scan. Begins anew with more patience, twice at most, when answers were lost.
  Result<std::vector<canopen::LssFastscan::Found>> scan();
  /// Every slave between the two, with a node-ID or without (LSS identify remote slave), by halves; vendor
  /// and product are those of `low`.
  Result<std::vector<canopen::LssAddress>> search(const canopen::LssAddress& low,
                                                  const canopen::LssAddress& high);

  /// All slaves go back to the waiting state, and whether one has not is asked: Errc::negative then, with
  /// what to do. Not heard by Ctrl-C. Sends nothing where nothing was asked since the last time.
  Result<void> leave();

 private:
  Result<std::vector<canopen::LssFastscan::Found>> scan_once(Duration patience);
  Result<bool> search_between(const canopen::LssAddress& low, const canopen::LssAddress& high,
                              std::vector<canopen::LssAddress>& found);
  Result<LssSlave> look(const std::optional<canopen::LssAddress>& address);
  Result<void> send_to_waiting();
  void touch();

  Session* session_;
  Duration patience_;
  bool touched_ = false;  ///< A slave may be in the configuration state.
  bool foreign_ = false;  ///< Another master was heard.
  Protection::Hold hold_;
};

}  // namespace servoctl::session
