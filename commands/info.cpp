#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "command/command.hpp"
#include "command/restarted_option.hpp"
#include "drive/cia402.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/ethercat_network.hpp"
#include "session/identify.hpp"
#include "show/identity.hpp"
#include "show/records.hpp"
#include "show/registers.hpp"
#include "show/ring_table.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Record;
using report::Value;

Value optional_hex(std::optional<std::uint32_t> number) {
  return number ? Value(report::Hex{*number, 8}) : Value();
}

Value optional_number(const Result<Bytes>& bytes) {
  return bytes && bytes->size() <= 8 ? Value(load_le(*bytes)) : Value();
}

Value optional_byte(const Result<Bytes>& bytes) {
  return bytes && bytes->size() <= 8 ? Value(report::Hex{load_le(*bytes), 2}) : Value();
}

/// Bits of 6502h in the abbreviations of CiA 402-2.
Value modes_text(const Result<Bytes>& bytes) {
  if (!bytes || bytes->size() != 4) return {};
  report::List out;
  for (std::int8_t mode = 1; mode <= 10; ++mode)
    if (const auto name = drive::mode_abbreviation(mode);
        (load_le(*bytes) >> (mode - 1) & 1U) != 0 && !name.empty())
      out.emplace_back(name);
  return out;
}

/// What the data of the family call a drive with this 1000h; null where they do not say it.
Value family_kind(const drive::Profile* profile, std::optional<std::uint32_t> type, bool chinese) {
  if (profile == nullptr || !type) return {};
  const auto meaning = drive::meaning(drive::target_at(profile, objects::kDeviceType), 0);
  const auto* label = drive::label_of(meaning, od::Value(std::uint64_t{*type}));
  if (label == nullptr) return {};
  return chinese && !label->label_zh.empty() ? label->label_zh : label->label;
}

void add_state(Record& out, const session::Identity& node, session::Session& session) {
  if (const auto* ring = session.ethercat()) {
    const auto* al = ring->al_of(node.node);
    if (al != nullptr) out.push_back({"al", show::al_text(*al), report::Show::text, "AL state"});
    for (auto& field : al != nullptr ? show::al_fields(*al) : show::no_al_fields())
      out.push_back(std::move(field));
    return;
  }
  out.push_back({"nmt", node.state ? Value(session::name(*node.state)) : Value()});
}

Record identity_record(const session::Identity& node, std::span<const drive::Family> families,
                       std::span<const Result<Bytes>> more, const drive::Profile* profile,
                       const Context& context) {
  const auto guesses = session::guess_families(node, families);
  Record out{
      {"node", node.node},
      {"device_type", optional_hex(node.device_type), report::Show::everywhere, "device type"},
      {"device_kind", node.device_type ? Value(drive::device_kind(*node.device_type)) : Value(),
       report::Show::everywhere, "announced kind"},
      {"family_kind", family_kind(profile, node.device_type, context.chinese), report::Show::text,
       "which is"},
      {"family_kind", family_kind(profile, node.device_type, false), report::Show::json},
      {"device_name", report::text_or_null(node.device_name), report::Show::everywhere, "device name"},
      {"hardware_version", report::text_or_null(node.hardware_version), report::Show::everywhere, "hardware"},
      {"software_version", report::text_or_null(node.software_version), report::Show::everywhere, "software"},
      {"vendor_id", optional_hex(node.vendor_id), report::Show::everywhere, "vendor"},
      {"product_code", optional_hex(node.product_code), report::Show::everywhere, "product"},
      {"revision", optional_hex(node.revision)},
      {"serial", optional_hex(node.serial)},
      {"error_register", optional_byte(more[0]), report::Show::everywhere, "error register"},
      {"heartbeat_ms", optional_number(more[1]), report::Show::everywhere, "heartbeat (ms)"},
      {"modes", modes_text(more[2])}};
  add_state(out, node, *context.session);
  if (profile != nullptr) {
    const auto& rules = profile->rules;
    const auto& name = context.chinese && !rules.name_zh.empty() ? rules.name_zh : rules.name;
    const auto maker = rules.vendor.empty() ? std::string() : rules.vendor + " ";
    out.push_back(
        {"family", formatted("{} ({}{}), as you said", profile->family, maker, name), report::Show::text});
    out.push_back({"family", profile->family, report::Show::json});
  } else {
    const auto text = show::guess_text(guesses);
    out.push_back(
        {"family",
         text.empty() ? Value("none matches") : Value(text + "  (a guess, not proof: use -d FAMILY)"),
         report::Show::text});
    out.push_back({"family", Value(), report::Show::json});
  }
  report::List all;
  for (const auto& guess : guesses)
    all.emplace_back(Record{{"family", guess.family}, {"certain", guess.certain}});
  out.push_back({"families", all, report::Show::json});
  return out;
}

