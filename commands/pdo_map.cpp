#include <algorithm>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "pdo/pdo_changing.hpp"
#include "show/pdo_check.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using canopen::Pdo;
using canopen::PdoEntry;

constexpr Parameter kPdoMapParameters[] = {
    {.name = "pdo", .help = "RPDO1, TPDO2: as the drive sees it", .kind = Kind::text, .required = true},
    {.name = "object",
     .help = "what it carries, in order: statusword 0x6064, 0x2105:1/16 with its bits, gap8",
     .kind = Kind::object,
     .required = true,
     .many = true},
    {.name = "--type", .help = "transmission type: 1 at every SYNC, 255 by event", .kind = Kind::number},
    {.name = "--inhibit", .help = "inhibit time: 10ms", .kind = Kind::duration},
    {.name = "--event", .help = "event timer, if the type uses it: 100ms", .kind = Kind::duration},
    {.name = "--cob-id", .help = "CAN-ID: 0x181, $NODEID+0x180; 29 bits: 0x1ABCDEF", .kind = Kind::text},
    {.name = "--sync-start", .help = "SYNC start value (counter)", .kind = Kind::number},
    kKeepOption,
    kUnlockOption,
};

/// 254 and 255 are driven by events, the types below by SYNC and remote frames.
constexpr std::uint8_t kFirstEventType = 254;
constexpr std::uint8_t kEventTimer = 5;  ///< Its sub-index (CiA 301, 7.5.2.37).

/// What the options say; what they do not say stays as it is.
struct Options {
  std::vector<PdoEntry> entries;
  std::optional<std::uint8_t> type;
  std::optional<std::uint16_t> inhibit;
  std::optional<std::uint16_t> event;
  std::optional<std::uint8_t> sync_start;
  std::string cob_id;
};

Result<std::optional<std::uint8_t>> byte_option(const Arguments& arguments, std::string_view name) {
  if (!arguments.has(name)) return std::optional<std::uint8_t>();
  const auto number = parse_integer(arguments.text(name));
  const auto value = number ? number->as_unsigned() : std::nullopt;
  if (!value || *value > 255)
    return fail(Errc::usage,
                message("{}: '{}' is not a number from 0 to 255", name, as_it_is(arguments.text(name))));
  return std::optional(static_cast<std::uint8_t>(*value));
}

/// A time in steps, exact, in 16 bits.
Result<std::optional<std::uint16_t>> steps_option(const Arguments& arguments, std::string_view name,
                                                  Duration step) {
  if (!arguments.has(name)) return std::optional<std::uint16_t>();
  const auto time = read_duration(arguments.text(name));
  if (!time) return fail(Errc::usage, message("{}: {}", name, time.error().message), time.error().hint);
  const auto most = std::chrono::duration<double, std::milli>(step * 0xFFFF);
  if (*time % step != Duration::zero() || *time / step > 0xFFFF)
    return fail(Errc::usage, message("{}: '{}' is not a valid time", name, as_it_is(arguments.text(name))),
                message("in steps of {}, at most {:g} ms", to_string(step), most.count()));
  return std::optional(static_cast<std::uint16_t>(*time / step));
}

Result<Options> parse_options(const drive::Profile& profile, const Arguments& arguments) {
  Options out;
  for (const auto& word : arguments.all("object")) {
    const auto entry = pdo::parse_mapped(profile, word);
    if (!entry) return fail(entry.error());
    out.entries.push_back(*entry);
  }
  const auto type = byte_option(arguments, "--type");
  const auto sync_start = byte_option(arguments, "--sync-start");
  const auto inhibit = steps_option(arguments, "--inhibit", std::chrono::microseconds(100));
  const auto event = steps_option(arguments, "--event", std::chrono::milliseconds(1));
  if (!type) return fail(type.error());
  if (!sync_start) return fail(sync_start.error());
  if (!inhibit) return fail(inhibit.error());
  if (!event) return fail(event.error());
  out.type = *type;
  out.sync_start = *sync_start;
  out.inhibit = *inhibit;
  out.event = *event;
  out.cob_id = arguments.text("--cob-id");
  if (!out.cob_id.empty())
    if (const auto can_id = pdo::parse_can_id(out.cob_id, 0); !can_id) return fail(can_id.error());
  return out;
}

/// Whether a TPDO of this type is sent when its event timer ends (CiA 301, 7.5.2.38), also by the family's
/// word.
bool counts_event(const drive::Profile& profile, std::uint8_t type) {
  const auto& rules = profile.rules.pdo;
  const bool refused =
      std::find(rules.refused_types.begin(), rules.refused_types.end(), type) != rules.refused_types.end();
  return type >= kFirstEventType && !refused && rules.sends_by_timer(type);
}

Error no_timer(const Pdo& pdo, std::optional<std::uint8_t> right) {
  return make_error(Errc::usage,
                    message("{}: transmission type {} does not use the event timer",
                            canopen::name(pdo.direction, pdo.number), pdo.type),
                    right ? message("use --type {}, or leave --event out", *right)
                          : "no type of this drive uses it; leave --event out");
}

