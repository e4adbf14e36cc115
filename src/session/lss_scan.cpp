// How a session finds LSS slaves.
#include <algorithm>
#include <utility>

#include "session/lss.hpp"
#include "session/lss_pump.hpp"

namespace servoctl::session {
namespace {

using canopen::LssAddress;
using canopen::LssFastscan;

constexpr int kScanRounds = 3;
constexpr std::size_t kMostSlaves = 127;

/// The half of a range that begins with it, and the other: first by the revision, then by the serial number.
std::pair<LssAddress, LssAddress> inner_ends(const LssAddress& low, const LssAddress& high) {
  const auto part = low.revision != high.revision ? &LssAddress::revision : &LssAddress::serial;
  auto end = high;
  end.*part = low.*part + (high.*part - low.*part) / 2;
  auto begin = low;
  begin.*part = end.*part + 1;
  return {end, begin};
}

/// LssFastscan, with its progress told.
class ToldFastscan {
 public:
  ToldFastscan(Session& session, LssFastscan::Options options) : session_(&session), machine_(options) {}
  void start(TimePoint now) { machine_.start(now); }
  void on_frame(const can::Frame& frame, TimePoint now) { machine_.on_frame(frame, now); }
  void on_time(TimePoint now) {
    const auto before = machine_.steps();
    machine_.on_time(now);
    const auto& tell = session_->options().list_progress;
    if (tell && machine_.steps() != before && machine_.steps() > 1)
      tell(std::min(machine_.steps(), LssFastscan::kSteps), LssFastscan::kSteps, now);
  }
  auto take_frame() { return machine_.take_frame(); }
  auto take_result() { return machine_.take_result(); }
  TimePoint deadline() const { return machine_.deadline(); }

 private:
  Session* session_;
  LssFastscan machine_;
};

}  // namespace

Result<std::vector<LssFastscan::Found>> LssDialogue::scan_once(Duration patience) {
  std::vector<LssFastscan::Found> out;
  if (const auto sent = send_to_waiting(); !sent) return fail(sent.error());
  while (out.size() < kMostSlaves) {
    ToldFastscan machine(*session_, {.patience = patience});
    machine.start(session_->now());
    const auto result = pump_lss(*session_, machine, foreign_);
    if (!result) return fail(result.error());
    if (!*result) return fail(result->error());
    if (!**result) return out;
    const auto& found = ***result;
    const auto same = [&](const auto& before) { return before.address == found.address; };
    if (std::any_of(out.begin(), out.end(), same))
      return fail(Errc::protocol,
                  "an LSS slave answers fastscan although it was found: " + to_string(found.address),
                  "give it a node-ID by its identity: `lss set-node`, then scan again");
    out.push_back(found);
  }
  return out;
}

Result<std::vector<LssFastscan::Found>> LssDialogue::scan() {
  for (int round = 1;; ++round) {
    auto found = scan_once(patience_ * (1 << (round - 1)));
    if (found || found.error().code != Errc::protocol || round == kScanRounds) return found;
  }
}

/// Whether somebody is there. A range in which somebody answers and in whose halves nobody does means that an
/// answer was lost.
Result<bool> LssDialogue::search_between(const LssAddress& low, const LssAddress& high,
                                         std::vector<LssAddress>& found) {
  const auto answers = ask(canopen::lss_identify(low, high));
  if (!answers) return fail(answers.error());
  if (answers->empty()) return false;
  if (low == high) {
    found.push_back(low);
    if (found.size() > kMostSlaves) return fail(Errc::protocol, "a slave answers to every identity");
    return true;
  }
  const auto [end, begin] = inner_ends(low, high);
  const auto first = search_between(low, end, found);
  if (!first) return first;
  const auto second = search_between(begin, high, found);
  if (!second || *first || *second) return second ? Result<bool>(true) : second;
  return fail(Errc::protocol, "an LSS slave answered to a range of identities, and to neither half of it",
              "late or lost answers: `lss scan` again, with a longer --patience");
}

Result<std::vector<LssAddress>> LssDialogue::search(const LssAddress& low, const LssAddress& high) {
  if (const auto sent = send_to_waiting(); !sent) return fail(sent.error());
  std::vector<LssAddress> out;
  const auto any = search_between(low, high, out);
  if (!any) return fail(any.error());
  return out;
}

}  // namespace servoctl::session
