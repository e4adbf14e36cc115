#include "show/planned_messages.hpp"

#include "base/bytes.hpp"
#include "base/duration.hpp"
#include "canopen/nmt.hpp"
#include "canopen/sdo_client.hpp"
#include "drive/naming.hpp"
#include "session/can_network.hpp"
#include "session/modbus_network.hpp"
#include "session/wary.hpp"

namespace servoctl::show {
namespace {

std::string object_text(const session::PlannedMessage& message) {
  if (message.write) return to_string(message.write->object);
  return message.state ? "NMT" : "error control";
}

std::string name_text(const Desk& desk, const session::PlannedMessage& message) {
  if (message.write) {
    const auto target = drive::target_at(desk.profile, message.write->object);
    return desk.chinese ? target.label_zh() : target.label();
  }
  if (message.life_sign)
    return message.life_sign->kind == session::LifeSign::Kind::guarding ? "node guarding" : "heartbeat";
  const auto command = session::nmt_command(*message.state);
  return command ? std::string(canopen::name(*command)) : std::string();
}

/// What is written is what counts: how mailboxes and process data carry it is the network's.
report::List ring_row(const Desk& desk, const session::PlannedMessage& message) {
  const auto& network = desk.session->network();
  report::List row{message.node};
  if (message.write) {
    const auto& data = *message.write->data;
    constexpr std::size_t kLongestNumber = 8;
    row.insert(row.end(), {object_text(message), report::text_or_null(name_text(desk, message)),
                           report::text_or_null(message.when)});
    if (!data.empty() && data.size() <= kLongestNumber)
      row.emplace_back(report::Hex{load_le(data), static_cast<int>(2 * data.size())});
    else
      row.emplace_back(to_hex(data));
  } else if (message.state) {
    row.insert(
        row.end(),
        {network.state_title(), {}, report::text_or_null(message.when), network.state_word(*message.state)});
  } else {
    row.insert(row.end(),
               {"watchdog", "without process data", {}, servoctl::to_string(message.life_sign->period)});
  }
  return row;
}

report::Value planned_on_ring(Desk& desk, std::span<const session::PlannedMessage> messages) {
  report::Table table;
  table.columns = {{"node"}, {"object"}, {"name"}, {"when"}, {"value"}};
  table.json_only = messages.empty();  // Notices and errors say why.
  for (const auto& message : messages)
    if (would_be_sent(desk, message)) table.rows.push_back(ring_row(desk, message));
  return table;
}

/// The frames of Modbus; a network of CAN has none of them, nor one of Modbus any but writes.
report::Value planned_on_line(const Desk& desk, std::span<const session::PlannedMessage> messages) {
  report::Table table;
  table.columns = {{"node"}, {"object"}, {"name"}, {"when"}, {"frame"}};
  table.json_only = messages.empty();
  for (const auto& message : messages)
    if (message.write)
      table.rows.push_back(
          {message.node, object_text(message), report::text_or_null(name_text(desk, message)),
           report::text_or_null(message.when),
           desk.session->modbus()->write_frame(message.node, message.write->object, *message.write->data)});
  return table;
}

}  // namespace

std::string frame_text(const session::PlannedMessage& message) {
  if (message.life_sign) return can::to_string(session::frame_of(*message.life_sign, message.node));
  if (message.state) {
    const auto command = session::nmt_command(*message.state);
    return command ? can::to_string(canopen::nmt_frame(*command, message.node)) : std::string();
  }
  canopen::SdoClient client(message.node, std::chrono::seconds(1));
  client.start_download(message.write->object, *message.write->data, TimePoint{}, message.write->transfer);
  const auto frame = client.take_frame();
  return frame ? can::to_string(*frame) : std::string();
}

bool is_sent_as_frames(const Desk& desk) {
  return desk.session == nullptr || (!desk.session->network().is_ring() && desk.session->modbus() == nullptr);
}

bool would_be_sent(Desk& desk, const session::PlannedMessage& message) {
  if (!message.write || desk.session == nullptr) return true;
  auto refusal = session::refusal_of(*desk.session, message.node, message.write->object);
  if (!refusal) return true;
  desk.errors.push_back(*std::move(refusal));
  return false;
}

report::Value planned_messages(Desk& desk, std::span<const session::PlannedMessage> messages) {
  if (desk.session != nullptr && desk.session->modbus() != nullptr) return planned_on_line(desk, messages);
  if (!is_sent_as_frames(desk)) return planned_on_ring(desk, messages);
  report::Table table;
  table.columns = {{"node"}, {"object"}, {"name"}, {"when"}, {"frame"}};
  table.json_only = messages.empty();  // Notices and errors say why.
  for (const auto& message : messages)
    if (would_be_sent(desk, message))
      table.rows.push_back({message.node, object_text(message),
                            report::text_or_null(name_text(desk, message)),
                            report::text_or_null(message.when), frame_text(message)});
  return table;
}

}  // namespace servoctl::show
