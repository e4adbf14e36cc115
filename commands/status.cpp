#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "canopen/emergency.hpp"
#include "command/command.hpp"
#include "command/restarted_option.hpp"
#include "drive/cia402.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_mode.hpp"
#include "drive/standard_objects.hpp"
#include "motion/other_axes.hpp"
#include "session/answer.hpp"
#include "session/ethercat_network.hpp"
#include "session/node_life.hpp"
#include "session/state_pause.hpp"
#include "show/fault_records.hpp"
#include "show/records.hpp"
#include "show/ring_table.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::List;
using report::Record;
using report::Show;
using report::Value;

constexpr Parameter kStatusParameters[] = {
    {.name = "--long",
     .help = "every bit of the statusword, and more, in several lines a node",
     .kind = Kind::flag},
    kRestartedOption,
};

constexpr ObjectAddress kObjects[] = {objects::kStatusword, objects::kModeDisplay, objects::kErrorCode,
                                      objects::kErrorRegister, objects::kProducerHeartbeat};
constexpr std::size_t kSizes[] = {2, 1, 2, 1, 2};  ///< CiA 301 and 402-2.
constexpr std::size_t kCount = std::size(kObjects);

/// Waits until every node that sends heartbeats was heard.
Result<void> hear_heartbeats(Context& context, std::span<const Result<Bytes>> answers) {
  std::vector<session::HeartbeatPeriod> expected;
  for (std::size_t i = 0; i < context.nodes.size(); ++i)
    if (const auto period = session::number_in(answers[i * kCount + 4]))
      expected.push_back({context.nodes[i], std::chrono::milliseconds(*period & 0xFFFFU)});
  return session::hear_states(*context.session, expected);
}

/// Of those that answer; what they say is noted in the session's records.
Result<void> ask_states(Context& context, std::span<const Result<Bytes>> answers) {
  for (std::size_t i = 0; i < context.nodes.size(); ++i) {
    const auto& first = answers[i * kCount];
    if (!first && first.error().code != Errc::sdo_abort) continue;
    if (const auto asked = session::ask_state(*context.session, context.nodes[i]); !asked)
      return fail(asked.error());
  }
  return {};
}

std::string mode_text(const Context& context, std::int8_t mode) {
  if (context.profile == nullptr) return {};
  const auto meaning = drive::meaning(drive::target_at(context.profile, objects::kModeDisplay), 0);
  const auto* label = drive::label_of(meaning, od::Value(std::int64_t{mode}));
  if (label == nullptr) return {};
  return context.chinese && !label->label_zh.empty() ? label->label_zh : label->label;
}

void add_drive_state(Record& out, const Context& context, std::optional<std::uint64_t> word,
                     std::optional<std::uint64_t> mode) {
  if (!word) {
    for (const auto* key : {"state", "energised", "statusword", "bits"})
      out.push_back({key, Value(), Show::json});
    return;
  }
  const auto statusword = static_cast<std::uint16_t>(*word);
  const auto state = drive::decode_state(statusword);
  const auto shown_mode = static_cast<std::int8_t>(mode.value_or(0));
  const auto mode_number = context.profile == nullptr
                               ? shown_mode
                               : drive::standard_mode(context.profile->rules.motion, shown_mode);
  report::List bits;
  for (auto& bit : drive::statusword_bits(statusword, mode_number)) bits.emplace_back(std::move(bit));
  out.push_back(
      {"state", context.chinese ? drive::name_zh(state) : drive::name(state), Show::text, "drive state"});
  out.push_back({"state", drive::name(state), Show::json});
  out.push_back({"energised", drive::is_energised(state)});
  out.push_back({"statusword", report::Hex{statusword, 4}});
  out.push_back({"bits", std::move(bits), Show::everywhere, "statusword bits"});
}

/// In the short form.

show::ToldFault fault_of(const Context& context, std::span<const Result<Bytes>> answers) {
  const auto word = [&](std::size_t i) {
    const auto number = session::number_in(answers[i]);
    return number ? std::optional(static_cast<std::uint16_t>(*number)) : std::nullopt;
  };
  return show::told_fault(context.profile, context.chinese, word(2), word(0));
}

