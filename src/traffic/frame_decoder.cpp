#include "traffic/frame_decoder.hpp"

#include <fmt/format.h>
#include <chrono>
#include <utility>

#include "can/controller_report.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/error_control.hpp"
#include "canopen/lss.hpp"
#include "canopen/nmt.hpp"
#include "drive/standard_objects.hpp"
#include "drive/word_bits.hpp"
#include "show/notice.hpp"
#include "show/reading.hpp"
#include "show/records.hpp"
#include "traffic/lss_words.hpp"
#include "traffic/sdo_words.hpp"

namespace servoctl::traffic {
namespace {

using canopen::SdoStep;
using Step = SdoStep::Kind;

constexpr std::uint32_t kTime = 0x100;  ///< TIME (CiA 301, 7.3.5).
constexpr std::uint32_t kFirstPdo =
    0x180;  ///< PDOs of the pre-defined connection set lie between this and SDO.

/// The node of an identifier between base + 1 and base + 127.
std::optional<std::uint8_t> node_of(const can::Frame& frame, std::uint32_t base) {
  if (frame.extended || frame.id <= base || frame.id > base + canopen::kLastNode) return std::nullopt;
  return static_cast<std::uint8_t>(frame.id - base);
}

/// `2026-11-21 13:05:00.250`: milliseconds since midnight, days since 1984 (CiA 301, 7.1.6.5).
std::string time_of_day(ByteSpan data) {
  const auto milliseconds = load_le(data.first(4)) & 0x0FFF'FFFFU;
  const auto days = load_le(data.subspan(4, 2));
  const std::chrono::year_month_day date =
      std::chrono::sys_days(std::chrono::year(1984) / 1 / 1) + std::chrono::days(days);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}.{:03}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     milliseconds / 3'600'000, milliseconds / 60'000 % 60, milliseconds / 1000 % 60,
                     milliseconds % 1000);
}

}  // namespace

const DecodedFrame& FrameDecoder::decode(const can::Frame& frame) {
  out_.service = "other";
  out_.node.reset();
  out_.text.clear();
  out_.fields.clear();
  out_.objects.clear();
  if (frame.error) {
    const auto report = can::parse_report(frame);
    out_.service = "controller";
    out_.text = report ? can::text(*report) : "error frame, or report of the controller";
  } else {
    decode_service(frame);
  }
  return out_;
}

void FrameDecoder::decode_service(const can::Frame& frame) {
  const auto node = static_cast<std::uint8_t>(frame.id & canopen::kLastNode);
  if (const auto emergency = emergency_ids_.parse(frame)) return decode_emergency(*emergency);
  // Then PDOs: on a bus at work most frames are.
  const auto* pdo = frame.remote ? nullptr : pdos_.find(canopen::can_id_of(frame));
  if (pdo != nullptr) return decode_pdo(frame, pdo->node, pdo);
  if (frame.extended) {
    out_.text = "29-bit identifier";
    return;
  }
  if (frame.id == canopen::kNmt) return decode_nmt(frame);
  if (frame.id == canopen::kSync) return decode_sync(frame);
  if (frame.id == kTime) return decode_time(frame);
  if (node_of(frame, canopen::kSdoAnswer) || node_of(frame, canopen::kSdoRequest)) return decode_sdo(frame);
  if (node_of(frame, canopen::kErrorControl)) return decode_error_control(frame);
  if (frame.id == canopen::kLssRequest || frame.id == canopen::kLssAnswer) return decode_lss(frame);
  if (frame.id > kFirstPdo && frame.id < canopen::kSdoAnswer && node != 0)
    return decode_pdo(frame, node, nullptr);
  out_.text = fmt::format("identifier 0x{:03X}, {} bytes", frame.id, frame.size);
}

void FrameDecoder::decode_nmt(const can::Frame& frame) {
  out_.service = "nmt";
  const auto message = canopen::parse_nmt(frame);
  if (!message) {
    out_.text = "no NMT command of CiA 301";
    return;
  }
  if (message->node != 0) out_.node = message->node;
  out_.text =
      fmt::format("NMT {}{}", canopen::name(message->command), message->node == 0 ? ", all nodes" : "");
  if (options_.fields) fields_.member("command", canopen::name(message->command));
}

void FrameDecoder::decode_sync(const can::Frame& frame) {
  out_.service = "sync";
  out_.text = "SYNC";
  if (frame.remote || frame.size == 0) return;
  out_.text += fmt::format(" {}", frame.data[0]);
  if (options_.fields) fields_.member("counter", frame.data[0]);
}

void FrameDecoder::decode_time(const can::Frame& frame) {
  out_.service = "time";
  if (frame.remote || frame.size < 6) {
    out_.text = "no TIME of CiA 301";
    return;
  }
  const auto time = time_of_day(frame.payload());
  out_.text = "TIME " + time;
  if (options_.fields) fields_.member("tells", time);
}

void FrameDecoder::decode_emergency(const canopen::Emergency& emergency) {
  out_.service = "emcy";
  out_.node = emergency.node;
  out_.text = show::event_text({{}, emergency.node, emergency}, options_.profile, options_.chinese);
  if (!options_.fields) return;
  fields_.member("code", emergency.code);
  fields_.member("error_register", emergency.error_register);
}

void FrameDecoder::decode_lss(const can::Frame& frame) {
  out_.service = "lss";
  out_.text = lss_text(frame);
  if (options_.fields) fields_.member("from", frame.id == canopen::kLssRequest ? "master" : "slave");
}

