#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/series.hpp"
#include "base/statistics.hpp"
#include "show/pdo_book.hpp"
#include "show/reading.hpp"

namespace servoctl::traffic {

/// One object of one node that is looked at again and again.
struct Channel {
  std::uint8_t node = 0;
  drive::Target target;
  std::string name;                          ///< `Statusword`
  bool several_nodes = false;                ///< The name alone does not tell which it is.
  std::optional<drive::Bridge> bridge = {};  ///< What the drive's own measures say of the unit.
};

/// A value of a channel.
struct Sample {
  std::size_t channel = 0;
  TimePoint time{};  ///< When the frame that brought it arrived; of a failed read, when that was over.
  Result<Bytes> bytes = Bytes{};
  bool by_pdo = false;  ///< A TPDO brought it.
};

/// Looks at objects of drives: takes what TPDOs bring, and reads by SDO what they do not.
class Sampler {
 public:
  /// The objects of all nodes of the desk. Errc::usage for an unknown name. Asks the nodes for their PDO
  /// mapping; one that does not tell it is read by SDO alone.
  static Result<Sampler> make(show::Desk& desk, std::span<const std::string> names);

  /// Every frame that is received, in every wait (see session::Hearing). The values it brings, when it is a
  /// TPDO with some of the objects.
  std::vector<Sample> on_frame(const can::Frame& frame, TimePoint time);
  /// Reads these channels, all nodes at the same time; in the order of `wanted`.
  std::vector<Sample> read(std::span<const std::size_t> wanted);
  /// A value of each channel: the last one a TPDO brought since the call before, else read now.
  std::vector<Sample> take();

  std::span<const Channel> channels() const { return channels_; }
  /// Whether some TPDO carries the channel.
  bool is_carried(std::size_t channel) const;

 private:
  explicit Sampler(show::Desk& desk) : desk_(&desk) {}
  void find_pdos();

  /// Where a channel is found in a TPDO.
  struct Source {
    std::size_t channel = 0;
    std::uint32_t can_id = 0;
    show::PdoField field;
    std::size_t bits = 0;  ///< Of the whole PDO.
  };

  show::Desk* desk_;
  std::vector<Channel> channels_;
  std::vector<Source> sources_;
  std::vector<std::optional<Sample>> brought_;
  std::vector<TimePoint> answered_;  ///< When the SDO answer of each channel last came.
};

/// Errc::usage for a channel whose object is known to be no number.
Result<void> check_number(const Channel& channel);
/// The same of what was read, where the dictionary does not tell.
Result<void> check_number(const Channel& channel, ByteSpan bytes);

/// The reads that fail still: of each node the first error, for `desk.errors`.
std::vector<Error> failures_of(std::span<const Sample> last);

/// What was sampled of one channel: a Series with its statistics.
class ChannelRecord {
 public:
  explicit ChannelRecord(const Channel& channel) : channel_(&channel) {}

  /// `seconds` is the time of the sample, counted from where the record begins.
  void add(double seconds, const Sample& sample);

  const Channel& channel() const { return *channel_; }
  const Series& series() const { return series_; }
  const Statistics& statistics() const { return statistics_; }
  std::size_t failures() const { return failures_; }
  std::size_t by_pdo() const { return by_pdo_; }

 private:
  const Channel* channel_;
  Series series_;
  Statistics statistics_;
  std::size_t failures_ = 0;
  std::size_t by_pdo_ = 0;
};

/// Object by object: how many values, least, mean, greatest, how many came by PDO, how many reads failed.
report::Table sampling_table(std::span<const ChannelRecord> records);

/// The series of the channels that had any number.
std::vector<Series> series_of(std::span<const ChannelRecord> records);

/// Series as CSV: a line for each time, a column for each quantity, empty where it has no value then.
std::string series_csv(std::span<const Series> series);

}  // namespace servoctl::traffic
