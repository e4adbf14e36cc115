#include <algorithm>

#include "base/format.hpp"
#include "canopen/emergency.hpp"
#include "command/command.hpp"
#include "drive/cia402.hpp"
#include "drive/standard_objects.hpp"
#include "session/modbus_network.hpp"
#include "session/no_register.hpp"
#include "show/fault_records.hpp"
#include "show/reading.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::List;
using report::Record;
using report::Show;
using report::Value;

constexpr std::uint8_t kMostHistory = 254;

std::string shown_code(std::uint16_t code, const std::string& words) {
  return formatted("0x{:04X} {}", code, words);
}

constexpr std::string_view kMissing = "the drive does not have it";

/// Everything one node says of its faults.
class FaultReport {
 public:
  FaultReport(Context& context, std::uint8_t node) : context_(&context), node_(node) {}

  Result<Record> make() {
    const auto statusword = read(objects::kStatusword);
    out_ = {{"node", node_}};
    add_state(statusword);
    add_code();
    add_register();
    add_alarm();
    add_emergencies();
    add_history();
    if (failure_) return fail(*failure_);
    // A few are told in full; of many `fault list PANEL` tells more.
    const bool few = candidates_.size() <= show::kFewFaults;
    for (const auto* fault : candidates_)
      if (few)
        out_.push_back({"alarm_" + fault->panel, show::fault_record(*fault, context_->chinese), Show::text,
                        title_of(*fault)});
    out_.push_back({"alarms", show::fault_table(candidates_, context_->chinese),
                    few ? Show::json : Show::everywhere, "what it may be"});
    return std::move(out_);
  }

 private:
  /// Empty where the drive does not have the object. Every other failure is kept and ends the report.
  std::optional<Bytes> read(ObjectAddress object) {
    if (failure_) return std::nullopt;
    const auto answer = context_->session->upload(node_, object);
    if (answer) return *answer;
    if (answer.error().code != Errc::sdo_abort) failure_ = answer.error();
    return std::nullopt;
  }

  std::string missing(ObjectAddress object) const {
    const auto* line = context_->session->modbus();
    return std::string(line != nullptr && !line->has_register(node_, object) ? session::kNoRegister
                                                                             : kMissing);
  }

  std::string words(std::uint16_t code, const std::array<std::uint8_t, 5>& vendor = {}) {
    if (context_->profile != nullptr)
      for (const auto* fault :
           drive::faults_of(context_->profile->faults, context_->profile->rules.emergency, code, vendor))
        if (std::find(candidates_.begin(), candidates_.end(), fault) == candidates_.end())
          candidates_.push_back(fault);
    return show::fault_words(context_->profile, context_->chinese, code, vendor);
  }

  /// An object of the family's own: the classes of CiA 301 are not for its codes.
  std::string alarm(std::uint16_t code) {
    (void)words(code);
    return show::alarm_words(context_->profile, context_->chinese, code);
  }

  std::string title_of(const drive::Fault& fault) const {
    if (!fault.panel.empty()) return fault.panel;
    return fault.code ? formatted("0x{:04X}", *fault.code) : "fault";
  }

  void add_state(const std::optional<Bytes>& statusword) {
    if (!statusword) return out_.push_back({"state", Value(), Show::json});
    const auto state = drive::decode_state(static_cast<std::uint16_t>(load_le(*statusword)));
    out_.push_back(
        {"state", context_->chinese ? drive::name_zh(state) : drive::name(state), Show::text, "drive state"});
    out_.push_back({"state", drive::name(state), Show::json});
  }

  void add_code() {
    const auto answer = read(objects::kErrorCode);
    if (!answer) {
      out_.push_back({"code_text", missing(objects::kErrorCode), Show::text, "error code 603Fh"});
      for (const auto* key : {"code", "text"}) out_.push_back({key, Value(), Show::json});
      return;
    }
    const auto code = static_cast<std::uint16_t>(load_le(*answer));
    out_.push_back(
        {"code_text", code == 0 ? "none" : shown_code(code, words(code)), Show::text, "error code 603Fh"});
    out_.push_back({"code", code, Show::json});
    out_.push_back({"text", code == 0 ? Value() : Value(words(code)), Show::json});
  }

  void add_register() {
    const auto answer = read(objects::kErrorRegister);
    const auto bits = answer ? static_cast<std::uint8_t>(load_le(*answer)) : std::uint8_t{0};
    out_.push_back({"register_text",
                    answer ? formatted("0x{:02X} {}", bits, canopen::error_register_text(bits))
                           : missing(objects::kErrorRegister),
                    Show::text, "error register 1001h"});
    out_.push_back({"error_register", answer ? Value(bits) : Value(), Show::json});
  }

