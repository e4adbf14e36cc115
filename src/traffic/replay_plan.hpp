#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "can/trace.hpp"
#include "session/write_plan.hpp"
#include "show/desk.hpp"
#include "traffic/recording.hpp"

namespace servoctl::traffic {

/// The drives a recording is about, as they are on this bus now.
struct ReplayDrives {
  std::set<std::uint8_t> present;                          ///< Those that answer.
  std::map<std::uint8_t, session::Values> pdos;            ///< What they say of their PDOs.
  std::map<std::uint32_t, std::set<std::uint8_t>> listen;  ///< By CAN-ID, those that have an RPDO there.
};

/// Asks the nodes of the recording, or of one of its buses, whether they are there, and what their PDOs are.
/// Errc::bus or interrupted.
Result<ReplayDrives> find_drives(show::Desk& desk, std::string_view recording, std::string_view channel = {},
                                 const can::ReadOptions& read = {});

/// Kinds of frames in words (`NMT start`, `write of Controlword`), and how many there are of each.
using FrameKinds = std::map<std::string, std::size_t>;

/// What is to be sent, and what may come of it.
struct ReplayPlan {
  std::vector<can::LogFrame> frames;
  std::size_t seen = 0;  ///< Frames of CANopen in the recording, chosen or not.
  std::map<std::string_view, std::size_t> services;
  FrameKinds moving;                ///< What can move a motor, or change how it moves.
  FrameKinds lasting;               ///< What restarts a drive, re-addresses it, stores or starts an action.
  std::set<std::uint8_t> nodes;     ///< Those that what can move is sent to.
  std::set<std::uint32_t> dropped;  ///< CAN-IDs that --master left out as TPDOs although no drive told so.
  std::size_t extended = 0;         ///< Frames of 29 bits, which are not sent.
  Strays strays;                    ///< Lines that gave no frame.

  std::size_t dangerous() const;
};

/// Which frames are wanted.
struct ReplayChoice {
  std::span<const std::string> only;  ///< Services, of kServices; empty: all.
  bool of_master = false;             ///< Only what a master sends.
  std::string_view channel = {};      ///< Of this bus of the recording; empty: of all.
  can::ReadOptions read = {};         ///< How the recording is written.
};

/// Chooses the frames; reports of the controller and 29-bit identifiers are none
/// that CANopen sends. With a family, writes that take effect after a restart alone count as harmless;
/// without one, every write from 2000h on counts as one that can move.
ReplayPlan plan_replay(const show::Desk& desk, const ReplayChoice& choice, std::string_view recording,
                       const ReplayDrives& drives);

/// `1 NMT start, 2 SYNC, 12 write of Target velocity`; of many kinds the first.
std::string kinds_text(const FrameKinds& kinds);

}  // namespace servoctl::traffic
