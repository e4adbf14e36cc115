#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

/// A slave that a scan found.
struct LssFound {
  canopen::LssAddress address;
  std::size_t slaves = 1;  ///< That say it is they: more than 1 have one identity.
  /// The node-ID that it has or is to have, 1..127: some slaves answer fastscan with one, too.
  std::optional<std::uint8_t> node = {};
};

/// Where a scan is. How many slaves there are nobody knows; of the identity that is looked for next it is
/// known how many of its bits are found.
struct LssProgress {
  std::size_t found = 0;
  std::uint32_t known = 0;
  std::uint32_t bits = 0;
  bool again = false;  ///< Answers were lost or late: the scan has begun anew, with more patience.
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
  Result<Answers> ask(const canopen::LssRequest& request, Duration patience) {
    return ask(request, Pace{patience, kFurther});
  }
  /// How long a first answer is waited for, and then another slave's.
  struct Pace {
    Duration patience;
    Duration further;
  };
  Result<Answers> ask(const canopen::LssRequest& request, Pace pace);

  /// How many answered. A question that nobody answers is asked once more: the one answer may have been lost.
  Result<std::size_t> probe(const canopen::LssRequest& request, Pace pace);

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

  /// Every slave without a node-ID (LSS fastscan), in the order of their identities: bit by bit, both halves
  /// of all in which somebody answers. The slaves stay in the waiting state meanwhile, for some of those in
  /// the configuration state answer every step of a scan; at the end each is selected by what was found, and
  /// has to say that it is there. Hasty at first; begins anew with more patience, twice at most, when answers
  /// were lost or late.
  Result<std::vector<LssFound>> scan();
  /// Every slave between the two, with a node-ID or without (LSS identify remote slave), by halves; vendor
  /// and product are those of `low`.
  Result<std::vector<canopen::LssAddress>> search(const canopen::LssAddress& low,
                                                  const canopen::LssAddress& high);

  /// Told at each step of a scan or a search; may be empty.
  void on_progress(std::function<void(const LssProgress&)> told) { told_ = std::move(told); }
  void tell(LssProgress progress) const {
    progress.again = again_;
    if (told_) told_(progress);
  }

  /// All slaves go back to the waiting state, and whether one has not is asked: Errc::negative then, with
  /// what to do. Not heard by Ctrl-C. Sends nothing where nothing was asked since the last time.
  Result<void> leave();

 private:
  /// From an answer to that of another slave: as long as a slow one takes.
  static constexpr Duration kFurther = std::chrono::milliseconds(100);

  Result<void> confirm(std::vector<LssFound>& found);
  Result<bool> search_between(const canopen::LssAddress& low, const canopen::LssAddress& high, Pace pace,
                              std::vector<canopen::LssAddress>& found);
  /// Hasty first, then with more patience.
  std::array<Pace, 3> paces() const;
  Result<LssSlave> look(const std::optional<canopen::LssAddress>& address);
  Result<void> send_to_waiting();
  void touch();

  Session* session_;
  Duration patience_;
  bool touched_ = false;  ///< A slave may be in the configuration state.
  bool foreign_ = false;  ///< Another master was heard.
  Protection::Hold hold_;
  std::function<void(const LssProgress&)> told_;
  bool again_ = false;
};

}  // namespace servoctl::session
