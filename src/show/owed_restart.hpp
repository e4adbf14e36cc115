#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "drive/profile.hpp"
#include "report/value.hpp"
#include "session/owed_restarts.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// What of one drive waits for a restart, as it is kept from one line, and one session, to the next.
struct OwedRestart {
  session::Identity identity;
  std::vector<session::OwedValue> values;
  bool by_power = false;                          ///< An NMT reset is no restart of this drive.
  std::optional<ObjectAddress> node_id = {};      ///< Where its node-ID is.
  std::optional<std::uint32_t> bus_bitrate = {};  ///< Of the bus, if a new bitrate is among the values.
  std::optional<Error> unread = {};               ///< What is kept of it cannot be read.
};

/// The file in the folder for state that holds it: one for each bus, however that was written, and node.
class OwedRestartFile {
 public:
  OwedRestartFile(const std::filesystem::path& state_folder, std::string_view bus_url, std::uint8_t node);

  bool is_there() const;
  /// Empty when there is none. Errc::file for one that is damaged.
  Result<std::optional<OwedRestart>> read() const;
  /// Errc::file.
  Result<void> write(const OwedRestart& owed) const;
  void remove() const;

 private:
  std::uint8_t node_;
  std::filesystem::path path_;
};

/// The nodes of a bus of which the folder for state has such a file, in order.
std::vector<std::uint8_t> owing_nodes(const std::filesystem::path& state_folder, std::string_view bus_url);

/// The node-ID that waits for the restart.
std::optional<std::uint8_t> next_node_id(const std::vector<session::OwedValue>& values,
                                         const std::optional<ObjectAddress>& node_id);

enum class Owing : std::uint8_t {
  waits,       ///< Nothing shows that the drive has restarted.
  over,        ///< It answers with the node-ID or at the bitrate that waited.
  of_another,  ///< The drive at this node is another one: its own may come back, and not have restarted.
};

/// Asks the drives. Over is what is proved: by equal serial numbers, or by a drive of the kind that was heard
/// to start at the node-ID that waited while the old one is silent.
Owing owing(session::Session& session, std::uint8_t node, const OwedRestart& owed,
            bool has_started_at_next = false);

/// What is stored in a node and comes into force with its next restart, where it is the drive that this is
/// kept of: it is asked who it is only where something is kept. One that does not say is taken for it. What
/// is over is forgotten.
OwedRestart owed_restart(session::Session& session, const std::filesystem::path& state_folder,
                         std::uint8_t node);

/// `stored, in force after a restart`, or `written, …` where one of them is not known to be stored.
std::string_view owed_lead(const std::vector<session::OwedValue>& values);
/// `Pn0601 = 0 (1 in force)`, one after the other; in Chinese the labels are.
std::string owed_text(const drive::Profile* profile, std::uint8_t node,
                      const std::vector<session::OwedValue>& values, bool chinese);
/// `Pn0601`, for each.
std::vector<std::string> owed_names(const drive::Profile* profile,
                                    const std::vector<session::OwedValue>& values);
/// One record for each: `index sub id in_force stored`, the two as raw bytes.
report::List owed_records(const drive::Profile* profile, const std::vector<session::OwedValue>& values);
/// What is said of a node that waits; empty where it does not.
std::string owed_notice(const Desk& desk, std::uint8_t node, const OwedRestart& owed);

}  // namespace servoctl::show
