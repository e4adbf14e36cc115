#pragma once

#include <string>
#include <vector>

#include "base/series.hpp"
#include "base/statistics.hpp"
#include "show/desk.hpp"
#include "show/reading.hpp"
#include "traffic/node_source.hpp"

namespace servoctl::traffic {

/// One object of one node that is looked at again and again.
struct Channel {
  std::uint8_t node = 0;
  drive::Target target;
  std::string name;                               ///< `Statusword`
  bool several_nodes = false;                     ///< The name alone does not tell which it is.
  std::optional<drive::Bridge> bridge = {};       ///< What the drive's own measures say of the unit.
  std::optional<session::DriveUnits> units = {};  ///< As show::Reading::units.

  /// Its bits are what it says: shown in words, and not plotted.
  bool is_word() const { return drive::meaning(target, node).bits; }
};

/// A value of the channel, taken apart.
show::DecodedValue decoded(const show::Desk& desk, const Channel& channel, ByteSpan bytes);

/// A value of a channel.
struct Sample {
  std::size_t channel = 0;
  TimePoint time{};  ///< As of a session::ProcessValues; of a read, when it was over.
  Result<Bytes> bytes = Bytes{};
  bool by_pdo = false;  ///< A TPDO brought it, or a cycle of process data.
};

/// Looks at objects of drives: takes what they send by themselves, and reads by SDO what they do not.
class Sampler {
 public:
  /// The objects of all nodes of the desk. Errc::usage for an unknown name. Asks the nodes for their PDO
  /// mapping; one that does not tell it is read by SDO alone.
  static Result<Sampler> make(show::Desk& desk, std::span<const std::string> names);

  /// What came by itself since the call before, in all waits. To be called often: it notices as well when
  /// what was learned of a node no longer holds, and asks the node again.
  std::vector<Sample> gather();
  /// Reads these channels, all nodes at the same time; in the order of `wanted`.
  std::vector<Sample> read(std::span<const std::size_t> wanted);
  /// A value of each channel: the last one that came by itself since the call before, else read now.
  std::vector<Sample> take();

  std::span<const Channel> channels() const { return channels_; }
  /// Whether the node sends it by itself now.
  bool is_carried(std::size_t channel) const;

 private:
  explicit Sampler(show::Desk& desk) : desk_(&desk) {}
  void begin_hearing();
  void renew();

  show::Desk* desk_;
  std::vector<Channel> channels_;
  std::vector<NodeSource> sources_;
};

/// Errc::usage for a channel whose object is known to be no number.
Result<void> check_number(const Channel& channel);
/// The same of what was read, where the dictionary does not tell.
Result<void> check_number(const Channel& channel, ByteSpan bytes);

/// Why no further look is worth while: the bus was lost, or somebody interrupts; null otherwise.
const Error* end_of_looks(std::span<const Sample> samples);

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
  /// Of a bit field the values that it had, the first of them first, and how many others there were.
  struct Word {
    std::uint64_t value = 0;
    Bytes bytes;
    std::size_t samples = 0;
    double first = 0;  ///< Seconds.
    double last = 0;
  };
  std::span<const Word> words() const { return words_; }
  std::size_t other_words() const { return other_words_; }

 private:
  void add_word(double seconds, std::uint64_t value, const Bytes& bytes);

  const Channel* channel_;
  Series series_;
  Statistics statistics_;
  std::size_t failures_ = 0;
  std::size_t by_pdo_ = 0;
  bool is_word_ = channel_->is_word();
  std::vector<Word> words_;
  std::size_t other_words_ = 0;  ///< Samples.
};

/// Object by object: how many values, least, mean, greatest, how many came by PDO, how many reads failed.
report::Table sampling_table(std::span<const ChannelRecord> records);

/// Adds the values that bit fields had, in words, to a result; a record without any gets none for people.
void add_words(report::Record& out, const show::Desk& desk, std::span<const ChannelRecord> records);

/// The series of the channels that had any number.
std::vector<Series> series_of(std::span<const ChannelRecord> records);

/// For who asks for a plot of channels that are bit fields, all of them: why there is none. Empty for others.
std::string no_plot_text(std::span<const Channel> channels, std::string_view option);

/// Those of them that are plotted: no bit fields.
std::vector<Series> plotted_series(std::span<const ChannelRecord> records);

/// Series as CSV: a line for each time, a column for each quantity, empty where it has no value then.
std::string series_csv(std::span<const Series> series);

}  // namespace servoctl::traffic
