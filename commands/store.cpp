#include "base/format.hpp"
#include "session/storage.hpp"

#include <array>

#include "command/command.hpp"
#include "settings/address_change.hpp"
#include "show/planned_messages.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;
using session::ParameterGroup;

constexpr std::array<std::string_view, 4> kGroups{"all", "communication", "application", "vendor"};

constexpr Parameter kStoreParameters[] = {
    {.name = "group", .help = "all (default), or a part", .kind = Kind::choice, .choices = kGroups},
};

Result<ParameterGroup> group_of(const Arguments& arguments) {
  const auto word = arguments.has("group") ? arguments.text("group") : kGroups.front();
  for (std::size_t i = 0; i < kGroups.size(); ++i)
    if (kGroups[i] == word) return static_cast<ParameterGroup>(i + 1);
  return fail(Errc::usage, message("'{}' is not a group of parameters", as_it_is(word)),
              "use all, communication, application or vendor");
}

struct Words {
  std::string_view question, done;
};

struct Method {
  Result<void> (*carry_out)(session::Session&, const drive::Profile*, std::uint8_t, ParameterGroup);
  Result<std::vector<session::SdoRequest>> (*writes)(const drive::Profile*, std::uint8_t, ParameterGroup);
  /// Gains and limits are no things to change under a drive that holds a load.
  bool changes_settings = false;
};

Value planned_store(Context& context, ParameterGroup group, const Method& method) {
  std::vector<session::PlannedMessage> messages;
  for (const auto node : context.nodes) {
    const auto writes = method.writes(context.profile, node, group);
    if (!writes) context.errors.push_back(writes.error());
    if (!writes) continue;
    for (const auto& write : *writes) messages.push_back(session::planned_write(write));
  }
  return show::planned_messages(context, messages);
}

Result<Value> carry_out(Context& context, const Arguments& arguments, const Method& method,
                        const Words& words) {
  const auto group = group_of(arguments);
  if (!group) return fail(group.error());
  if (context.dry_run) return planned_store(context, *group, method);
  if (method.changes_settings)
    for (const auto node : context.nodes)
      if (const auto still = settings::refuse_energised(*context.session, node, "its settings"); !still)
        return fail(still.error());
  const auto whom = context.nodes.size() == 1 ? formatted("node {}", context.nodes.front())
                                              : formatted("{} nodes", context.nodes.size());
  if (const auto answer = context.confirm(formatted(fmt::runtime(words.question), whom)); !answer)
    return fail(answer.error());
  report::Table table;
  table.columns = {{"node"}, {"result"}, {"error", "", Show::json}};
  for (const auto node : context.nodes) {
    const auto done = method.carry_out(*context.session, context.profile, node, *group);
    if (!done) context.errors.push_back(done.error());
    table.rows.push_back(
        {node, done ? words.done : "failed", done ? Value() : show::error_record(done.error())});
  }
  return Value(std::move(table));
}

Result<Value> run_store(Context& context, const Arguments& arguments) {
  return carry_out(context, arguments, {session::store_parameters, session::store_writes},
                   {"Store the present values of {}? They replace the power-on values.", "stored"});
}

Result<Value> run_defaults(Context& context, const Arguments& arguments) {
  return carry_out(context, arguments, {session::restore_defaults, session::restore_writes, true},
                   {"Restore the factory values of {}? What is set now is lost (`backup` keeps it).",
                    "restored; takes effect after a restart of the drive"});
}

constexpr Example kStoreExamples[] = {
    {"store -n 1 -d gsd600", "what was written to the drive survives power-off"},
    {"store -n 1 -d gsd600 --dry-run", "only show the frames"},
};
constexpr Example kDefaultsExamples[] = {
    {"defaults -n 1 -d gsd600 --dry-run", "first: show the frames"},
    {"defaults -n 1 -d gsd600", "all factory values, after a question; `nmt reset` restarts the drive"},
};

}  // namespace

extern const Command kStore;
const Command kStore{
    .path = "store",
    .summary = "Store the present values in the drive",
    .details =
        "Writes \"save\" to 1010h, or uses the family's own method. Waits up to 10 s for the drive. Where "
        "values can be kept only at the moment they are written, store says so: use `param set … --keep`.",
    .parameters = kStoreParameters,
    .examples = kStoreExamples,
    .needs = Needs::node,
    .effect = Effect::stores,
    .run = run_store,
};

extern const Command kDefaults;
const Command kDefaults{
    .path = "defaults",
    .summary = "Restore the factory values of a drive",
    .details =
        "Writes \"load\" to 1011h, or uses the family's own method. Takes effect after a restart. "
        "A drive that is energised is refused.",
    .parameters = kStoreParameters,
    .examples = kDefaultsExamples,
    .needs = Needs::node,
    .effect = Effect::resets,
    .run = run_defaults,
};

}  // namespace servoctl::commands
