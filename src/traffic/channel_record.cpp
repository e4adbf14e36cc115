#include "traffic/channel_record.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/csv.hpp"
#include "base/format.hpp"
#include "base/number.hpp"

namespace servoctl::traffic {
namespace {

using report::Value;

double milliseconds(double seconds) { return std::round(seconds * 1000) / 1000; }

Value rounded(double number) { return parse_real(formatted("{:.9g}", number)).value_or(number); }

}  // namespace

void ChannelRecord::add(double seconds, const Sample& sample) {
  by_pdo_ += sample.by_pdo;
  if (!sample.bytes) {
    ++failures_;
    return;
  }
  const auto number = quantity(*channel_, *sample.bytes);
  if (!number) return;
  series_.unit = number->unit;
  series_.name = channel_->name;
  if (channel_->several_nodes) series_.name += formatted(" (node {})", channel_->node);
  series_.seconds.push_back(seconds);
  series_.values.push_back(number->value);
  statistics_.add(number->value);
  if (is_word_) add_word(seconds, load_le(*sample.bytes), *sample.bytes);
}

void ChannelRecord::add_word(double seconds, std::uint64_t value, const Bytes& bytes) {
  constexpr std::size_t kMost = 32;
  const auto known =
      std::find_if(words_.begin(), words_.end(), [&](const Word& w) { return w.value == value; });
  if (known == words_.end() && words_.size() == kMost) {
    ++other_words_;
  } else if (known == words_.end()) {
    words_.push_back({value, bytes, 1, seconds, seconds});
  } else {
    ++known->samples;
    known->last = seconds;
  }
}

report::Table sampling_table(std::span<const ChannelRecord> records) {
  report::Table table;
  table.columns = {{"node"},
                   {"index", "", report::Show::json},
                   {"sub", "", report::Show::json},
                   {"name"},
                   {"samples"},
                   {"by_pdo", "by PDO"},
                   {"failed"},
                   {"min"},
                   {"mean", "", report::Show::json},
                   {"mean_text", "mean", report::Show::text},
                   {"max"},
                   {"unit"}};
  for (const auto& record : records) {
    const auto& channel = record.channel();
    const auto& numbers = record.statistics();
    const auto meaning = drive::meaning(channel.target, channel.node);
    const auto number = [&](double value) {
      if (numbers.count() == 0) return Value();
      if (!meaning.bits) return rounded(value);
      const auto word = static_cast<std::uint64_t>(value);
      return Value(report::Hex{word, static_cast<int>(drive::hex_digits(meaning, word))});
    };
    table.rows.push_back({channel.node, channel.target.address.index, channel.target.address.sub,
                          channel.name, numbers.count(), record.by_pdo(), record.failures(),
                          number(numbers.least()), numbers.count() == 0 ? Value() : rounded(numbers.mean()),
                          meaning.bits ? Value() : number(numbers.mean()), number(numbers.greatest()),
                          report::text_or_null(record.series().unit)});
  }
  return table;
}

void add_words(report::Record& out, const show::Desk& desk, std::span<const ChannelRecord> records) {
  report::Table table;
  table.columns = {{"node"},
                   {"index", "", report::Show::json},
                   {"sub", "", report::Show::json},
                   {"name"},
                   {"value"},
                   {"samples"},
                   {"first", "first (s)"},
                   {"last", "last (s)"},
                   {"meaning", "label", report::Show::text},
                   {"label", "", report::Show::json}};
  for (const auto& record : records) {
    const auto& channel = record.channel();
    const auto& object = channel.target.address;
    for (const auto& word : record.words()) {
      const auto value = decoded(desk, channel, word.bytes);
      const auto digits = drive::hex_digits(drive::meaning(channel.target, channel.node), word.value);
      table.rows.push_back({channel.node, object.index, object.sub, channel.name,
                            report::Hex{word.value, static_cast<int>(digits)}, word.samples,
                            milliseconds(word.first), milliseconds(word.last),
                            report::text_or_null(show::label_text(value, desk.chinese)), value.label});
    }
    if (record.other_words() > 0)
      table.rows.push_back({channel.node, object.index, object.sub, channel.name, Value(),
                            record.other_words(), Value(), Value(), "other values", Value()});
  }
  const auto show = table.rows.empty() ? report::Show::json : report::Show::everywhere;
  out.push_back({"words", std::move(table), show, "values of bit fields"});
}

std::vector<Series> series_of(std::span<const ChannelRecord> records) {
  std::vector<Series> out;
  for (const auto& record : records)
    if (!record.series().values.empty()) out.push_back(record.series());
  return out;
}

std::string no_plot_text(std::span<const Channel> channels, std::string_view option) {
  const bool none =
      std::all_of(channels.begin(), channels.end(), [](const Channel& channel) { return channel.is_word(); });
  return none ? formatted("{}: bit fields are not plotted, and no other object is named", option)
              : std::string();
}

std::vector<Series> plotted_series(std::span<const ChannelRecord> records) {
  std::vector<Series> out;
  for (const auto& record : records)
    if (!record.series().values.empty() && !record.channel().is_word()) out.push_back(record.series());
  return out;
}

std::string series_csv(std::span<const Series> series) {
  std::string out = "seconds";
  for (const auto& entry : series) out += ',' + csv_heading(entry.name, entry.unit);
  out += '\n';
  std::map<double, std::vector<std::string>> lines;
  for (std::size_t i = 0; i < series.size(); ++i)
    for (std::size_t k = 0; k < series[i].seconds.size(); ++k) {
      auto& cells = lines[series[i].seconds[k]];
      cells.resize(series.size());
      cells[i] = plain_number(series[i].values[k], 12);
    }
  for (const auto& [seconds, cells] : lines) {
    out += formatted("{:.6f}", seconds);
    for (const auto& cell : cells) out += ',' + cell;
    out += '\n';
  }
  return out;
}

}  // namespace servoctl::traffic
