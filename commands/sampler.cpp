#include "commands/sampler.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <utility>

#include "base/csv.hpp"
#include "base/number.hpp"
#include "session/measure.hpp"

namespace servoctl::commands {
namespace {

using report::Value;

/// What the drives say their units are worth, each asked once.
void add_bridges(Context& context, std::vector<Channel>& channels) {
  if (context.profile == nullptr) return;
  std::vector<session::MeasureQuestion> questions;
  std::vector<Channel*> asking;
  for (auto& channel : channels) {
    const auto measure = drive::meaning(channel.target, channel.node).measure;
    if (!measure || context.profile->rules.units.count(*measure) == 0) continue;
    questions.push_back({channel.node, *measure});
    asking.push_back(&channel);
  }
  if (questions.empty()) return;
  const auto measures = session::read_measures(*context.session, *context.profile, questions);
  for (std::size_t i = 0; i < asking.size(); ++i) {
    const auto unit = drive::meaning(asking[i]->target, asking[i]->node).unit;
    if (measures[i]) asking[i]->bridge = drive::bridge(unit, asking[i]->target.address, *measures[i]);
  }
}

/// A number in the unit people think in, and that unit.
struct Quantity {
  double value = 0;
  std::string_view unit;
};
std::optional<Quantity> quantity(const Channel& channel, ByteSpan bytes) {
  auto meaning = drive::fitted(drive::meaning(channel.target, channel.node), bytes.size());
  meaning.bridge = channel.bridge;
  const auto type = type_of({channel.node, channel.target, {}, Bytes{}}, bytes);
  const auto value = od::decode(type, bytes);
  if (!value || !(od::is_integer(type) || od::is_real(type))) return std::nullopt;
  if (const auto familiar = drive::familiar(meaning, *value))
    return Quantity{familiar->value, familiar->unit};
  return Quantity{drive::scaled(meaning, *value), meaning.unit};
}

Value rounded(double number) { return parse_real(fmt::format("{:.9g}", number)).value_or(number); }

}  // namespace

Result<Sampler> Sampler::make(Context& context, std::span<const std::string> names) {
  Sampler out(context);
  for (const auto node : context.nodes)
    for (const auto& name : names) {
      const auto target = drive::resolve(context.profile, name);
      if (!target) return tl::unexpected<Error>(target.error());
      auto label = context.chinese ? target->label_zh() : target->label();
      if (label.empty()) label = to_string(target->address);
      out.channels_.push_back({node, *target, std::move(label), context.nodes.size() > 1});
    }
  out.brought_.resize(out.channels_.size());
  add_bridges(context, out.channels_);
  out.find_pdos();
  return out;
}

void Sampler::find_pdos() {
  const auto answers = session::read_pdos(*context_->session, context_->profile, context_->nodes);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i]) continue;
    for (const auto& pdo : *answers[i]) {
      if (!pdo.is_valid() || pdo.direction != canopen::PdoDirection::transmit) continue;
      const auto view = make_view(context_->profile, context_->chinese, context_->nodes[i], pdo);
      for (std::size_t c = 0; c < channels_.size(); ++c)
        for (const auto& field : view.fields)
          if (channels_[c].node == view.node && channels_[c].target.address == field.entry.object)
            sources_.push_back({c, view.can_id(), field, pdo.bits()});
    }
  }
}

bool Sampler::on_frame(const can::Frame& frame, TimePoint time) {
  if (frame.extended || frame.remote || frame.error) return false;
  bool found = false;
  for (const auto& source : sources_) {
    const auto data = frame.payload();
    if (source.can_id != frame.id || data.size() * 8 < source.bits) continue;
    const canopen::PdoEntry skipped{{0x0001, 0}, static_cast<std::uint8_t>(source.field.first_bit)};
    const canopen::PdoEntry entries[] = {skipped, source.field.entry};
    brought_[source.channel] = canopen::unpack_pdo(entries, data)->back();
    found = true;
  }
  if (found) brought_at_ = time;
  return found;
}

bool Sampler::is_carried() const {
  for (std::size_t c = 0; c < channels_.size(); ++c)
    if (std::none_of(sources_.begin(), sources_.end(), [&](const Source& s) { return s.channel == c; }))
      return false;
  return true;
}

bool Sampler::is_complete() const {
  return std::all_of(brought_.begin(), brought_.end(), [](const auto& value) { return value.has_value(); });
}

std::vector<Sample> Sampler::take() {
  std::vector<Sample> out(channels_.size());
  std::vector<session::SdoRequest> requests;
  std::vector<std::size_t> owners;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (brought_[i]) {
      out[i] = {*std::exchange(brought_[i], std::nullopt), true};
      continue;
    }
    requests.push_back({.node = channels_[i].node, .object = channels_[i].target.address});
    owners.push_back(i);
  }
  auto answers = context_->session->transfer(requests);
  for (std::size_t k = 0; k < answers.size(); ++k) out[owners[k]].bytes = std::move(answers[k]);
  return out;
}

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
  if (channel_->several_nodes) series_.name += fmt::format(" (node {})", channel_->node);
  series_.seconds.push_back(seconds);
  series_.values.push_back(number->value);
  statistics_.add(number->value);
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
                   {"mean"},
                   {"max"},
                   {"unit"}};
  for (const auto& record : records) {
    const auto& channel = record.channel();
    const auto& numbers = record.statistics();
    const auto number = [&](double value) { return numbers.count() == 0 ? Value() : rounded(value); };
    table.rows.push_back({channel.node, channel.target.address.index, channel.target.address.sub,
                          channel.name, numbers.count(), record.by_pdo(), record.failures(),
                          number(numbers.least()), number(numbers.mean()), number(numbers.greatest()),
                          report::text_or_null(record.series().unit)});
  }
  return table;
}

std::vector<Series> series_of(std::span<const ChannelRecord> records) {
  std::vector<Series> out;
  for (const auto& record : records)
    if (!record.series().values.empty()) out.push_back(record.series());
  return out;
}

std::string series_csv(std::span<const Series> series) {
  std::string out = "seconds";
  for (const auto& entry : series)
    out += ',' + csv_cell(entry.unit.empty() ? entry.name : fmt::format("{} ({})", entry.name, entry.unit));
  out += '\n';
  std::map<double, std::vector<std::string>> lines;
  for (std::size_t i = 0; i < series.size(); ++i)
    for (std::size_t k = 0; k < series[i].seconds.size(); ++k) {
      auto& cells = lines[series[i].seconds[k]];
      cells.resize(series.size());
      cells[i] = fmt::format("{:.12g}", series[i].values[k]);
    }
  for (const auto& [seconds, cells] : lines) {
    out += fmt::format("{:.6f}", seconds);
    for (const auto& cell : cells) out += ',' + cell;
    out += '\n';
  }
  return out;
}

}  // namespace servoctl::commands
