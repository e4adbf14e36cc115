#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/series.hpp"
#include "base/statistics.hpp"
#include "report/value.hpp"
#include "show/desk.hpp"
#include "traffic/sampler.hpp"

namespace servoctl::traffic {

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
