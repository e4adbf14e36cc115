#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "session/node_state.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// After a request of a state, before anything else is sent to the node: nothing confirms it, and CiA 301
/// names no time.
inline constexpr Duration kRequestPause = std::chrono::milliseconds(20);

/// What a dialogue wants next: one of these.
struct DialogueStep {
  std::optional<session::SdoRequest> request = {};  ///< A transfer, whose result goes to on_answer().
  std::optional<session::NodeState> state = {};     ///< The node is told to enter it, which is not answered.
  TimePoint pause = TimePoint::min();               ///< Else to be asked again then.
  bool done = false;
};

/// A talk with one node in which the answer to one question decides about the next. A machine without I/O.
class Dialogue {
 public:
  Dialogue() = default;
  Dialogue(const Dialogue&) = delete;
  Dialogue& operator=(const Dialogue&) = delete;
  virtual ~Dialogue() = default;

  virtual std::uint8_t node() const = 0;
  /// Asked when nothing is under way.
  virtual DialogueStep next(TimePoint now) = 0;
  virtual void on_answer(Result<Bytes> answer, TimePoint now) = 0;
  /// Another signal came while it went on. Called when nothing is under way.
  virtual void hasten(TimePoint) {}
  /// The bus was lost and is back: whatever was under way is not.
  virtual void on_bus_back() = 0;
  /// What may help when nothing can be asked any more; sent without waiting, and whether it arrives is not
  /// known.
  virtual std::optional<session::SdoRequest> last_word() const { return std::nullopt; }
  /// The bus is lost, or something else ended all dialogues: there is no answer to come.
  virtual void on_end(const Error& error) = 0;
};

/// Holds all dialogues, of different nodes, at the same time: what each asks first is sent before anything is
/// waited for, and none waits for another. `bus_back` waits for a bus that is lost and answers whether it is
/// back.
void hold_all(session::Session& session, std::span<Dialogue* const> dialogues,
              const std::function<bool(const Error& lost)>& bus_back);

}  // namespace servoctl::motion
