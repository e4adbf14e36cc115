#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cabinet/cabinet.hpp"
#include "cli/settings.hpp"
#include "command/command.hpp"

/// Axes by name in command lines.
namespace servoctl::cli {

/// The cabinet file that lines are held against: read when a line needs it, and again when it has changed.
class CabinetHolder {
 public:
  /// The file of the settings, or `cabinet.toml` in the current folder or above; null where there is none.
  /// Errc::file for one that was named and is not there, or cannot be used.
  Result<const cabinet::Cabinet*> get(const Settings& settings);
  /// From now on `cabinet.toml` is searched for once, for many lines, until search_again().
  void search_once(bool once) {
    searches_once_ = once;
    search_again();
  }
  /// A line may have made one.
  void search_again() { found_.reset(); }

 private:
  bool searches_once_ = false;
  std::optional<std::filesystem::path> found_;
  std::filesystem::path file_;
  std::filesystem::file_time_type written_;
  std::uintmax_t size_ = 0;
  std::optional<cabinet::Cabinet> cabinet_;
};

/// What of a line concerns axes of one bus and one family, or one bus where the line names no node.
struct LinePart {
  Settings settings;  ///< Bus, nodes and family are those of the axes, and so is what they are called.
  std::vector<const cabinet::Axis*> axes;
  std::vector<const cabinet::Axis*> on_bus = {};  ///< All that the file has on this bus.
};

/// The settings on a bus of the cabinet, which says what its nodes are called.
LinePart on_bus(const cabinet::Cabinet& cabinet, const Settings& settings, const cabinet::Bus& bus);

/// Whether a list of nodes holds names: anything but numbers and `all`.
bool names_axes(const std::string& nodes);

/// `jog feeder 300mm/s` is `jog -n feeder 300mm/s`: where the first word after a command that needs nodes is
/// an axis or a group, and no node is named. `after` is where the words of the command end.
std::vector<std::string> with_axis_option(std::vector<std::string> words, const command::Command& command,
                                          std::size_t after, const cabinet::Cabinet& cabinet);

/// The parts of a line; none where it concerns no cabinet: its bus is given, and its nodes are numbers.
/// Errc::usage for an axis that is not there, and where a source at least as strong as the one that names the
/// axes says another bus or family than the file. Weaker ones lose, which `notices` say.
Result<std::vector<LinePart>> parts_of(const cabinet::Cabinet& cabinet, const command::Command& command,
                                       const command::Arguments& arguments, const Settings& settings,
                                       std::vector<Message>& notices);

/// An option that the file says, and the key under which it does: `--limit`, `limits.speed`.
struct OptionOfAxis {
  std::string_view option;
  std::string_view key;
};

/// What the file says of axes holds as if it was typed, as far as it is the same for all of them, the command
/// takes it and the line does not say otherwise: counts, encoder and limits. The answer is what was taken.
std::vector<OptionOfAxis> add_axis_options(std::span<const cabinet::Axis* const> axes,
                                           const command::Command& command, command::Arguments& arguments);

}  // namespace servoctl::cli