void add_mode_and_fault(Record& out, const Context& context, std::span<const Result<Bytes>> answers) {
  if (const auto mode = session::number_in(answers[1])) {
    const auto value = static_cast<std::int8_t>(*mode);
    const auto text = mode_text(context, value);
    out.push_back(
        {"mode", text.empty() ? formatted("{}", value) : formatted("{} {}", value, text), Show::text});
    out.push_back({"mode", Record{{"value", value}, {"label", report::text_or_null(text)}}, Show::json});
  } else {
    out.push_back({"mode", Value(), Show::json});
  }
  const auto fault = fault_of(context, answers);
  if (fault.known) out.push_back({"fault", fault.cell(std::string::npos), Show::text});
  out.push_back({"fault", fault.record(), Show::json});
  if (const auto bits = session::number_in(answers[3])) {
    const auto text = canopen::error_register_text(static_cast<std::uint8_t>(*bits));
    out.push_back({"error_register", formatted("0x{:02X} {}", *bits, text), Show::text, "error register"});
    out.push_back({"error_register", *bits, Show::json});
  } else {
    out.push_back({"error_register", Value(), Show::json});
  }
}

void add_nmt_state(Record& out, const Context& context, std::uint8_t node,
                   std::span<const Result<Bytes>> answers) {
  const auto nmt = context.session->watch().state(node);
  const auto heartbeat = session::number_in(answers[4]);
  const bool has_no_heartbeat = !answers[4] && answers[4].error().code == Errc::sdo_abort;
  out.push_back({"nmt",
                 nmt ? std::string(session::name(*nmt))
                     : std::string(has_no_heartbeat ? "not stopped (no heartbeat: it has no 0x1017)"
                                   : heartbeat.value_or(0) == 0 ? "not stopped (no heartbeat: 0x1017 is 0)"
                                                                : "not heard"),
                 Show::text, "NMT state"});
  out.push_back({"nmt", nmt ? Value(session::name(*nmt)) : Value(), Show::json});
}

/// What went wrong with the cycles that its outputs and inputs go by.
void add_cycles(Record& out, const ethercat::ProcessImage& image, std::uint8_t node) {
  const auto& counts = image.counts(node);
  out.push_back({"process_data",
                 formatted("{} cycles; frames lost: {}, outputs not taken: {}, inputs not given: {}",
                           counts.cycles, counts.lost, counts.short_outputs, counts.short_inputs),
                 Show::text, "process data"});
  out.push_back({"process_data",
                 Record{{"cycles", counts.cycles},
                        {"lost", counts.lost},
                        {"outputs_not_taken", counts.short_outputs},
                        {"inputs_not_given", counts.short_inputs}},
                 Show::json});
}

void add_al_state(Record& out, const session::EtherCatNetwork& ring, std::uint8_t node) {
  if (const auto* al = ring.al_of(node)) {
    out.push_back({"al", show::al_text(*al), Show::text, "AL state"});
    for (auto& field : show::al_fields(*al)) out.push_back(std::move(field));
  } else {
    for (auto& field : show::no_al_fields()) out.push_back(std::move(field));
  }
  if (const auto* image = ring.image_of(node))
    add_cycles(out, *image, node);
  else
    out.push_back({"process_data", Value(), Show::json});
}

List axis_records(std::span<const motion::OtherAxis> axes) {
  List out;
  for (const auto& axis : axes) {
    Value state;
    if (axis.statusword) state = drive::name(drive::decode_state(*axis.statusword));
    out.emplace_back(
        Record{{"axis", axis.number}, {"state", std::move(state)}, {"energised", axis.may_be_energised()}});
  }
  return out;
}

bool has_no_statusword(std::span<const Result<Bytes>> answers) {
  return !answers[0] && answers[0].error().code == Errc::sdo_abort;
}

void tell_axes(Context& context, std::uint8_t node, std::span<const motion::OtherAxis> others,
               bool has_first) {
  if (!others.empty())
    context.notices.push_back(message("node {}: {}", node_name(node),
                                      motion::axes_text({others.begin(), others.end()}, has_first)));
  else if (!has_first)
    context.notices.push_back(
        message("node {} has no statusword: it is not a CiA 402 drive", node_name(node)));
}

Record status_record(Context& context, std::uint8_t node, std::span<const Result<Bytes>> answers,
                     bool restarted, std::span<const motion::OtherAxis> others) {
  Record out{{"node", node}};
  if (const auto* ring = context.session->ethercat())
    add_al_state(out, *ring, node);
  else
    add_nmt_state(out, context, node, answers);
  add_drive_state(out, context, session::number_in(answers[0]), session::number_in(answers[1]));
  add_mode_and_fault(out, context, answers);
  add_owed(context, node, restarted, out);
  if (!others.empty()) out.push_back({"other_axes", axis_records(others), Show::json});
  return out;
}

