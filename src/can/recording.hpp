#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/text.hpp"
#include "can/byte_window.hpp"
#include "can/column_choice.hpp"
#include "can/log_clock.hpp"
#include "can/trace.hpp"

/// Recorded frames: candump, .asc, .trc, pcap, pcapng, BLF, and lines and tables of other tools. What a
/// recording is, its beginning tells.
namespace servoctl::can {

/// Takes a frame; false: no more.
using TakeLogFrame = std::function<bool(const LogFrame& frame)>;

/// Where a file stops making sense: it was cut short, or tells lengths that cannot be.
struct RecordingDamage {
  std::uint64_t offset = 0;  ///< In bytes from the beginning.
  std::string what;
  bool joined = false;  ///< It is whole: another recording begins there.
};

/// What of a recording gave no frame.
struct RecordingStrays {
  std::size_t unknown = 0;                ///< Lines, or records, that are no frame of any kind.
  std::size_t first = 0;                  ///< Number of the first of them, from 1.
  std::string first_text;                 ///< The first of them, if it is a line.
  std::size_t unsuited = 0;               ///< CAN FD, or another bus system.
  std::size_t ethercat = 0;               ///< Of these, packets of EtherCAT.
  bool records = false;                   ///< They are records, not lines.
  std::optional<RecordingDamage> damage;  ///< All frames in front of it were taken.
  /// The recording does not say in which base its numbers are: nothing was read. The line that asks.
  std::size_t open_base = 0;
  unsigned assumed_base = 0;       ///< That of the identifiers, concluded from how the data are written.
  unsigned assumed_data_base = 0;  ///< That of the data, concluded from how the identifiers are written.
  bool of_table = false;           ///< A table or a log of another tool, found by headings or words.
  bool lacks_unit = false;         ///< Its times are integers of an unknown unit, and were not read.

  void add_unknown(std::size_t number, std::string_view text = {}) {
    if (unknown++ > 0) return;
    first = number;
    first_text = clip(text, kMostText);
  }

 private:
  static constexpr std::size_t kMostText = 60;
};

/// What a reader is told of a recording, and tells of it.
struct ReadOptions {
  const ColumnChoice* columns = nullptr;  ///< As the user names them; null: as the recording does.
  LogClock* clock = nullptr;              ///< Where the clock of the frame that is taken is put; may be null.
};

/// Calls `take` with each frame, in the order of the recording, until it answers false.
RecordingStrays for_each_frame(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options = {});
RecordingStrays for_each_frame(std::string_view content, const TakeLogFrame& take,
                               const ReadOptions& options = {});

/// The buses that have frames in it, by their names as `decode` shows them, and how many; error frames are
/// none.
std::map<std::string, std::size_t> frames_of_buses(std::string_view content, const ReadOptions& options = {});

/// `can0 (12), can1 (7)`, for messages.
std::string list_of(const std::map<std::string, std::size_t>& buses);

}  // namespace servoctl::can
