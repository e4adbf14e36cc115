#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "session/lss.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// What is known of an LSS slave before it gets a node-ID.
struct LssNodeChange {
  std::optional<canopen::LssAddress> address;  ///< Empty: the only slave on the bus.
  std::uint8_t to = 0;                         ///< 1 to 127, or canopen::kUnconfigured.
  bool keep = false;                           ///< Stored, so that it outlives power-off.
};

/// How long a slave may take to store its configuration, at least.
inline constexpr Duration kLssStorePatience = std::chrono::seconds(3);

/// Selects the slave, asks what it is, and sends all back to waiting; refuses what must not be changed now:
/// an energised drive, or one whose number an energised one has too, which hears the reset as well, and a
/// node-ID that somebody else uses. Changes nothing.
Result<session::LssSlave> look_at_lss_slave(show::Desk& desk, const LssNodeChange& change);

/// It has this node-ID already: there is nothing to restart, and nothing to do unless it is to be stored.
bool has_lss_node(const session::LssSlave& slave, const LssNodeChange& change);

/// What showed that another drive has the number of the slave, in words; empty: nothing.
std::string shared_lss_node(session::Session& session, const session::LssSlave& slave);

/// What came of it.
struct LssNodeOutcome {
  std::string result;                   ///< In words: `moved`, `node-ID given`, …
  bool taken = false;                   ///< The slave said that it has taken it.
  bool done = false;                    ///< The slave is found under its new node-ID.
  std::optional<std::uint8_t> strayed;  ///< It is found under another one than it has confirmed.
  std::optional<bool> kept;             ///< Whether it outlives power-off; empty where nobody knows.
  std::optional<Error> error;           ///< What went wrong, and where the slave is as far as that is known.
};

/// Gives the slave its node-ID (CiA 305, configure node-ID), stores it where that is wanted, and lets it
/// start with it: one without a node-ID does so by itself when all go back to waiting, another by an NMT
/// reset of its communication. Then it is looked for: its boot-up, and 1018h; where it is not found, by its
/// identity under all other node-IDs. Where storing fails, the old node-ID is written back. From the first
/// request to the reset Ctrl-C is not heard; after Ctrl-C nothing is written. Nobody is asked.
LssNodeOutcome give_lss_node(show::Desk& desk, const session::LssSlave& slave, const LssNodeChange& change);

}  // namespace servoctl::settings
