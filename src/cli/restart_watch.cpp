#include "cli/restart_watch.hpp"

#include <algorithm>
#include <utility>

#include "canopen/node_list.hpp"
#include "session/can_network.hpp"
#include "session/identify.hpp"
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
  for (const auto node : canopen::every_node_id())
    if (auto kept = show::OwedRestartFile(folder_, session.url(), node).read(); kept && *kept) {
      in_file_[node] = objects_of((*kept)->values);
      owed_.take_up(node, std::move((*kept)->values), std::move((*kept)->identity), (*kept)->by_power);
    }
  session.options().exchanged = [this, next = std::move(session.options().exchanged)](const auto& exchange) {
    owed_.on_exchange(exchange, starts(exchange.node));
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
  return out;
}

Result<void> RestartWatch::keep_node(std::uint8_t node) {
  const bool waited = !owed_.values(node, starts(node)).empty();
  const bool changed = owed_.take_changed(node);
  if (!waited && !changed) return {};
  const show::OwedRestartFile file(folder_, session_->url(), node);
  // Somebody has said that it was restarted.
  if (!changed && !file.is_there()) owed_.forget(node);
  if (!changed) return {};
  if (waited) take_from_others(node, file);
  const auto identity = waited ? identity_now(node) : session::Identity();
  const auto& values = owed_.values(node, starts(node));
  in_file_[node] = objects_of(values);
  if (!values.empty()) return file.write({identity, values, owed_.ends_by_power(node)});
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
  session::Identity out;
  out.node = node;
  return out;
}

}  // namespace servoctl::cli
