#include "show/bitrate_scan.hpp"

#include "base/format.hpp"
#include "can/slcan_place.hpp"
#include "drive/bitrate.hpp"
#include "session/adapter_link.hpp"
#include "session/bitrate_search.hpp"
#include "session/bus_setup.hpp"
#include "session/can_network.hpp"
#include "session/open_bus.hpp"
#include "session/own_bitrate.hpp"

namespace servoctl::show {
namespace {

/// A heartbeat of a second is heard.
constexpr Duration kSilence = std::chrono::milliseconds(1500);
/// So long may an adapter take to be open again.
constexpr Duration kBackAgain = std::chrono::seconds(2);
constexpr std::string_view kSerialBus = "slcan:";

/// The adapter of a session listens for itself, and is given back.
Result<void> hold_silence(const Desk& desk, can::LinkControl& link) {
  auto& session = *desk.session;
  auto silent = session::hold_silence(
      link, kSilence, session.options().cancelled,
      [&](double share, TimePoint begin, TimePoint now) { desk.show_share(share, begin, now); });
  if (!session.url().starts_with(kSerialBus)) return silent;
  const auto back = session.network().recover(session.now() + kBackAgain);
  return silent && !back ? fail(back.error()) : silent;
}

Result<std::unique_ptr<can::LinkControl>> link_behind(session::Session& session) {
  const auto url = session::canonical_url(session.url());
  if (!url.starts_with(kSerialBus)) return can::open_link(url);
  auto place = can::parse_slcan_place(url.substr(kSerialBus.size()));
  if (!place) return fail(place.error());
  return std::make_unique<session::AdapterLink>(session, std::move(*place));
}

/// Who has to say it otherwise from now on.
void tell_bitrate(Desk& desk, const can::LinkState& before, std::uint32_t bitrate) {
  const auto at = drive::bitrate_text(bitrate);
  const auto url = session::canonical_url(desk.session->url());
  if (!url.starts_with(kSerialBus)) {
    desk.notices.push_back(message("nodes answered at {0}: {1} stays at it (it was at {2})", at,
                                   as_it_is(url), session::settings_text(before)));
    return;
  }
  auto place = can::parse_slcan_place(url.substr(kSerialBus.size()));
  if (!place) return;
  place->bitrate = bitrate;
  desk.notices.push_back(message("nodes answered at {}: from now on `-b {}`, because {} means {}", at,
                                 as_it_is(can::slcan_url(*place)), as_it_is(url),
                                 session::settings_text(before)));
}

std::string asking_question(const std::string& name, const can::LinkState& now) {
  const auto receivers = can::link_receivers(name);
  auto out = formatted(
      "Ask for nodes on {} at each bitrate? It is at {} now, and is taken down and up for each; a node that runs at "
      "another bitrate sees errors for that time",
      name, session::settings_text(now));
  // The session's own socket is one of them.
  if (receivers > 1) out += formatted("; {} other sockets receive from it", receivers - 1);
  return out + ".";
}

std::string text_of(const session::Asked& asked) {
  const auto at = drive::bitrate_text(asked.bitrate);
  if (asked.nodes > 0) return formatted("{}: {} node{}\n", at, asked.nodes, asked.nodes == 1 ? "" : "s");
  return formatted("{}: {}\n", at, asked.why.empty() ? "no answer" : asked.why);
}

}  // namespace

Result<std::vector<session::Identity>> scan_all_bitrates(Desk& desk, std::span<const std::uint8_t> nodes,
                                                         const session::BeforeDetails& before_details) {
  auto& session = *desk.session;
  if (const auto possible = session::check_own_bitrate(session.url(), "scan --all-bitrates"); !possible)
    return fail(possible.error());
  const auto link = link_behind(session);
  if (!link) return fail(link.error());
  const auto& name = (*link)->name();
  const auto now = (*link)->state();
  if (!now) return fail(now.error());
  if (!session.energised().empty())
    return fail(Errc::refused, message("{} stays at its bitrate: a drive is energised over it", name),
                "`disable -n all` first");
  if (session.can()->sync() != nullptr)
    return fail(Errc::refused, message("{} stays at its bitrate: SYNC is produced on it", name),
                "`sync stop` first");
  if (const auto silent = hold_silence(desk, **link); !silent) return fail(silent.error());
  if (const auto agreed = desk.confirm(asking_question(name, *now)); !agreed) return fail(agreed.error());
  auto done = session::scan_bitrates(
      session, **link, nodes, session::usual_bitrates(),
      [&](const session::Asked& asked) { desk.tell(text_of(asked)); }, before_details);
  if (!done) return fail(done.error());
  if (done->bitrate && done->bitrate != now->bitrate) tell_bitrate(desk, *now, *done->bitrate);
  if (!done->bitrate)
    desk.notices.push_back(
        message("no node answered at any bitrate; {} is at {} again", name, session::settings_text(*now)));
  return std::move(done->found);
}

}  // namespace servoctl::show
