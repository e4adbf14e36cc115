#include "settings/own_size.hpp"

#include <set>

#include "base/format.hpp"
#include "session/fitting_size.hpp"

namespace servoctl::settings {
namespace {

/// Puts the change into the size that its object has in the drive. False where that helps nothing; the error
/// then says why the number does not fit.
bool take_own_size(show::Desk& desk, Change& change, Error& refusal) {
  const auto held = desk.session->upload(change.node, change.target.address);
  if (!held || held->size() == change.data.size() || !od::is_integer(change.type)) return false;
  const auto fitting = session::in_size(change.data, change.type, held->size());
  auto meaning = drive::meaning(change.target, change.node);
  meaning.type = change.type;
  meaning.type_known = true;
  const auto fitted = drive::as_answered(meaning, held->size());
  if (!fitting || fitted.type == change.type) {
    refusal.hint = message("the object has {} bytes in this drive, not {}: the number does not fit",
                           held->size(), change.data.size());
    return false;
  }
  desk.notices.push_back(message("node {}, object {}: it has {} bytes in this drive, not {}: written as {}",
                                 node_name(change.node), as_it_is(to_string(change.target.address)),
                                 held->size(), change.data.size(), od::name(fitted.type)));
  change.data = *fitting;
  change.type = fitted.type;
  return true;
}

bool was_tried(const Result<session::Written>& written, const Change& change) {
  return written || written.error().object == change.target.address;
}

}  // namespace

void write_in_own_size(show::Desk& desk, std::vector<Change>& changes,
                       std::vector<session::SdoRequest>& requests,
                       std::vector<Result<session::Written>>& written, bool read_back) {
  std::set<std::size_t> sized;
  for (;;) {
    std::vector<std::size_t> again;
    std::set<std::uint8_t> nodes;  // What was skipped on others stays so: theirs refused for another reason.
    for (std::size_t i = 0; i < changes.size(); ++i) {
      auto& change = changes[i];
      if (!was_tried(written[i], change)) {
        again.push_back(i);
        continue;
      }
      if (written[i] || change.type_given || !session::is_refused_length(written[i].error())) continue;
      if (!sized.insert(i).second || !take_own_size(desk, change, written[i].error())) continue;
      requests[i].data = change.data;
      again.push_back(i);
      nodes.insert(change.node);
    }
    if (nodes.empty()) return;
    std::erase_if(again, [&](std::size_t i) { return !nodes.contains(changes[i].node); });
    std::vector<session::SdoRequest> open;
    for (const auto i : again) open.push_back(requests[i]);
    auto done = session::write_all(*desk.session, open, read_back);
    for (std::size_t i = 0; i < again.size(); ++i) written[again[i]] = std::move(done[i]);
  }
}

}  // namespace servoctl::settings