/// On EtherCAT there are many reasons why, and each has its own words.
Error no_answer(session::Session& session, std::uint8_t node, std::span<const Error> away) {
  const auto why =
      std::find_if(away.begin(), away.end(), [&](const Error& error) { return error.node == node; });
  if (session.ethercat() != nullptr && why != away.end()) return *why;
  return drive_error(Errc::timeout, node, "no answer", "`scan` shows which nodes answer");
}

Result<report::Value> info_of_registers(Context& context, bool restarted) {
  report::List out;
  for (const auto node : context.nodes) {
    auto told = show::register_info(context, node);
    if (!told) {
      context.errors.push_back(told.error());
      continue;
    }
    if (auto* record = std::get_if<Record>(&told->data())) add_owed(context, node, restarted, *record);
    out.push_back(std::move(*told));
  }
  return report::Value(std::move(out));
}

constexpr Parameter kInfoParameters[] = {kRestartedOption};

Result<report::Value> run_info(Context& context, const Arguments& arguments) {
  const auto restarted = says_restarted(context, arguments);
  if (!restarted) return fail(restarted.error());
  if (context.session->modbus() != nullptr) return info_of_registers(context, *restarted);
  std::vector<Error> away;
  const auto families = drive::find_families(context.drive_folders);
  auto found =
      session::scan(*context.session, context.nodes, &away, show::warn_of_details(context, families));
  if (!found) return fail(found.error());
  session::look_for_families(*context.session, *found, families);
  std::vector<session::SdoRequest> requests;
  for (const auto& node : *found)
    for (const auto& [object, size] :
         {std::pair{objects::kErrorRegister, 1U}, std::pair{objects::kProducerHeartbeat, 2U},
          std::pair{objects::kSupportedModes, 4U}})
      requests.push_back({.node = node.node, .object = object, .size = size});
  const auto answers = context.session->transfer(requests);
  report::List out;
  std::size_t at = 0;
  for (const auto node : context.nodes) {
    if (at < found->size() && (*found)[at].node == node) {
      // What the drive says of itself is the answer all the same.
      const auto right = context.profile == nullptr
                             ? Result<void>{}
                             : context.hold_family(std::span(&node, 1), context.profile, false);
      if (!right) context.errors.push_back(right.error());
      auto record = identity_record((*found)[at], families, std::span(answers).subspan(3 * at, 3),
                                    right ? context.profile : nullptr, context);
      add_owed(context, node, *restarted, record);
      out.push_back(std::move(record));
      ++at;
      continue;
    }
    context.errors.push_back(no_answer(*context.session, node, away));
  }
  return report::Value(std::move(out));
}

constexpr Example kInfoExamples[] = {
    {"info -n 1", "device, versions, serial number, and the families that fit"},
    {"info -n 1 -d gsd600", "also whether it is a drive of this family; exit code 8 if not"},
    {"info -n 5 -d ts -b modbus:/dev/ttyUSB0@19200,8E1",
     "main parameters, inputs and outputs of a drive on Modbus"},
};

}  // namespace

extern const Command kInfo;
const Command kInfo{
    .path = "info",
    .summary = "Show the identity of a node",
    .details =
        "Reads device type, name, versions, identity, error register, heartbeat time and supported modes. If "
        "they contradict the family given with -d, it lists the families that fit and ends with exit code 8. On Modbus no "
        "register says what a device is: with -d FAMILY it shows its main parameters, inputs and outputs. Values that wait for "
        "a restart are shown as by `status`, which does not work on Modbus; --restarted says that there was one.",
    .parameters = kInfoParameters,
    .examples = kInfoExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .family = FamilyCheck::never,
    .run = run_info,
    .on_registers = true,
};

}  // namespace servoctl::commands