  /// The parameter in which the family keeps a number of its own.
  std::optional<drive::Target> alarm_target() const {
    const auto* profile = context_->profile;
    if (profile == nullptr || profile->rules.fault.alarm.empty()) return std::nullopt;
    auto target = drive::resolve(profile, profile->rules.fault.alarm);
    return target ? std::optional(std::move(*target)) : std::nullopt;
  }

  void add_alarm() {
    const auto target = alarm_target();
    if (!target) return out_.push_back({"alarm", Value(), Show::json});
    const auto answer = read(target->address);
    const auto code = answer ? static_cast<std::uint16_t>(load_le(*answer)) : std::uint16_t{0};
    out_.push_back({"alarm_text",
                    !answer     ? missing(target->address)
                    : code == 0 ? std::string("none")
                                : shown_code(code, alarm(code)),
                    Show::text, context_->chinese ? target->label_zh() : target->label()});
    out_.push_back({"alarm",
                    answer ? Value(Record{{"id", target->parameter != nullptr ? target->parameter->id
                                                                              : to_string(target->address)},
                                          {"value", code}})
                           : Value(),
                    Show::json});
  }

  void add_emergencies() {
    List records;
    List lines;
    for (const auto& e : context_->session->watch().emergencies(node_)) {
      const auto text = words(e.code, e.vendor);
      records.emplace_back(Record{{"code", e.code},
                                  {"error_register", e.error_register},
                                  {"vendor", to_hex(e.vendor)},
                                  {"text", text}});
      lines.emplace_back(shown_code(e.code, text));
    }
    if (!lines.empty()) out_.push_back({"emergency_text", std::move(lines), Show::text, "emergencies heard"});
    out_.push_back({"emergencies", std::move(records), Show::json});
  }

  void add_history() {
    const auto count = read(objects::kErrorHistory);
    List records;
    report::Table table;
    table.columns = {{"number", ""}, {"code"}, {"vendor"}, {"text", "meaning"}};
    for (std::uint8_t i = 1; count && i <= std::min<std::uint64_t>(load_le(*count), kMostHistory); ++i) {
      const auto entry = read({objects::kErrorHistory.index, i});
      if (!entry) break;
      const auto value = static_cast<std::uint32_t>(load_le(*entry));
      const auto code = static_cast<std::uint16_t>(value & 0xFFFFU);
      const auto vendor = value >> 16U;
      const std::array<std::uint8_t, 5> bytes{static_cast<std::uint8_t>(vendor & 0xFFU),
                                              static_cast<std::uint8_t>(vendor >> 8U)};
      const auto text = show::fault_words(context_->profile, context_->chinese, code, bytes);
      records.emplace_back(Record{{"code", code}, {"vendor", vendor}, {"text", text}});
      table.rows.push_back({i, report::Hex{code, 4}, report::Hex{vendor, 4}, text});
    }
    if (!count)
      out_.push_back({"history_text", missing(objects::kErrorHistory), Show::text, "history 1003h"});
    else if (table.rows.empty())
      out_.push_back({"history_text", "empty", Show::text, "history 1003h"});
    else
      out_.push_back({"history_table", std::move(table), Show::text, "history 1003h, newest first"});
    out_.push_back({"history", count ? Value(std::move(records)) : Value(), Show::json});
  }

  Context* context_;
  std::uint8_t node_;
  Record out_;
  std::optional<Error> failure_;
  std::vector<const drive::Fault*> candidates_;
};

Result<Value> run_fault_show(Context& context, const Arguments&) {
  List out;
  for (const auto node : context.nodes) {
    auto record = FaultReport(context, node).make();
    if (record)
      out.emplace_back(std::move(*record));
    else
      context.errors.push_back(record.error());
  }
  return Value(std::move(out));
}

constexpr Example kFaultShowExamples[] = {
    {"fault show -n 1 -d gsd600", "the fault, its history, and what to do"},
    {"fault show -n all -d gsd600", "of all drives that answer"},
};

}  // namespace

extern const Command kFaultShow;
const Command kFaultShow{
    .path = "fault show",
    .summary = "Show what is wrong with a drive and what to do",
    .details =
        "Reads error code (603Fh), error register (1001h), history (1003h) and the family's own alarm "
        "parameter, and adds the emergencies heard in this session. Where several alarms share a code, all "
        "are shown.",
    .parameters = {},
    .examples = kFaultShowExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_fault_show,
    .on_registers = true,
};

}  // namespace servoctl::commands
