#include "traffic/frame_decoder.hpp"

#include <algorithm>
#include <chrono>
#include <span>
#include <utility>

#include "base/format.hpp"
#include "can/controller_report.hpp"
#include "can/error_frame.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/error_control.hpp"
#include "canopen/lss.hpp"
#include "canopen/nmt.hpp"
#include "drive/assumed_unit.hpp"
#include "drive/standard_objects.hpp"
#include "drive/word_bits.hpp"
#include "report/told.hpp"
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
  return formatted("{:04}-{:02}-{:02} {:02}:{:02}:{:02}.{:03}", static_cast<int>(date.year()),
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
    const auto error = can::parse_wire_error(frame);
    out_.service = "controller";
    out_.text = word(report  ? can::text(*report)
                     : error ? can::text(*error)
                             : "error frame, or report of the controller");
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
    out_.text = word("29-bit identifier");
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
  out_.text =
      report::told(options_.chinese, "identifier {}, {} bytes", formatted("0x{:03X}", frame.id), frame.size);
}

void FrameDecoder::decode_nmt(const can::Frame& frame) {
  out_.service = "nmt";
  const auto message = canopen::parse_nmt(frame);
  if (options_.fields)
    fields_.member("command", message ? std::optional(canopen::name(message->command)) : std::nullopt);
  if (!message) {
    out_.text = word("no NMT command of CiA 301");
    return;
  }
  if (message->node != 0) out_.node = message->node;
  const auto* const format = message->node == 0 ? "NMT {}, all nodes" : "NMT {}";
  out_.text = report::told(options_.chinese, format, canopen::name(message->command));
}

void FrameDecoder::decode_sync(const can::Frame& frame) {
  out_.service = "sync";
  out_.text = "SYNC";
  const auto counter = frame.remote || frame.size == 0 ? std::nullopt : std::optional(frame.data[0]);
  if (counter) out_.text += formatted(" {}", *counter);
  if (options_.fields) fields_.member("counter", counter);
}

void FrameDecoder::decode_time(const can::Frame& frame) {
  out_.service = "time";
  const bool right = !frame.remote && frame.size >= 6;
  const auto time = right ? time_of_day(frame.payload()) : std::string();
  out_.text = right ? "TIME " + time : std::string(word("no TIME of CiA 301"));
  if (options_.fields) fields_.text_or_null("tells", time);
}

void FrameDecoder::decode_emergency(const canopen::Emergency& emergency) {
  out_.service = "emcy";
  out_.node = emergency.node;
  out_.text = sentence(
      show::event_text({{}, emergency.node, emergency}, family_of(emergency.node), options_.chinese));
  if (!options_.fields) return;
  fields_.member("code", emergency.code);
  fields_.member("error_register", emergency.error_register);
  constexpr std::size_t kHead = 3;
  const auto vendor = std::span(emergency.vendor).first(std::max<std::size_t>(emergency.size, kHead) - kHead);
  fields_.text_or_null("vendor", to_hex(vendor));
}

void FrameDecoder::decode_lss(const can::Frame& frame) {
  out_.service = "lss";
  out_.text = sentence(lss_text(frame));
  if (options_.fields) fields_.member("from", frame.id == canopen::kLssRequest ? "master" : "slave");
}

/// By its mapping, or by the pre-defined connection set alone.
void FrameDecoder::decode_pdo(const can::Frame& frame, std::uint8_t node, const show::PdoView* view) {
  out_.service = "pdo";
  out_.node = node;
  if (frame.remote || view == nullptr) leave_out({"pdo", "mapping", "values"});
  if (frame.remote) {
    out_.text =
        report::told(options_.chinese, "PDO {} requested by a remote frame", formatted("0x{:03X}", frame.id));
    return;
  }
  const auto data = frame.payload();
  if (view == nullptr) {
    const bool receive = (frame.id & 0x80U) == 0;
    const auto number = static_cast<std::uint16_t>((frame.id - (receive ? 0x180U : 0x080U)) >> 8U);
    const auto direction = receive ? canopen::PdoDirection::receive : canopen::PdoDirection::transmit;
    out_.text = canopen::name(direction, number) + " " +
                report::told(options_.chinese, "{} (mapping not known)", to_hex(data));
    return;
  }
  out_.text += view->name;
  const bool assumed = view->assumed && shows_values(*view, data);
  if (assumed) out_.text += word(" (factory mapping)");
  out_.text += ' ';
  modes_.on_pdo(*view, data);
  show::append_values(*view, data, options_.chinese, out_.text, modes_.of(node));
  for (const auto& field : view->fields) out_.objects.push_back(field.entry.object);
  if (!options_.fields) return;
  fields_.member("pdo", view->name);
  fields_.text_or_null("mapping", assumed ? "factory" : "");
  fields_.key("values");
  show::write_values(*view, data, fields_, modes_.of(node));
}

