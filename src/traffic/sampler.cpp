#include "traffic/sampler.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "base/format.hpp"
#include "drive/assumed_unit.hpp"
#include "session/measure.hpp"
#include "show/alarm_question.hpp"
#include "show/records.hpp"
#include "show/standard_names.hpp"

namespace servoctl::traffic {
namespace {

/// What the drives say their units are worth, each asked once. `node`: of this one alone.
void add_bridges(show::Desk& desk, std::vector<Channel>& channels, std::optional<std::uint8_t> node = {}) {
  if (desk.profile == nullptr) return;
  std::vector<session::MeasureQuestion> questions;
  std::vector<Channel*> asking;
  for (auto& channel : channels) {
    if (node && channel.node != *node) continue;
    const auto measure = drive::meaning(channel.target, channel.node).measure;
    if (!measure || desk.profile->rules.units.count(*measure) == 0) continue;
    if (drive::is_unit_assumed(channel.target)) continue;
    questions.push_back({channel.node, *measure});
    asking.push_back(&channel);
  }
  if (questions.empty()) return;
  const auto measures = session::read_measures(*desk.session, *desk.profile, questions);
  for (std::size_t i = 0; i < asking.size(); ++i) {
    const auto unit = drive::meaning(asking[i]->target, asking[i]->node).unit;
    asking[i]->bridge.reset();
    if (measures[i]) asking[i]->bridge = drive::bridge(unit, asking[i]->target.address, measures[i]->value);
  }
}

/// Of a drive whose data only assume units: those that it names.
void add_own_units(show::Desk& desk, std::vector<Channel>& channels) {
  const auto* profile = desk.profile != nullptr ? desk.profile : desk.standard;
  if (profile == nullptr || !drive::leaves_units_open(*profile)) return;
  std::map<std::uint8_t, session::DriveUnits> asked;
  for (auto& channel : channels) {
    if (!drive::is_unit_assumed(channel.target)) continue;
    if (asked.count(channel.node) == 0)
      asked.emplace(channel.node, session::DriveUnits(*desk.session, *profile, channel.node));
    channel.units = asked.at(channel.node);
  }
}

/// A number in the unit people think in, and that unit.
Error no_number(const Channel& channel, const Message& why) {
  return show::located(
      make_error(Errc::usage, message("{} is not numeric and cannot be plotted: {}", channel.name, why),
                 "`read` and `watch` show it"),
      channel.node, channel.target.address);
}

}  // namespace

std::optional<Quantity> quantity(const Channel& channel, ByteSpan bytes) {
  auto meaning = drive::as_answered(drive::meaning(channel.target, channel.node), bytes.size());
  if (channel.units) channel.units->apply(channel.target, meaning);
  meaning.bridge = channel.bridge;
  const auto type = show::type_of({channel.node, channel.target, {}, Bytes{}}, bytes);
  const auto value = od::decode(type, bytes);
  if (!value || !(od::is_integer(type) || od::is_real(type))) return std::nullopt;
  if (const auto familiar = drive::familiar(meaning, *value))
    return Quantity{familiar->value, familiar->unit};
  return Quantity{drive::scaled(meaning, *value), meaning.unit};
}

Result<Sampler> Sampler::make(show::Desk& desk, std::span<const std::string> names) {
  Sampler out(desk);
  show::StandardNames standard(desk);
  for (const auto node : desk.nodes)
    for (const auto& name : names) {
      auto target = drive::resolve(desk.profile, name, drive::Match::part);
      if (!target) return fail(target.error());
      target = standard.named(node, *target);
      if (const auto agreed = show::confirm_unlisted(desk, node, std::span(&*target, 1)); !agreed)
        return fail(agreed.error());
      auto label = desk.chinese ? target->label_zh() : target->label();
      if (label.empty()) label = to_string(target->address);
      out.channels_.push_back({node, *target, std::move(label), desk.nodes.size() > 1});
    }
  add_bridges(desk, out.channels_);
  add_own_units(desk, out.channels_);
  out.begin_hearing();
  return out;
}

void Sampler::begin_hearing() {
  std::vector<session::Lifetime> lifetimes;
  for (const auto node : desk_->nodes) lifetimes.emplace_back(*desk_->session, node);
  (void)session::learn_pdos(*desk_->session, desk_->profile, desk_->nodes);
  for (std::size_t i = 0; i < lifetimes.size(); ++i) {
    std::vector<ObjectAddress> objects;
    for (const auto& channel : channels_)
      if (channel.node == desk_->nodes[i]) objects.push_back(channel.target.address);
    sources_.emplace_back(*desk_, desk_->nodes[i], std::move(objects), lifetimes[i]);
  }
}

std::vector<Sample> Sampler::gather() {
  std::vector<Sample> out;
  for (auto& source : sources_)
    for (auto& arrival : source.take_all())
      for (std::size_t i = 0; i < channels_.size(); ++i)
        if (channels_[i].node == source.node() && channels_[i].target.address == arrival.object)
          out.push_back({i, arrival.time, arrival.value, true});
  renew();
  return out;
}

void Sampler::renew() {
  for (auto& source : sources_)
    if (source.renew()) add_bridges(*desk_, channels_, source.node());
}

bool Sampler::is_carried(std::size_t channel) const {
  return std::any_of(sources_.begin(), sources_.end(), [&](const NodeSource& source) {
    return source.node() == channels_[channel].node && source.carries(channels_[channel].target.address);
  });
}

std::vector<Sample> Sampler::read(std::span<const std::size_t> wanted) {
  std::vector<TimePoint> ended(wanted.size());
  std::vector<session::SdoRequest> requests;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const auto& channel = channels_[wanted[k]];
    requests.push_back({.node = channel.node, .object = channel.target.address, .ended = &ended[k]});
  }
  auto answers = desk_->session->transfer(requests);
  std::vector<Sample> out;
  for (std::size_t k = 0; k < wanted.size(); ++k)
    out.push_back({wanted[k], answers[k] ? ended[k] : desk_->session->now(), std::move(answers[k])});
  return out;
}