/// By its mapping, or by the pre-defined connection set alone.
void FrameDecoder::decode_pdo(const can::Frame& frame, std::uint8_t node, const show::PdoView* view) {
  out_.service = "pdo";
  out_.node = node;
  if (frame.remote) {
    out_.text = fmt::format("PDO 0x{:03X} requested by a remote frame", frame.id);
    return;
  }
  const auto data = frame.payload();
  if (view == nullptr) {
    const bool receive = (frame.id & 0x80U) == 0;
    const auto number = static_cast<std::uint16_t>((frame.id - (receive ? 0x180U : 0x080U)) >> 8U);
    out_.text =
        canopen::name(receive ? canopen::PdoDirection::receive : canopen::PdoDirection::transmit, number) +
        " " + to_hex(data) + " (mapping not known)";
    return;
  }
  out_.text += view->name;
  const bool assumed = view->assumed && shows_values(*view, data);
  if (assumed) out_.text += options_.chinese ? "（出厂映射）" : " (factory mapping)";
  out_.text += ' ';
  show::append_values(*view, data, options_.chinese, out_.text, modes_[node % modes_.size()]);
  for (const auto& field : view->fields) {
    out_.objects.push_back(field.entry.object);
    if (field.entry.object == objects::kModeOfOperation) modes_[node % modes_.size()] = 0;
  }
  if (!options_.fields) return;
  fields_.member("pdo", view->name);
  if (assumed) fields_.member("mapping", "factory");
  fields_.key("values");
  show::write_values(*view, data, fields_);
}

void FrameDecoder::decode_error_control(const can::Frame& frame) {
  out_.node = node_of(frame, canopen::kErrorControl);
  if (frame.remote) {
    out_.service = "guarding";
    out_.text = "node guarding request";
    return;
  }
  const auto message = canopen::parse_error_control(frame);
  if (!message) {
    out_.text = "no heartbeat of CiA 301";
    return;
  }
  if (message->boot_up) {
    out_.service = "boot-up";
    out_.text = "boot-up";
    pdos_.forget(*out_.node);
    modes_[*out_.node] = 0;
    emergency_ids_.on_boot_up(*out_.node);
    return;
  }
  const bool toggle = (frame.data[0] & 0x80U) != 0;
  out_.service = "heartbeat";
  out_.text = canopen::name(message->state);
  if (toggle) out_.text += " (answer to node guarding)";
  if (!options_.fields) return;
  fields_.member("state", canopen::name(message->state));
  fields_.member("toggle", toggle);
}

std::string FrameDecoder::name_of(const drive::Target& target) const {
  auto out = to_string(target.address);
  const auto label = options_.chinese ? target.label_zh() : target.label();
  if (!label.empty()) (out += ' ') += label;
  return out;
}

void FrameDecoder::decode_sdo(const can::Frame& frame) {
  const auto asked = node_of(frame, canopen::kSdoRequest);
  const auto node = asked ? *asked : *node_of(frame, canopen::kSdoAnswer);
  auto& channel = channels_[node];
  const auto step = asked ? channel.on_client_frame(frame) : channel.on_server_frame(frame);
  out_.service = "sdo";
  out_.node = node;
  drive::Target target;
  if (step.object) target = drive::target_at(options_.profile, *step.object);
  out_.text = step_text(step, step.object ? name_of(target) : "of a transfer begun before",
                        step.kind == Step::abort ? abort_words_of(step) : std::string());
  if (step.object) out_.objects.push_back(*step.object);
  if (options_.fields) add_sdo_fields(step, target);
  if (step.object && step.data) add_sdo_value(*step.data, target);
  if (step.announced) out_.text += fmt::format(", {} bytes", *step.announced);
  if (options_.fields) end_sdo_fields(step);
  learn(step);
  learn_mode(step);
}

std::string FrameDecoder::abort_words_of(const SdoStep& step) const {
  return show::abort_words(options_.profile, options_.chinese, step.abort_code);
}

void FrameDecoder::add_sdo_fields(const canopen::SdoStep& step, const drive::Target& target) {
  fields_.member("step", step_name(step.kind));
  fields_.member("from", step.from_client ? "master" : "node");
  if (step.block) fields_.member("block", true);
  if (!step.object) return;
  fields_.member("index", step.object->index);
  fields_.member("sub", step.object->sub);
  fields_.text_or_null("name", target.label());
}

/// What stands behind the value.
void FrameDecoder::end_sdo_fields(const canopen::SdoStep& step) {
  if (step.announced) fields_.member("announced", *step.announced);
  if (step.kind != Step::abort) return;
  fields_.key("abort");
  fields_.begin_record();
  fields_.member("code", fmt::format("0x{:08X}", step.abort_code));
  fields_.member("text", abort_words_of(step));
  fields_.end_record();
}

void FrameDecoder::add_sdo_value(const Bytes& data, const drive::Target& target) {
  const auto value = show::decode_value({*out_.node, target, {}, Bytes{}}, data);
  out_.text += " = " + value.text;
  const auto& label = options_.chinese && !value.label_zh.is_null() ? value.label_zh : value.label;
  if (const auto* words = std::get_if<std::string>(&label.data())) out_.text += " " + *words;
  if (const auto words = words_of(data, target.address); !words.empty()) out_.text += " " + words;
  if (!options_.fields) return;
  fields_.member("value", value.value);
  fields_.text_or_null("unit", value.unit);
  fields_.member("label", value.label);
  fields_.member("bytes", to_hex(data));
}

/// What controlword and statusword say; empty for every other object.
std::string FrameDecoder::words_of(const Bytes& data, ObjectAddress object) const {
  if (data.size() != 2) return {};
  const auto word = static_cast<std::uint16_t>(load_le(data));
  const auto mode = modes_[*out_.node];
  if (object == objects::kStatusword) return drive::statusword_words(word, mode, options_.chinese);
  return object == objects::kControlword ? drive::controlword_words(word, mode) : std::string();
}

}  // namespace servoctl::traffic
