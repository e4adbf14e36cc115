#include "commands/frame_decoder.hpp"

#include <fmt/format.h>
#include <utility>

#include "can/controller_report.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/nmt.hpp"
#include "canopen/sdo_abort.hpp"
#include "commands/notice.hpp"
#include "commands/reading.hpp"
#include "commands/records.hpp"

namespace servoctl::commands {
namespace {

using canopen::SdoStep;
using report::Value;
using Step = SdoStep::Kind;

/// The node of an identifier between base + 1 and base + 127.
std::optional<std::uint8_t> node_of(const can::Frame& frame, std::uint32_t base) {
  if (frame.extended || frame.id <= base || frame.id > base + canopen::kLastNode) return std::nullopt;
  return static_cast<std::uint8_t>(frame.id - base);
}

std::string_view name(Step kind) {
  switch (kind) {
    case Step::read: return "read";
    case Step::write: return "write";
    case Step::answer: return "answer";
    case Step::acknowledge: return "acknowledge";
    case Step::next: return "next";
    case Step::segment: return "segment";
    case Step::end: return "end";
    case Step::abort: return "abort";
    case Step::unknown: break;
  }
  return "unknown";
}

/// What happens to the object, before its value.
std::string phrase(const SdoStep& step, const std::string& object) {
  switch (step.kind) {
    case Step::read: return "read " + object;
    case Step::write: return "write " + object;
    case Step::answer: return "answer " + object;
    case Step::acknowledge: return "taken " + object;
    case Step::segment:
    case Step::end:
      if (step.data) return (step.from_client ? "write " : "answer ") + object;
      if (step.kind == Step::end) return "end " + object;
      return fmt::format("segment {}, {} bytes so far", object, step.received);
    case Step::next: return "go on " + object;
    case Step::abort:
      return fmt::format("abort {} by the {}: 0x{:08X} {}", object, step.from_client ? "master" : "node",
                         step.abort_code, canopen::sdo_abort_text(step.abort_code));
    case Step::unknown: break;
  }
  return "no SDO of CiA 301";
}

DecodedFrame decode_nmt(const can::Frame& frame) {
  DecodedFrame out{"nmt", {}, "no NMT command of CiA 301", {}};
  const auto message = canopen::parse_nmt(frame);
  if (!message) return out;
  if (message->node != 0) out.node = message->node;
  out.text =
      fmt::format("NMT {}{}", canopen::name(message->command), message->node == 0 ? ", all nodes" : "");
  out.fields = {{"command", canopen::name(message->command)}};
  return out;
}

}  // namespace

DecodedFrame FrameDecoder::decode(const can::Frame& frame) {
  if (frame.error) {
    const auto report = can::parse_report(frame);
    return {"controller", {}, report ? std::string(can::text(*report)) : "report of the controller", {}};
  }
  if (frame.extended) return {"other", {}, "29-bit identifier", {}};
  if (frame.id == canopen::kNmt) return decode_nmt(frame);
  if (frame.id == canopen::kSync) return {"sync", {}, "SYNC", {}};
  if (const auto emergency = canopen::parse_emergency(frame)) {
    const auto text = notice_text({{}, emergency->node, *emergency}, profile_, chinese_);
    return {"emcy",
            emergency->node,
            text.substr(text.find(": ") + 2),
            {{"code", report::Hex{emergency->code, 4}}, {"error_register", emergency->error_register}}};
  }
  if (node_of(frame, canopen::kSdoAnswer) || node_of(frame, canopen::kSdoRequest)) return decode_sdo(frame);
  if (node_of(frame, canopen::kErrorControl)) return decode_error_control(frame);
  return {"other", {}, fmt::format("identifier 0x{:03X}, {} bytes", frame.id, frame.size), {}};
}

DecodedFrame FrameDecoder::decode_error_control(const can::Frame& frame) const {
  const auto node = node_of(frame, canopen::kErrorControl);
  if (frame.remote) return {"guarding", node, "node guarding asks", {}};
  const auto message = canopen::parse_error_control(frame);
  if (!message) return {"other", node, "no heartbeat of CiA 301", {}};
  if (message->boot_up) return {"boot-up", node, "boot-up", {}};
  const bool toggle = (frame.data[0] & 0x80U) != 0;
  return {"heartbeat",
          node,
          fmt::format("{}{}", canopen::name(message->state), toggle ? " (answer to node guarding)" : ""),
          {{"state", canopen::name(message->state)}, {"toggle", toggle}}};
}

std::string FrameDecoder::name_of(ObjectAddress object) const {
  const auto target = drive::target_at(profile_, object);
  const auto label = chinese_ ? target.label_zh() : target.label();
  return to_string(object) + (label.empty() ? "" : " " + label);
}

DecodedFrame FrameDecoder::decode_sdo(const can::Frame& frame) {
  const auto asked = node_of(frame, canopen::kSdoRequest);
  const auto node = asked ? *asked : *node_of(frame, canopen::kSdoAnswer);
  auto& channel = channels_[node];
  const auto step = asked ? channel.on_client_frame(frame) : channel.on_server_frame(frame);
  DecodedFrame out{"sdo", node, {}, {}};
  out.text = phrase(step, step.object ? name_of(*step.object) : "of a transfer begun before");
  out.fields = {{"step", name(step.kind)}, {"from", step.from_client ? "master" : "node"}};
  if (step.block) out.fields.push_back({"block", true});
  if (step.object) {
    out.fields.push_back({"index", step.object->index});
    out.fields.push_back({"sub", step.object->sub});
    const auto target = drive::target_at(profile_, *step.object);
    out.fields.push_back({"name", report::text_or_null(target.label())});
    if (step.data) {
      const auto value = decode_value({node, target, {}, *step.data}, *step.data);
      out.text += " = " + value.text;
      const auto& label = chinese_ && !value.label_zh.is_null() ? value.label_zh : value.label;
      if (const auto* words = std::get_if<std::string>(&label.data())) out.text += " " + *words;
      out.fields.push_back({"value", value.value});
      out.fields.push_back({"unit", report::text_or_null(value.unit)});
      out.fields.push_back({"label", value.label});
      out.fields.push_back({"bytes", to_hex(*step.data)});
    }
  }
  if (step.announced) {
    out.fields.push_back({"announced", *step.announced});
    out.text += fmt::format(", {} bytes", *step.announced);
  }
  if (step.kind == Step::abort)
    out.fields.push_back({"abort", report::Record{{"code", fmt::format("0x{:08X}", step.abort_code)},
                                                  {"text", canopen::sdo_abort_text(step.abort_code)}}});
  return out;
}

}  // namespace servoctl::commands