void FrameDecoder::decode_error_control(const can::Frame& frame) {
  out_.node = node_of(frame, canopen::kErrorControl);
  if (frame.remote) {
    out_.service = "guarding";
    out_.text = word("node guarding request");
    asked_.set(*out_.node);
    return;
  }
  const auto message = canopen::parse_error_control(frame);
  if (!message) {
    out_.text = word("no heartbeat of CiA 301");
    return;
  }
  if (message->boot_up) {
    out_.service = "boot-up";
    out_.text = word("boot-up");
    pdos_.forget(*out_.node);
    modes_.forget(*out_.node);
    emergency_ids_.on_boot_up(*out_.node);
    return;
  }
  const bool toggle = (frame.data[0] & 0x80U) != 0;
  const bool answers = toggle || asked_.test(*out_.node);
  asked_.reset(*out_.node);
  out_.service = "heartbeat";
  const auto state = word(canopen::name(message->state));
  out_.text =
      answers ? report::told(options_.chinese, "{} (answer to node guarding)", state) : std::string(state);
  if (!options_.fields) return;
  fields_.member("state", canopen::name(message->state));
  fields_.member("toggle", toggle);
}

std::string_view FrameDecoder::word(std::string_view english) const {
  return options_.chinese ? report::chinese_word(english) : english;
}

/// Of frames that seldom come: it takes its time.
std::string FrameDecoder::sentence(const std::string& english) const {
  return options_.chinese ? report::in_chinese(english) : english;
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
  const auto* family = family_of(node);
  if (step.object) target = drive::target_at(family != nullptr ? family : options_.standard, *step.object);
  out_.text = step_text(step, step.object ? name_of(target) : std::string(word("of a transfer begun before")),
                        step.kind == Step::abort ? std::string(word(abort_words_of(step))) : std::string(),
                        options_.chinese);
  if (step.object) out_.objects.push_back(*step.object);
  if (options_.fields) add_sdo_fields(step, target);
  add_sdo_value(step, target);
  if (step.announced) out_.text += report::told(options_.chinese, ", {} bytes", *step.announced);
  if (frame.size != frame.data.size() && !frame.remote) tell_short_sdo(frame, asked.has_value());
  if (options_.fields) end_sdo_fields(step);
  learn(step);
  modes_.on_sdo(*out_.node, step);
}

std::string FrameDecoder::abort_words_of(const SdoStep& step) const {
  return show::abort_words(family_of(*out_.node), options_.chinese, step.abort_code);
}

/// Keys of the service that this frame does not tell.
void FrameDecoder::leave_out(std::initializer_list<std::string_view> keys) {
  if (!options_.fields) return;
  for (const auto key : keys) {
    fields_.key(key);
    fields_.null();
  }
}

void FrameDecoder::add_sdo_fields(const canopen::SdoStep& step, const drive::Target& target) {
  fields_.member("step", step_name(step.kind));
  fields_.member("from", step.from_client ? "master" : "node");
  fields_.member("block", step.block);
  fields_.member("index", step.object ? std::optional(step.object->index) : std::nullopt);
  fields_.member("sub", step.object ? std::optional(step.object->sub) : std::nullopt);
  fields_.text_or_null("name", target.label());
}

/// What stands behind the value.
void FrameDecoder::end_sdo_fields(const canopen::SdoStep& step) {
  fields_.member("announced", step.announced);
  fields_.key("abort");
  if (step.kind != Step::abort) return fields_.null();
  fields_.begin_record();
  fields_.member("code", formatted("0x{:08X}", step.abort_code));
  fields_.member("text", abort_words_of(step));
  fields_.end_record();
}

void FrameDecoder::add_sdo_value(const canopen::SdoStep& step, const drive::Target& target) {
  if (!step.object || !step.data) return leave_out({"value", "unit", "label", "bytes"});
  const auto* family = family_of(*out_.node);
  show::Reading reading{*out_.node, target, {}, Bytes{}};
  reading.family = family != nullptr ? family : options_.standard;
  // Some servers answer with four bytes for whatever is smaller, as canopen::SdoHabit says.
  auto data = *step.data;
  const auto size = show::size_of(reading);
  if (size != 0 && size < 4 && data.size() == 4 && load_le(data) >> (size * 8 - 1) == 0) data.resize(size);
  if ((family == nullptr || drive::leaves_units_open(*family)) && target.entry != nullptr)
    show::leave_units_open(reading);
  const auto value = show::decode_value(reading, data);
  out_.text += " = " + value.text;
  // The mode that was heard tells more than the value alone.
  if (const auto words = words_of(data, target.address, options_.chinese); !words.empty())
    out_.text += " " + words;
  else if (const auto label = show::label_text(value, options_.chinese); !label.empty())
    out_.text += " " + label;
  if (!options_.fields) return;
  fields_.member("value", value.value);
  fields_.text_or_null("unit", value.unit);
  const auto words = words_of(data, target.address, false);
  fields_.member("label", words.empty() ? value.label : report::Value(words));
  fields_.member("bytes", to_hex(*step.data));
}

/// What controlword and statusword say; empty for every other object.
std::string FrameDecoder::words_of(const Bytes& data, ObjectAddress object, bool chinese) const {
  if (data.size() != 2) return {};
  const auto word = static_cast<std::uint16_t>(load_le(data));
  const auto mode = modes_.of(*out_.node);
  const auto language = chinese ? report::chinese_word : nullptr;
  if (object == objects::kStatusword) return drive::statusword_words(word, mode, language);
  return object == objects::kControlword ? drive::controlword_words(word, mode, language) : std::string();
}

}  // namespace servoctl::traffic
