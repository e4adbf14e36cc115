#include "cli/restart_watch.hpp"

#include <algorithm>
#include <utility>

#include "canopen/node_list.hpp"
#include "drive/standard_objects.hpp"
#include "session/answer.hpp"
#include "session/can_network.hpp"
#include "session/identify.hpp"
#include "session/open_bus.hpp"
#include "session/option_scope.hpp"
#include "show/identity.hpp"

namespace servoctl::cli {
namespace {

std::vector<ObjectAddress> objects_of(const std::vector<session::OwedValue>& values) {
  std::vector<ObjectAddress> out;
  for (const auto& value : values) out.push_back(value.object);
  return out;
}

}  // namespace

RestartWatch::RestartWatch(session::Session& session, std::filesystem::path state_folder)
    : session_(&session), folder_(std::move(state_folder)) {
  if (session.url().starts_with("replay:")) folder_.clear();
  if (folder_.empty()) return;
  for (const auto node : show::owing_nodes(folder_, session.url()))
    if (auto kept = show::OwedRestartFile(folder_, session.url(), node).read(); kept && *kept) {
      in_file_[node] = objects_of((*kept)->values);
      if ((*kept)->bus_bitrate) bitrates_[node] = *(*kept)->bus_bitrate;
      owed_.take_up(node, std::move((*kept)->values), std::move((*kept)->identity), (*kept)->by_power,
                    (*kept)->node_id);
    }
  session.options().exchanged = [this, next = std::move(session.options().exchanged)](const auto& exchange) {
    note_answer(exchange);
    owed_.on_exchange(exchange, starts(exchange.node));
    if (owed_.awaits_bitrate(exchange.node) && !bitrates_.contains(exchange.node))
      if (const auto bitrate = session::bitrate_of(session_->url())) bitrates_[exchange.node] = *bitrate;
    if (next) next(exchange);
  };
}

session::Starts RestartWatch::starts(std::uint8_t node) {
  if (auto* can = session_->can()) return {can->watch().restarts(node), can->watch().power_ups(node)};
  const auto boots = session_->watch().boots(node);
  return {boots, boots};
}

Result<void> RestartWatch::keep() {
  if (folder_.empty()) return {};
  Result<void> out;
  for (const auto node : canopen::every_node_id())
    if (const auto kept = keep_node(node); !kept) out = kept;
  silent_.fill(false);
  answered_.fill(false);
  for (const auto node : canopen::every_node_id()) {
    const auto restarts = starts(node).restarts;
    if (restarts != restarts_[node]) heard_[node] = {};  // Another drive may have come.
    restarts_[node] = restarts;
  }
  return out;
}

void RestartWatch::note_answer(const session::Exchange& exchange) {
  const bool silent = !exchange.result && exchange.result.error().code == Errc::timeout;
  silent_[exchange.node & 0x7FU] = silent;
  answered_[exchange.node & 0x7FU] = !silent;
  if (exchange.written == nullptr && exchange.result) note_number(exchange);
}

void RestartWatch::note_number(const session::Exchange& exchange) {
  auto& identity = heard_[exchange.node & 0x7FU];
  identity.node = exchange.node;
  const auto number = session::u32_in(exchange.result);
  if (exchange.object == objects::kDeviceType) identity.device_type = number;
  if (exchange.object == objects::kVendorId) identity.vendor_id = number;
  if (exchange.object == objects::kProductCode) identity.product_code = number;
  if (exchange.object == objects::kRevision) identity.revision = number;
  if (exchange.object == objects::kSerialNumber) identity.serial = number;
  if (exchange.object == objects::kDeviceName) identity.device_name = session::text_in(exchange.result);
}

/// Whether something has happened that a drive does which goes by its new node-ID or bitrate.
bool RestartWatch::may_be_over(std::uint8_t node) {
  const auto bitrate = bitrates_.find(node);
  if (bitrate != bitrates_.end() && answered_[node] && owed_.awaits_bitrate(node) &&
      session::bitrate_of(session_->url()).value_or(bitrate->second) != bitrate->second)
    return true;
  const auto next = show::next_node_id(owed_.values(node, starts(node)), owed_.node_id_of(node));
  if (!next || *next == node) return false;
  return silent_[node] || answered_[*next] || starts(*next).restarts != restarts_[*next];
}

show::OwedRestart RestartWatch::record(std::uint8_t node, session::Identity identity) {
  show::OwedRestart out;
  out.identity = std::move(identity);
  out.values = owed_.values(node, starts(node));
  out.by_power = owed_.ends_by_power(node);
  out.node_id = owed_.node_id_of(node);
  if (const auto at = bitrates_.find(node); at != bitrates_.end() && owed_.awaits_bitrate(node))
    out.bus_bitrate = at->second;
  return out;
}

Result<void> RestartWatch::keep_node(std::uint8_t node) {
  const bool waited = !owed_.values(node, starts(node)).empty();
  const bool changed = owed_.take_changed(node);
  if (!waited && !changed) return {};
  const show::OwedRestartFile file(folder_, session_->url(), node);
  if (waited && may_be_over(node)) {
    const session::Deaf deaf(*session_);
    const auto next = show::next_node_id(owed_.values(node, starts(node)), owed_.node_id_of(node));
    const bool started = next && starts(*next).restarts != restarts_[*next];
    const auto kept = record(node, owed_.kept_of(node).value_or(heard_[node]));
    if (show::owing(*session_, node, kept, started) == show::Owing::over) {
      owed_.forget(node);
      bitrates_.erase(node);
      in_file_.erase(node);
      file.remove();
      return {};
    }
  }
  // Somebody has said that it was restarted.
  if (!changed && !file.is_there()) owed_.forget(node);
  if (!changed) return {};
  if (waited) take_from_others(node, file);
  const auto owed = record(node, waited ? identity_now(node) : session::Identity());
  in_file_[node] = objects_of(owed.values);
  if (!owed.values.empty()) return file.write(owed);
  file.remove();
  return {};
}

/// Another program may have written to the drive meanwhile.
void RestartWatch::take_from_others(std::uint8_t node, const show::OwedRestartFile& file) {
  auto kept = file.read();
  if (!kept || !*kept) return;
  std::erase_if((*kept)->values, [&](const session::OwedValue& value) {
    const auto& ours = in_file_[node];
    return std::ranges::find(ours, value.object) != ours.end();
  });
  owed_.add_from_others(node, std::move((*kept)->values));
}

/// Of one that does not answer any more nothing else is known.
session::Identity RestartWatch::identity_now(std::uint8_t node) {
  const session::Deaf deaf(*session_);
  const session::OptionScope once(*session_, &session::Options::retries, 0U);
  auto now = session::read_identity(*session_, node);
  const auto& kept = owed_.kept_of(node);
  if (now && kept) owed_.settle_identity(node, show::change_of(*kept, *now).empty());
  if (now) return std::move(*now);
  if (kept) return *kept;
  auto out = heard_[node];
  out.node = node;
  return out;
}

}  // namespace servoctl::cli
