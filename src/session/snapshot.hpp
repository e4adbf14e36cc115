#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drive/drive_settings.hpp"
#include "session/scan.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// One object of a snapshot: its bytes, or why there are none.
struct SnapshotEntry {
  ObjectAddress object;
  std::optional<Bytes> bytes;
  std::string left_out;
};

/// The settings of one drive at one time.
struct Snapshot {
  Identity identity;
  std::vector<SnapshotEntry> entries;  ///< In rising address.
};

/// Which settings are wanted; all when empty.
using SettingFilter = std::function<bool(const drive::DriveSetting&)>;

/// Reads identity and settings of all nodes, at the same time. An object the drive refuses is left out, with
/// the reason; a node that does not answer to the end has no snapshot but an error.
std::vector<Result<Snapshot>> take_snapshots(Session& session, const drive::Profile& profile,
                                             std::span<const std::uint8_t> nodes,
                                             const SettingFilter& wanted);
/// The same, with patience for a bus that is lost meanwhile (BusReturn): once it is back all is read anew,
/// because a drive may have restarted. Errc::refused for all where one of them is another drive now.
std::vector<Result<Snapshot>> take_snapshots_patiently(Session& session, const drive::Profile& profile,
                                                       std::span<const std::uint8_t> nodes,
                                                       const SettingFilter& wanted);

/// Reads these objects of one node; a refused one is left out, with the reason.
Result<std::vector<SnapshotEntry>> read_objects(Session& session, std::uint8_t node,
                                                std::span<const ObjectAddress> objects);

}  // namespace servoctl::session
