#include "show/bitrate_scan.hpp"

#include <fmt/format.h>

#include "drive/bitrate.hpp"
#include "session/bitrate_search.hpp"
#include "session/bus_setup.hpp"
#include "session/open_bus.hpp"

namespace servoctl::show {
namespace {

/// A heartbeat of a second is heard.
constexpr Duration kSilence = std::chrono::milliseconds(1500);

std::string asking_question(const std::string& name, const can::LinkState& now) {
  const auto receivers = can::link_receivers(name);
  auto out = fmt::format(
      "Ask for nodes on {} at each bitrate? It is at {} now, and is taken down and up for each; a node that runs at "
      "another bitrate sees errors for that time",
      name, session::settings_text(now));
  // The session's own socket is one of them.
  if (receivers > 1) out += fmt::format("; {} other sockets receive from it", receivers - 1);
  return out + ".";
}

std::string text_of(const session::Asked& asked) {
  const auto at = drive::bitrate_text(asked.bitrate);
  if (asked.nodes > 0) return fmt::format("{}: {} node{}\n", at, asked.nodes, asked.nodes == 1 ? "" : "s");
  return fmt::format("{}: {}\n", at, asked.why.empty() ? "no answer" : asked.why);
}

}  // namespace

Result<void> check_all_bitrates(const Desk& desk) {
  const auto& url = desk.session->url();
  if (desk.session->can() != nullptr && session::canonical_url(url).find(':') == std::string::npos) return {};
  return fail(Errc::usage, fmt::format("--all-bitrates needs a CAN interface, and {} is none", url),
              url.starts_with("slcan:")
                  ? "name its bitrates one after the other: `scan -b slcan:PORT@250k`"
                  : "only an interface of the kernel has a bitrate that can be set: can0");
}

Result<std::vector<session::Identity>> scan_all_bitrates(Desk& desk, std::span<const std::uint8_t> nodes) {
  if (const auto possible = check_all_bitrates(desk); !possible) return fail(possible.error());
  auto& session = *desk.session;
  const auto name = session::canonical_url(session.url());
  const auto link = can::open_link(name);
  if (!link) return fail(link.error());
  const auto now = (*link)->state();
  if (!now) return fail(now.error());
  if (!session.energised().empty())
    return fail(Errc::refused, fmt::format("{} stays at its bitrate: a drive is energised over it", name),
                "`disable -n all` first");
  if (const auto silent = session::hold_silence(**link, kSilence, session.options().cancelled); !silent)
    return fail(silent.error());
  if (const auto agreed = desk.confirm(asking_question(name, *now)); !agreed) return fail(agreed.error());
  auto done = session::scan_bitrates(session, **link, nodes, session::usual_bitrates(),
                                     [&](const session::Asked& asked) { desk.tell(text_of(asked)); });
  if (!done) return fail(done.error());
  if (done->bitrate && done->bitrate != now->bitrate)
    desk.notices.push_back(fmt::format("nodes answered at {0}: {1} stays at it (it was at {2})",
                                       drive::bitrate_text(*done->bitrate), name,
                                       session::settings_text(*now)));
  if (!done->bitrate)
    desk.notices.push_back(fmt::format("no node answered at any bitrate; {} is at {} again", name,
                                       session::settings_text(*now)));
  return std::move(done->found);
}

}  // namespace servoctl::show