std::vector<Sample> Sampler::take() {
  std::vector<std::optional<Sample>> brought(channels_.size());
  for (auto& sample : gather()) brought[sample.channel] = std::move(sample);
  std::vector<Sample> out(channels_.size());
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < channels_.size(); ++i)
    if (brought[i])
      out[i] = std::move(*brought[i]);
    else
      missing.push_back(i);
  for (auto& sample : read(missing)) out[sample.channel] = std::move(sample);
  return out;
}

show::DecodedValue decoded(const show::Desk& desk, const Channel& channel, ByteSpan bytes) {
  show::Reading reading{channel.node, channel.target, {}, Bytes{}, channel.bridge};
  if (channel.units) reading.units = &*channel.units;
  reading.family = desk.profile != nullptr ? desk.profile : desk.standard;
  return show::decode_value(reading, bytes);
}

Result<void> check_number(const Channel& channel) {
  const auto meaning = drive::meaning(channel.target, channel.node);
  if (!meaning.type_known || od::is_integer(meaning.type) || od::is_real(meaning.type)) return {};
  return fail(no_number(channel, message("it is of type {}", od::name(meaning.type))));
}

Result<void> check_number(const Channel& channel, ByteSpan bytes) {
  if (quantity(channel, bytes)) return {};
  return fail(no_number(channel, "it holds something else"));
}

const Error* end_of_looks(std::span<const Sample> samples) {
  for (const auto& sample : samples) {
    if (sample.bytes) continue;
    const auto code = sample.bytes.error().code;
    if (code == Errc::bus || code == Errc::interrupted) return &sample.bytes.error();
  }
  return nullptr;
}

std::vector<Error> failures_of(std::span<const Sample> last) {
  std::vector<Error> out;
  for (const auto& sample : last) {
    if (sample.bytes) continue;
    const auto& error = sample.bytes.error();
    const bool told =
        std::any_of(out.begin(), out.end(), [&](const Error& e) { return e.node == error.node; });
    if (!told) out.push_back(error);
  }
  return out;
}

}  // namespace servoctl::traffic
