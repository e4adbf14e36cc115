
#include "motion/fault_reset.hpp"
#include "base/format.hpp"
#include "command/command.hpp"
#include "drive/standard_objects.hpp"
#include "show/planned_messages.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;

report::Table reset_table() {
  report::Table table;
  table.columns = {{"node"}, {"result"}, {"error", "", Show::json}};
  return table;
}

std::string whom_reset(const Context& context) {
  return context.nodes.size() == 1 ? formatted("node {}", context.nodes.front())
                                   : formatted("{} nodes", context.nodes.size());
}

void add_failure(Context& context, report::Table& table, std::uint8_t node, const Error& error) {
  table.rows.push_back({node, "failed", show::error_record(error)});
  context.errors.push_back(error);
}

Value planned_resets(Context& context) {
  std::vector<session::PlannedMessage> messages;
  for (const auto node : context.nodes) {
    const auto planned = motion::plan_fault_reset(*context.session, context.profile, node);
    if (!planned) {
      context.errors.push_back(planned.error());
      continue;
    }
    if (planned->empty())
      context.notices.push_back(message("node {} is not in Fault: nothing would be sent", node_name(node)));
    messages.insert(messages.end(), planned->begin(), planned->end());
  }
  return show::planned_messages(context, messages);
}

Result<Value> run_reset(Context& context, const Arguments&) {
  if (context.dry_run) return planned_resets(context);
  const auto question = formatted("Reset the fault of {}? The cause must be gone.", whom_reset(context));
  if (const auto answer = context.confirm(question); !answer) return fail(answer.error());
  auto table = reset_table();
  for (const auto node : context.nodes) {
    const auto done = motion::reset_fault(*context.session, context.profile, node);
    if (!done)
      add_failure(context, table, node, done.error());
    else
      table.rows.push_back({node, *done == motion::FaultReset::done ? "reset" : "no fault", Value()});
  }
  return Value(std::move(table));
}

bool history_is_empty(session::Session& session, std::uint8_t node) {
  const auto count = session.upload(node, objects::kErrorHistory);
  return count && !count->empty() && load_le(*count) == 0;
}

Result<Value> run_clear(Context& context, const Arguments&) {
  auto table = reset_table();
  std::vector<session::PlannedMessage> planned;
  for (const auto node : context.nodes) {
    if (history_is_empty(*context.session, node))
      table.rows.push_back({node, "was empty", Value()});
    else
      planned.push_back(session::planned_write({node, objects::kErrorHistory, Bytes{0}}));
  }
  if (context.dry_run) return show::planned_messages(context, planned);
  if (planned.empty()) return Value(std::move(table));
  const auto question = formatted("Clear the fault history of {}?", whom_reset(context));
  if (const auto answer = context.confirm(question); !answer) return fail(answer.error());
  for (const auto& each : planned) {
    const auto node = each.node;
    const auto written = context.session->download(node, each.write->object, *each.write->data);
    const auto left =
        written ? context.session->upload(node, objects::kErrorHistory) : Result<Bytes>(Bytes{});
    if (!written) {
      add_failure(context, table, node, written.error());
    } else if (!left || load_le(*left) != 0) {
      add_failure(context, table, node,
                  left ? drive_error(Errc::negative, node, objects::kErrorHistory,
                                     "the drive acknowledged, but its history is not empty")
                       : left.error());
    } else {
      table.rows.push_back({node, "cleared", Value()});
    }
  }
  return Value(std::move(table));
}

constexpr Example kFaultResetExamples[] = {
    {"fault reset -n 1 -d da200", "after the cause is gone; the drive stays disabled"},
    {"fault reset -n 1 -d gsd600", "needs Pn0032 = 1; with 0, the factory value, a power cycle resets it"},
};
constexpr Example kFaultClearHistoryExamples[] = {
    {"fault clear-history -n 1", "empty 1003h, after a question"},
};

}  // namespace

extern const Command kFaultReset;
const Command kFaultReset{
    .path = "fault reset",
    .summary = "Reset the fault of a drive",
    .details =
        "Only for a drive in state Fault: writes controlword 0000h, 0080h, 0000h, none of which can enable "
        "it; if the fault remains, the family's own method follows, if it has one. Exit code 1 if the fault "
        "remains then.",
    .parameters = {},
    .examples = kFaultResetExamples,
    .needs = Needs::node,
    .effect = Effect::resets,
    .run = run_reset,
};

extern const Command kFaultClearHistory;
const Command kFaultClearHistory{
    .path = "fault clear-history",
    .summary = "Clear the fault history of a drive (1003h)",
    .details = "Writes 0 to 1003h:00 and reads it back; an empty history is left as it is.",
    .parameters = {},
    .examples = kFaultClearHistoryExamples,
    .needs = Needs::node,
    .effect = Effect::resets,
    .run = run_clear,
};

}  // namespace servoctl::commands
