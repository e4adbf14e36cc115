// What a session tells while a line runs: how far it has come; and with --verbose the cabinet file and the
// family that are taken and why, and what becomes of each transfer and each command for the state of a node.
#include <unistd.h>

#include <algorithm>
#include <string_view>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "cli/shell.hpp"
#include "cli/terminal/signals.hpp"
#include "session/open_bus.hpp"
#include "show/reading.hpp"

namespace servoctl::cli {
namespace {

/// Bytes of an object that are told.
constexpr std::size_t kMostBytes = 16;

std::string bytes_text(const Bytes& bytes) {
  if (bytes.empty()) return "none";
  const ByteSpan told(bytes.data(), std::min(bytes.size(), kMostBytes));
  return to_hex(told) + (bytes.size() > kMostBytes ? " …" : "");
}

std::string value_text(const show::Reading& reading, const Bytes& bytes, bool chinese) {
  const auto decoded = show::decode_value(reading, bytes);
  const auto label = show::label_text(decoded, chinese);
  return label.empty() ? decoded.text : formatted("{} {}", decoded.text, label);
}

std::string exchange_text(const session::Exchange& one, const drive::Profile* profile, bool chinese) {
  const auto target = drive::target_at(profile, one.object);
  const show::Reading reading{.node = one.node, .target = target, .type = {}};
  const auto name = chinese ? target.label_zh() : target.label();
  const auto object =
      name.empty() ? to_string(one.object)
                   : formatted(fmt::runtime(chinese ? "{}（{}）" : "{} ({})"), to_string(one.object), name);
  const double time = std::chrono::duration<double, std::milli>(one.ended - one.begun).count();
  if (one.written != nullptr) {
    const auto value = value_text(reading, *one.written, chinese);
    const auto bytes = bytes_text(*one.written);
    return one.result
               ? formatted("node {}, object {}: written in {:.1f} ms: {} (bytes: {})", one.node, object, time,
                           value, bytes)
               : formatted("node {}, object {}: write of {} (bytes: {}) failed after {:.1f} ms: {}", one.node,
                           object, value, bytes, time, what_happened(one.result.error()).text());
  }
  if (!one.result)
    return formatted("node {}, object {}: read failed after {:.1f} ms, tries: {}: {}", one.node, object, time,
                     one.tries, what_happened(one.result.error()).text());
  const auto value = value_text(reading, *one.result, chinese);
  const auto bytes = bytes_text(*one.result);
  return one.tries == 1 ? formatted("node {}, object {}: read in {:.1f} ms: {} (bytes: {})", one.node, object,
                                    time, value, bytes)
                        : formatted("node {}, object {}: read in {:.1f} ms, tries: {}: {} (bytes: {})",
                                    one.node, object, time, one.tries, value, bytes);
}

}  // namespace

session::Options Shell::session_options() {
  session::Options out;
  out.cancelled = options_.cancelled;
  out.signals = times_signalled;
  out.drive_folders = [this]() -> std::span<const std::filesystem::path> { return options_.drive_folders; };
  out.protection = &protection_;
  // Two that start at once have process numbers close together, or other times.
  constexpr std::uint64_t kSpread = 0x9E37'79B9'7F4A'7C15;
  const auto time = static_cast<std::uint64_t>(steady_now().time_since_epoch().count());
  out.claim_seed = (static_cast<std::uint64_t>(::getpid()) * kSpread ^ time * kSpread) >> 16U;
  out.tell = [this](std::string_view line) {
    const auto turn = take_turn();
    progress_.end();
    console_->note("notice: " + std::string(line) + "\n");
  };
  out.progress = [this](std::size_t done, std::optional<std::size_t> total, TimePoint now) {
    const auto turn = take_turn();
    progress_.update(done, total, now);
  };
  out.list_progress = [this](std::size_t done, std::size_t total, TimePoint now) {
    const auto turn = take_turn();
    progress_.update_list(done, total, now);
  };
  out.exchanged = [this](const session::Exchange& exchange) {
    if (console_->is_verbose()) tell_exchange(exchange);
  };
  out.ordered = [this](const session::Session& session, std::uint8_t node, std::string_view order) {
    if (console_->is_verbose()) tell_order(session, node, order);
  };
  out.waiting = [this](const session::Stretch* stretch, TimePoint now) { show_wait(stretch, now); };
  return out;
}

void Shell::tell_exchange(const session::Exchange& exchange) {
  const auto turn = take_turn();
  progress_.end();
  const auto known = noted_families_.find({session::canonical_url(exchange.session.url()), exchange.node});
  const auto* profile = known == noted_families_.end() ? nullptr : known->second;
  const auto text = console_->in_language(exchange_text(exchange, profile, console_->chinese()));
  console_->detail(printable(bus_.names(exchange.session).in(text)));
}

void Shell::tell_order(const session::Session& session, std::uint8_t node, std::string_view order) {
  const auto turn = take_turn();
  progress_.end();
  const auto text = console_->in_language(node == 0 ? formatted("sent to all nodes: {}", order)
                                                    : formatted("sent to node {}: {}", node, order));
  console_->detail(printable(bus_.names(session).in(text)));
}

void Shell::note_family(const session::Session& session, std::span<const std::uint8_t> nodes,
                        const drive::Profile* profile) {
  if (profile == nullptr) return;
  if (auto* watch = bus_.restarts(session))
    for (const auto node : nodes)
      if (node != 0) watch->learn(node, *profile);
  if (!console_->is_verbose()) return;
  const auto turn = take_turn();
  for (const auto node : nodes) noted_families_[{session::canonical_url(session.url()), node}] = profile;
}

/// Where the line goes, and who said so.
void Shell::tell_place(const Run& run) {
  const auto& settings = run.settings;
  const auto bus_by = settings.of_cabinet ? "the cabinet file" : name_of(settings.bus_from, "--bus");
  console_->detail(settings.nodes.empty()
                       ? formatted("bus {}: named by {}", printable(settings.bus), bus_by)
                       : formatted("bus {}: named by {}; nodes {}: named by {}", printable(settings.bus),
                                   bus_by, printable(settings.nodes),
                                   name_of(settings.nodes_from, "--node")));
}

void Shell::tell_family(const Run& run) {
  const auto& settings = run.settings;
  const auto why = run.family_guessed    ? std::string("the identity of the drive fits it, a guess")
                   : run.family_proven   ? "the identity of the drive proves it"
                   : run.family_found    ? "as it was said of this drive before"
                   : settings.of_cabinet ? "that of the axis in the cabinet file"
                                         : formatted("named by {}", name_of(settings.drive_from, "--drive"));
  const auto& profile = *run.context.profile;
  if (profile.data_sheet.empty())
    return console_->detail(
        formatted("family {}: objects as the drive describes them", printable(profile.family)));
  console_->detail(formatted("family {}: {}; objects from {}", printable(profile.family), why,
                             printable(profile.data_sheet.string())));
}

Result<const cabinet::Cabinet*> Shell::cabinet(const Settings& settings) {
  auto found = cabinet_.get(settings);
  if (found && *found != nullptr && console_->is_verbose() && !std::exchange(cabinet_told_, true))
    console_->detail(formatted("cabinet file {}, named by {}, axes: {}", printable((*found)->file.string()),
                               name_of(settings.cabinet_from, "--cabinet"), (*found)->axes.size()));
  return found;
}

}  // namespace servoctl::cli