/// An event timer that nothing looks at would be told as set: it is refused with the type that was asked for,
/// else the right type is set with it. A timer of 0 is none; an RPDO only watches with it.
Result<void> settle_event(Context& context, const Options& options, std::uint8_t node, Pdo& pdo) {
  const auto& profile = *context.profile;
  const bool asked = options.event && *options.event != 0;
  const bool has_timer = profile.dictionary.find({pdo.communication_index(), kEventTimer}) != nullptr;
  if (!asked || !has_timer || pdo.direction != canopen::PdoDirection::transmit ||
      counts_event(profile, pdo.type))
    return {};
  std::optional<std::uint8_t> right;
  for (const std::uint8_t type : {kFirstEventType, std::uint8_t{255}})
    if (counts_event(profile, type)) right = type;
  if (options.type || !right) return fail(no_timer(pdo, right));
  const auto name = canopen::name(pdo.direction, pdo.number);
  context.notices.push_back(
      message("node {}, {}: transmission type {} does not use the event timer: type {} is set",
              node_name(node), name, pdo.type, *right));
  pdo.type = *right;
  return {};
}

Result<void> check_pdo_map(Context& context, const Arguments& arguments) {
  const auto options = parse_options(*context.profile, arguments);
  if (!options) return fail(options.error());
  auto pdo = canopen::parse_pdo_name(arguments.text("pdo"));
  if (!pdo) return fail(pdo::find_pdo({}, arguments.text("pdo")).error());
  pdo->entries = options->entries;
  if (options->type) {
    pdo->type = *options->type;
    if (const auto counts = settle_event(context, *options, 0, *pdo); !counts) return counts;
  }
  if (!options->cob_id.empty())
    for (const auto node : context.nodes)
      if (const auto can_id = pdo::parse_pdo_can_id(options->cob_id, node); !can_id) {
        auto error = can_id.error();
        error.message = message("node {}, {}: {}", node_name(node),
                                canopen::name(pdo->direction, pdo->number), error.message);
        error.node = node;
        return fail(std::move(error));
      }
  return show::check_mapping(*context.profile, *pdo);
}

Result<report::Value> run_pdo_map(Context& context, const Arguments& arguments) {
  if (const auto fits = check_pdo_map(context, arguments); !fits) return fail(fits.error());
  const auto options = parse_options(*context.profile, arguments);
  if (!options) return fail(options.error());
  const bool absolute = !options->cob_id.empty() && options->cob_id.front() != '$';
  if (absolute && context.nodes.size() > 1)
    return fail(Errc::usage, "several nodes cannot share one CAN-ID", "--cob-id '$NODEID+0x180'");
  const pdo::PdoEdit edit = [&](const pdo::PresentPdos& present) -> Result<pdo::WantedPdos> {
    auto pdo = pdo::find_pdo(present, arguments.text("pdo"));
    if (!pdo) return fail(pdo.error());
    pdo->entries = options->entries;
    if (options->type) pdo->type = *options->type;
    if (options->inhibit) pdo->inhibit = options->inhibit;
    if (options->event) pdo->event = options->event;
    if (const auto counts = settle_event(context, *options, present.node, *pdo); !counts)
      return fail(counts.error());
    if (options->sync_start) pdo->sync_start = options->sync_start;
    const bool linked = present.values.count({pdo->communication_index(), 1}) > 0;
    if (!linked && !options->cob_id.empty()) return fail(Errc::usage, "this drive's PDOs have no COB-ID");
    if (!options->cob_id.empty()) {
      const auto can_id = pdo::parse_pdo_can_id(options->cob_id, present.node);
      if (!can_id) return fail(can_id.error());
      pdo->set_can_id(*can_id);
    }
    if (linked)
      if (const auto on = pdo::switch_on(*pdo, present.node); !on) return fail(on.error());
    return pdo::WantedPdos{{std::move(*pdo)}};
  };
  return pdo::change_pdos(context, edit,
                          {.keep = arguments.has("--keep"), .unlock = arguments.has("--unlock")});
}

constexpr Example kPdoMapExamples[] = {
    {"pdo map TPDO2 0x6064 0x606C --type 255 --event 10ms -n 1 -d dm --dry-run", "first: show the frames"},
    {"pdo map TPDO2 0x6064 0x606C --type 255 --event 10ms -n 1 -d dm", "position and speed every 10 ms"},
    {"pdo map RPDO1 controlword 0x60FF --type 1 --keep -n 1 -d gsd600",
     "taken over at every SYNC, kept over power-off"},
};

}  // namespace

extern const Command kPdoMap;
const Command kPdoMap{
    .path = "pdo map",
    .summary = "Set what a PDO carries, and when",
    .details =
        "Everything is checked before the first frame; then the PDO is switched off, mapped, switched on and "
        "read back, by the family's own procedure. If the drive refuses a step, the old PDO is written back. "
        "What is not given stays unchanged. Refused while the drive is energised. --dry-run shows the frames.",
    .parameters = kPdoMapParameters,
    .examples = kPdoMapExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::stores,
    .run = run_pdo_map,
    .check = check_pdo_map,
};

}  // namespace servoctl::commands
