#include "session/bitrate_scan.hpp"

#include <cerrno>

#include "base/format.hpp"
#include "can/slcan_opening.hpp"
#include "drive/bitrate.hpp"
#include "session/scan.hpp"

namespace servoctl::session {
namespace {

/// So long may an adapter take to come up.
constexpr Duration kComingUp = can::SlcanOpening::kLongest;

/// Empty where the bitrate cannot be had.
Result<bool> tune(Session& session, can::LinkControl& link, std::uint32_t bitrate) {
  if (const auto down = link.change({.up = false}); !down) return fail(down.error());
  const auto set = link.change({.up = true, .bitrate = bitrate});
  if (!set && set.error().code == Errc::usage) return false;
  if (!set) return fail(set.error());
  const auto back = session.network().recover(session.now() + kComingUp);
  if (!back && back.error().code == Errc::usage) return false;
  if (!back) return fail(back.error());
  return true;
}

Result<Asked> ask_at(Session& session, can::LinkControl& link, std::span<const std::uint8_t> nodes,
                     std::uint32_t bitrate, const BeforeDetails& before_details,
                     std::vector<Identity>& found) {
  Asked out{.bitrate = bitrate};
  const auto tuned = tune(session, link, bitrate);
  if (!tuned) return fail(tuned.error());
  if (!*tuned) {
    out.why = "not possible";
    return out;
  }
  auto answers = scan(session, nodes, nullptr, before_details);
  // A question at a wrong bitrate ends in a bus-off where others are there to disturb it.
  if (!answers && answers.error().code != Errc::bus) return fail(answers.error());
  if (!answers) {
    out.why = "bus-off, or another error of the bus";
    return out;
  }
  out.nodes = answers->size();
  found = std::move(*answers);
  return out;
}

}  // namespace

Result<void> hold_silence(can::LinkControl& link, Duration time, const std::function<bool()>& cancelled,
                          const Listening& listening) {
  const auto state = link.state();
  if (!state) return fail(state.error());
  const auto bus = link.listen();
  if (!bus) return fail(bus.error());
  const auto heard = hear(**bus, time, cancelled, listening);
  if (!heard) return fail(heard.error());
  if (heard->frames == 0 && heard->errors == 0) return {};
  const auto at = state->bitrate ? drive::bitrate_text(*state->bitrate) : "its bitrate";
  if (heard->frames > 0)
    return fail(Errc::refused,
                message("{} is in use: {} frame{} heard at {}", as_it_is(link.name()), heard->frames,
                        ending(heard->frames, " was", "s were"), at),
                "another bitrate would disturb whoever talks there; `scan` asks at this one");
  return fail(Errc::refused,
              message("{} is in use: {} errors were heard at {}", as_it_is(link.name()), heard->errors, at),
              message("somebody talks at another bitrate: `bus detect {}` finds it without sending anything",
                      as_it_is(link.name())));
}

Result<BitrateScan> scan_bitrates(Session& session, can::LinkControl& link,
                                  std::span<const std::uint8_t> nodes,
                                  std::span<const std::uint32_t> bitrates,
                                  const std::function<void(const Asked&)>& told,
                                  const BeforeDetails& before_details) {
  const auto before = link.state();
  if (!before) return fail(before.error());
  if (before->kind != "can")
    return fail(can::link_refusal(link.name(), {.bitrate = 500'000}, *before, EOPNOTSUPP, {}));
  can::LinkKeeper keeper(link, *before);
  BitrateScan out;
  for (const auto bitrate : bitrates) {
    const auto asked = ask_at(session, link, nodes, bitrate, before_details, out.found);
    if (!asked) {
      (void)keeper.put_back();
      (void)session.network().recover(session.now() + kComingUp);
      return fail(asked.error());
    }
    out.asked.push_back(*asked);
    if (told) told(*asked);
    if (asked->nodes == 0) continue;
    out.bitrate = bitrate;
    keeper.keep();
    return out;
  }
  if (const auto back = keeper.put_back(); !back) return fail(back.error());
  if (const auto back = session.network().recover(session.now() + kComingUp); !back)
    return fail(back.error());
  return out;
}

}  // namespace servoctl::session
