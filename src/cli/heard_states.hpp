#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canopen/pdo.hpp"
#include "drive/profile.hpp"
#include "session/hearing.hpp"
#include "session/session.hpp"

namespace servoctl::cli {

/// What drives were last heard to say of their state: the statusword wherever it is read, on CAN by another
/// master too, in TPDOs and in the process image of EtherCAT; emergencies; over Modbus the alarm of the
/// panel; and what the network knows of its nodes. Sends nothing, ever.
class HeardStates {
 public:
  /// What was heard longer ago than this may no longer be so.
  static constexpr Duration kFresh = std::chrono::seconds(5);

  /// Lives no longer than the session. It stands before whoever is told of its transfers otherwise.
  explicit HeardStates(session::Session& session);
  HeardStates(const HeardStates&) = delete;
  HeardStates& operator=(const HeardStates&) = delete;
  ~HeardStates() { session_->options().exchanged = {}; }

  struct State {
    std::string text;     ///< `operation enabled`, `EMCY 0x2310`, `PRE-OP`; empty: nothing is known.
    bool unsure = false;  ///< Heard longer ago than kFresh, before a controlword, or by an assumed mapping.
    bool fault = false;   ///< A fault, or an emergency after what was last heard of the state.
    bool operator==(const State&) const = default;
  };
  /// The data of the node's family; null where they are not known. Asked only where they are needed.
  using Family = std::function<const drive::Profile*()>;
  /// TPDOs are taken apart by the mapping that was read, while it holds; else by the one the family leaves
  /// the factory with, which is assumed, unless somebody has changed it.
  State state(std::uint8_t node, const Family& family = {});

 private:
  struct Word {
    std::uint16_t value = 0;
    TimePoint time;
    bool unsure = false;
  };
  struct Node {
    std::optional<Word> status;     ///< 6041h.
    std::optional<Word> in_tpdos;   ///< 6041h in TPDOs, when it was last asked for.
    std::optional<Word> emergency;  ///< Its code; none after an error reset.
    std::uint32_t boots = 0;        ///< When it was heard.
    TimePoint commanded{};          ///< When a controlword was written by object last.
    TimePoint started{};            ///< When it was heard to start last.
    const drive::Profile* family = nullptr;
    std::vector<canopen::Pdo> assumed;  ///< The mapping that drives of this family leave the factory with.
    std::map<ObjectAddress, Word> registers;  ///< Over Modbus, which has no statusword: what was read.
  };
  struct Payload {
    can::Frame frame;
    TimePoint time;
  };
  void on_frame(const can::Frame& frame, TimePoint time);
  void on_answer(std::uint8_t node, const can::Frame& frame, TimePoint time);
  void on_emergency(std::uint8_t node, std::uint16_t code, TimePoint time);
  void on_object(const session::Exchange& exchange);
  void on_write(std::uint8_t node, ObjectAddress object, TimePoint time);
  Node& of_now(std::uint8_t node);
  std::optional<Word> newest_status(std::uint8_t node, const Family& family);
  std::optional<Word> status_in_image(std::uint8_t node) const;
  std::optional<Word> status_in_tpdos(std::uint8_t node, const Family& family);
  std::optional<Word> status_in(std::span<const canopen::Pdo> pdos) const;
  void add_network_error(std::uint8_t node, State& out) const;
  void add_alarm(std::uint8_t node, const Family& family, State& out) const;

  session::Session* session_;
  std::array<Node, 128> nodes_{};
  std::map<std::uint32_t, Payload> tpdos_;  ///< The last frame of each CAN-ID of 11 bits that a PDO may have.
  session::Hearing hearing_;
};

}  // namespace servoctl::cli
