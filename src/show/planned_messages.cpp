#include "show/planned_messages.hpp"

#include "canopen/cob_id.hpp"
#include "canopen/nmt.hpp"
#include "canopen/sdo_client.hpp"
#include "drive/naming.hpp"

namespace servoctl::show {
namespace {

std::string object_text(const session::PlannedMessage& message) {
  if (message.write) return to_string(message.write->object);
  return message.frame->id == canopen::kNmt ? "NMT" : "error control";
}

std::string name_text(const Desk& desk, const session::PlannedMessage& message) {
  if (message.write) return drive::target_at(desk.profile, message.write->object).label();
  if (message.frame->id != canopen::kNmt) return message.frame->remote ? "node guarding" : "heartbeat";
  return std::string(canopen::name(static_cast<canopen::NmtCommand>(message.frame->data[0])));
}

}  // namespace

std::string frame_text(const session::PlannedMessage& message) {
  if (!message.write) return can::to_string(*message.frame);
  canopen::SdoClient client(message.node, std::chrono::seconds(1));
  client.start_download(message.write->object, *message.write->data, TimePoint{}, message.write->transfer);
  const auto frame = client.take_frame();
  return frame ? can::to_string(*frame) : std::string();
}

report::Value planned_messages(const Desk& desk, std::span<const session::PlannedMessage> messages) {
  report::Table table;
  table.columns = {{"node"}, {"object"}, {"name"}, {"when"}, {"frame"}};
  table.json_only = messages.empty();  // Notices and errors say why.
  for (const auto& message : messages)
    table.rows.push_back({message.node, object_text(message), report::text_or_null(name_text(desk, message)),
                          report::text_or_null(message.when), frame_text(message)});
  return table;
}

}  // namespace servoctl::show