Value mode_cell(const Context& context, const Result<Bytes>& answer) {
  const auto number = session::number_in(answer);
  if (!number) return {};
  const auto mode = static_cast<std::int8_t>(*number);
  const auto name = drive::mode_word(context.profile, mode, context.chinese);
  return name.empty() ? formatted("{}", mode) : formatted("{} {}", mode, name);
}

/// `pre-operational`, `SAFE-OP`; nothing where it was not heard.
Value network_cell(const Context& context, std::uint8_t node) {
  if (const auto* ring = context.session->ethercat()) {
    const auto* al = ring->al_of(node);
    return al == nullptr ? Value() : Value(show::al_text(*al));
  }
  const auto nmt = context.session->watch().state(node);
  return nmt ? Value(session::name(*nmt)) : Value();
}

/// One line a node; JSON has the records of the long form.
report::Table overview(const Context& context) {
  report::Table table;
  table.columns = {{"node"},
                   {"network", context.session->ethercat() != nullptr ? "AL" : "NMT"},
                   {"state"},
                   {"mode"},
                   {"fault"}};
  return table;
}

List overview_row(const Context& context, std::uint8_t node, std::span<const Result<Bytes>> answers,
                  bool has_others) {
  Value state;
  if (has_others && has_no_statusword(answers)) state = "no axis 1";
  if (const auto word = session::number_in(answers[0])) {
    const auto decoded = drive::decode_state(static_cast<std::uint16_t>(*word));
    state = context.chinese ? drive::name_zh(decoded) : drive::name(decoded);
  }
  return {node, network_cell(context, node), std::move(state), mode_cell(context, answers[1]),
          fault_of(context, answers).cell(std::string::npos)};
}

Result<report::Value> run_status(Context& context, const Arguments& arguments) {
  const auto restarted = says_restarted(context, arguments);
  if (!restarted) return fail(restarted.error());
  std::vector<session::SdoRequest> requests;
  for (const auto node : context.nodes)
    for (std::size_t i = 0; i < kCount; ++i)
      requests.push_back({.node = node, .object = kObjects[i], .size = kSizes[i]});
  const auto answers = context.session->transfer(requests);
  const auto heard = context.session->network().tells_state() ? ask_states(context, answers)
                                                              : hear_heartbeats(context, answers);
  if (!heard) return fail(heard.error());
  auto out = overview(context);
  for (std::size_t i = 0; i < context.nodes.size(); ++i) {
    const auto mine = std::span(answers).subspan(i * kCount, kCount);
    const bool refused = has_no_statusword(mine);
    if (!mine[0] && !refused) {
      context.errors.push_back(mine[0].error());
      continue;
    }
    const auto node = context.nodes[i];
    const auto others = motion::other_axes(*context.session, context.profile, node);
    tell_axes(context, node, others, !refused);
    out.documents.emplace_back(status_record(context, node, mine, *restarted, others));
    out.rows.push_back(overview_row(context, node, mine, !others.empty()));
  }
  out.json_only = out.rows.empty();
  if (arguments.has("--long")) return report::Value(std::move(out.documents));
  return report::Value(std::move(out));
}

constexpr Example kStatusExamples[] = {
    {"status -n all", "one line for each drive that answers"},
    {"status -n 1 -d gsd600 --long", "every bit of the statusword, and the fault in full"},
    {"status -n 1,2 --json", "for a script: `.result[].state`"},
};

}  // namespace

extern const Command kStatus;
const Command kStatus{
    .path = "status",
    .summary = "Show the state of drives, one line each: NMT or AL, CiA 402, mode, fault",
    .details =
        "Reads statusword, mode, error code and error register. A mode is shown by its number and its "
        "abbreviation in CiA 402, or, where a family counts its modes in its own way, by that family's name "
        "for it. --long shows the statusword with its bits, the error register and the fault in "
        "full; JSON always has all of it. The NMT state comes from the heartbeat; if "
        "the node sends one, status waits for it. On EtherCAT the slave is asked for its AL state; in SAFE-OP and "
        "OP --long shows the counts of process data as well. Values that were written, and that the drive goes by only after "
        "a restart, are shown until servoctl has seen the restart; --restarted says that there was one.",
    .parameters = kStatusParameters,
    .examples = kStatusExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_status,
};

}  // namespace servoctl::commands
