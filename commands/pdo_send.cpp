#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "drive/enabling_write.hpp"
#include "pdo/pdo_use.hpp"
#include "session/can_network.hpp"
#include "session/state_pause.hpp"
#include "settings/change.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using report::Value;

constexpr std::uint8_t kLastSynchronous = 240;

constexpr Parameter kPdoSendParameters[] = {
    {.name = "pdo", .help = "RPDO1 …", .kind = Kind::text, .required = true},
    {.name = "value",
     .help = "one for each mapped object, in their order; with units where known",
     .kind = Kind::value,
     .required = true,
     .many = true},
};

Result<void> check_usable(const show::PdoView& view) {
  if (view.pdo.direction == canopen::PdoDirection::transmit)
    return fail(Errc::usage, message("{} is a TPDO", view.name), "only RPDOs can be sent");
  if (!view.pdo.is_valid())
    return fail(Errc::negative, message("node {}: {} is not in use", node_name(view.node), view.name),
                "bit 31 of its COB-ID is set; `pdo enable` clears it");
  if (view.pdo.entries.empty())
    return fail(Errc::negative, message("node {}: {} maps nothing", node_name(view.node), view.name),
                "`pdo map` maps objects into it");
  if (view.pdo.bits() > 64)
    return fail(Errc::negative,
                message("node {}: {} is too long for classical CAN", node_name(view.node), view.name),
                "`pdo show` shows its length");
  return {};
}

Result<void> check_count(const show::PdoView& view, std::size_t given) {
  if (given == view.fields.size()) return {};
  std::vector<std::string> names;
  for (const auto& field : view.fields) names.push_back(field.name);
  std::string order;
  for (const auto& name : names) append(order, name);
  return fail(
      Errc::usage,
      message("{} carries {} value{}, {} given", view.name, names.size(), plural(names.size()), given),
      "in this order: " + order);
}

/// The frame that brings these values, and what they are in words.
struct Message {
  can::Frame frame;
  std::string text;
  bool enables = false;  ///< It energises the drive.
};
Result<Message> make_message(Context& context, const show::PdoView& view,
                             std::span<const std::string> values) {
  if (const auto right = check_count(view, values.size()); !right) return fail(right.error());
  std::vector<Bytes> data;
  std::size_t next = 0;
  bool enables = false;
  for (const auto& entry : view.pdo.entries) {
    if (entry.is_gap()) {
      data.emplace_back();
      continue;
    }
    const auto& field = view.fields[next];
    auto change = settings::make_change(context, view.node, field.target, values[next], field.type);
    if (!change) return fail(change.error());
    enables = enables || drive::is_enabling_write(entry.object, change->data);
    data.push_back(std::move(change->data));
    ++next;
  }
  Message out{canopen::pdo_frame(view.can_id(), canopen::pack_pdo(view.pdo.entries, data)), {}, enables};
  show::append_values(view, out.frame.payload(), context.chinese, out.text);
  return out;
}

Result<void> check_operational(Context& context, const show::PdoView& view) {
  const auto state = session::ask_state(*context.session, view.node, !context.dry_run);
  if (!state) return fail(state.error());
  if (!*state) {
    context.notices.push_back(
        message("node {}: not known whether it is operational (no heartbeat{}); if not, it ignores PDOs",
                node_name(view.node), context.dry_run ? ", and a dry run does not guard it" : ""));
    return {};
  }
  if (**state == session::NodeState::operational) return {};
  return fail(Errc::negative,
              message("node {} is {}: it ignores PDOs", node_name(view.node), session::name(**state)),
              message("`nmt start -n {}` makes it operational", node_name(view.node)));
}

report::Written written_values(const show::PdoView& view, const can::Frame& frame) {
  report::Written out;
  report::JsonWriter json(out.json);
  show::write_values(view, frame.payload(), json);
  return out;
}

Result<Value> run_pdo_send(Context& context, const Arguments& arguments) {
  if (context.nodes.size() != 1)
    return fail(Errc::usage, "`pdo send` is for one node at a time", "name one node, such as -n 1");
  const auto views = pdo::read_views(context, context.nodes.front());
  if (!views) return fail(views.error());
  const auto found = pdo::find_view(*views, context.nodes.front(), arguments.text("pdo"));
  if (!found) return fail(found.error());
  const auto& view = **found;
  if (const auto usable = check_usable(view); !usable) return fail(usable.error());
  const auto message = make_message(context, view, arguments.all("value"));
  if (!message) return fail(message.error());
  report::Record answer{{"node", view.node},
                        {"pdo", view.name},
                        {"frame", can::to_string(message->frame)},
                        {"values", message->text, report::Show::text},
                        {"values", written_values(view, message->frame), report::Show::json}};
  if (const auto ready = check_operational(context, view); !ready) return fail(ready.error());
  if (context.dry_run) return Value(std::move(answer));
  if (const auto sure = context.confirm(
          formatted("Send {} to node {}: {}? The motor may move.", view.name, view.node, message->text));
      !sure)
    return fail(sure.error());
  if (message->enables) {
    context.session->energised().insert(view.node);
    context.session->network().expect_power(view.node);
  }
  if (const auto sent = context.session->can()->send(message->frame); !sent) return fail(sent.error());
  if (view.pdo.type <= kLastSynchronous)
    context.notices.push_back(servoctl::message("{} takes effect at the next SYNC: `sync once`", view.name));
  return Value(std::move(answer));
}

constexpr Example kPdoSendExamples[] = {
    {"pdo send RPDO1 0x06 -n 1 -d gsd600", "a controlword that enables nothing; asks first"},
};

}  // namespace

extern const Command kPdoSend;
const Command kPdoSend{
    .path = "pdo send",
    .summary = "Send an RPDO once with these values; asks first",
    .details =
        "Reads the node's mapping and packs the values, one for each mapped object, into the PDO: `pdo send "
        "RPDO1 0x0F 1000rpm`. Types, limits and units are checked as for `write`. Refused if the PDO is not "
        "in use or the node is not operational. PDOs are not answered: `status` or `pdo watch` show the "
        "effect.",
    .parameters = kPdoSendParameters,
    .examples = kPdoSendExamples,
    .needs = Needs::node | Needs::can,
    .effect = Effect::moves,
    .run = run_pdo_send,
    .elsewhere = "`state op`, then `write`: what is mapped goes out with the next cycle",
};

}  // namespace servoctl::commands
