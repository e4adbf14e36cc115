#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "cli/terminal/colour.hpp"
#include "command/command.hpp"
#include "show/axis_names.hpp"

namespace servoctl::cli {

/// Where a setting was made, the weakest first. A stronger source wins; two of the same strength must not
/// contradict each other.
enum class Source : std::uint8_t {
  folder,       ///< Found from the current folder, or nowhere.
  environment,  ///< $SERVOCTL_…
  set,          ///< By the prompt, a batch file, or options for several lines.
  line,         ///< An option of this line.
};

/// What holds for one command line: its global options over what the prompt has set over the environment.
struct Settings {
  std::string bus;    ///< URL; empty: none given.
  std::string nodes;  ///< As written: `1,3,5-8`, `all`; empty: none given.
  std::string drive;  ///< Family or file; empty: none given.
  Source bus_from = Source::environment;
  Source nodes_from = Source::environment;
  Source drive_from = Source::environment;
  Source cabinet_from = Source::folder;
  Duration timeout = std::chrono::milliseconds(500);
  std::uint32_t retries = 1;
  bool json = false;
  bool samples = false;  ///< One JSON document a sample.
  bool chinese = false;
  bool yes = false;
  Colour colour = Colour::automatic;
  bool quiet = false;         ///< No notices and no progress.
  bool verbose = false;       ///< What is done is told.
  bool force_family = false;  ///< Although the drive's identity contradicts the family.
  bool read_only = false;
  bool dry_run = false;
  std::filesystem::path trace;
  std::filesystem::path cabinet;  ///< That was named; empty: the one found from the current folder.
  bool of_cabinet = false;        ///< Bus, nodes and family are those of axes: other buses stay open.
  show::AxisNames names;          ///< Of the nodes of the bus.

  bool nodes_typed() const { return nodes_from == Source::line; }
  bool drive_typed() const { return drive_from == Source::line; }
  /// What one line said holds for the lines that follow, too.
  void keep_for_lines();

  /// Whether results, errors and notices are text in Chinese. In JSON only names from data are.
  bool shows_chinese() const { return chinese && !json; }
};

/// Defaults from $SERVOCTL_BUS, $SERVOCTL_NODE, $SERVOCTL_DRIVE, $SERVOCTL_CABINET and $SERVOCTL_LANG (or a
/// Chinese $LANG).
Settings settings_from_environment();

/// What a setting of this source is called: `--bus`, `$SERVOCTL_BUS`, `the prompt`; `option` is `--bus`.
std::string name_of(Source source, std::string_view option);

/// What the words say of it, in a line that may be wrong elsewhere.
bool wants_json(const std::vector<std::string>& words);
/// The same of the colours.
Colour wanted_colour(const std::vector<std::string>& words, Colour otherwise);
/// The same of the language; `otherwise` where they say nothing.
bool wants_chinese(const std::vector<std::string>& words, bool otherwise);

/// `base` with the global options of one line on top. Errc::usage for a value that is none.
Result<Settings> apply_options(Settings base, const command::Arguments& arguments);

/// Reads `1`, `1,3,5-8` (rising, without doubles) or `all` ({0}). Errc::usage for anything else or an ID
/// outside 1..127.
Result<std::vector<std::uint8_t>> parse_nodes(std::string_view text);

}  // namespace servoctl::cli
