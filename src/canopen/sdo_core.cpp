#include "canopen/sdo_core.hpp"

#include <functional>
#include <string_view>

#include "base/format.hpp"
#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {
namespace {

constexpr ObjectAddress kDeviceType{0x1000, 0};
constexpr ObjectAddress kErrorRegister{0x1001, 0};

AnswerForm form(SdoAnswerKind kind, ObjectAddress object) {
  const auto number =
      static_cast<std::uint64_t>(kind) << 24U | std::uint64_t{object.index} << 8U | object.sub;
  return {0, number};
}

std::uint64_t value_of(ByteSpan data) { return std::hash<std::string_view>()(as_text(data)); }

}  // namespace

SdoAnswerKind sdo_answer_kind(std::uint8_t command) {
  if (command == kSdoAbortCommand) return SdoAnswerKind::abort;
  const unsigned specifier = command & 0xE0U;
  if (specifier == 0x40 || (specifier == 0xC0 && (command & 0x01U) == 0)) return SdoAnswerKind::read;
  if (specifier == 0x60 || (specifier == 0xA0 && (command & 0x03U) == 0)) return SdoAnswerKind::write;
  return SdoAnswerKind::none;
}

SdoAnswerKind sdo_request_kind(std::uint8_t command) {
  if (command == kSdoAbortCommand) return SdoAnswerKind::abort;
  const unsigned specifier = command & 0xE0U;
  if (specifier == 0x40 || (specifier == 0xA0 && (command & 0x03U) == 0)) return SdoAnswerKind::read;
  if (specifier == 0x20 || (specifier == 0xC0 && (command & 0x01U) == 0)) return SdoAnswerKind::write;
  return SdoAnswerKind::none;
}

void SdoCore::begin(bool again) {
  TransferCore::begin(again);
  if (!again) heard_.reset();
}

void SdoCore::ask_read(ObjectAddress object, TimePoint now) {
  open().ask(form(SdoAnswerKind::read, object), std::nullopt, now);
}

void SdoCore::ask_write(ObjectAddress object, ByteSpan data, TimePoint now) {
  open().ask(form(SdoAnswerKind::write, object), value_of(data), now);
}

std::optional<TimePoint> SdoCore::copy_due(SdoAnswerKind kind, ObjectAddress object, TimePoint now) const {
  return open().copy_due(form(kind, object), now);
}

void SdoCore::overhear(std::uint8_t command, ObjectAddress object, ByteSpan data, TimePoint now) {
  const auto kind = sdo_request_kind(command);
  const bool writes = kind == SdoAnswerKind::write;
  if (kind == SdoAnswerKind::read || writes)
    open().overhear(form(kind, object), writes ? std::optional(value_of(data)) : std::nullopt, now);
}

SdoCore::Fit SdoCore::settle(std::uint8_t command, ObjectAddress object, TimePoint now, bool awaited) {
  const auto kind = sdo_answer_kind(command);
  if (kind == SdoAnswerKind::none) return Fit::none;
  if (kind != SdoAnswerKind::abort) return open().settle(form(kind, object), now, awaited);
  return open().settle_refusal(
      [&](AnswerForm refused) {
        return refused == form(SdoAnswerKind::read, object) || refused == form(SdoAnswerKind::write, object);
      },
      now, awaited);
}

void SdoCore::settle_older(std::uint8_t command, ObjectAddress object, TimePoint now) {
  const auto kind = sdo_answer_kind(command);
  const bool is_open =
      kind == SdoAnswerKind::abort ? is_shadowed(object) : !open().is_clear(form(kind, object));
  if (is_open) (void)settle(command, object, now, false);
}

bool SdoCore::is_clear(ObjectAddress object) const {
  return open().is_clear(form(SdoAnswerKind::read, object));
}

bool SdoCore::awaits_read(ObjectAddress object) const {
  return open().has(form(SdoAnswerKind::read, object));
}

bool SdoCore::is_shadowed(ObjectAddress object) const {
  return !is_clear(object) || !open().is_clear(form(SdoAnswerKind::write, object));
}

SdoCore::Silence SdoCore::silence() const {
  if (heard_) {
    const auto what = sdo_answer_kind(heard_->command) == SdoAnswerKind::abort
                          ? formatted("; it aborted with 0x{:08X} and named object {}", heard_->code,
                                      to_string(heard_->object))
                          : formatted("; it answered with command 0x{:02X} for object {}", heard_->command,
                                      to_string(heard_->object));
    return {Errc::protocol, what,
            "the drive answers, but not to this request: does its firmware deviate from CiA 301, or does "
            "another master use its SDO channel?"};
  }
  const auto late = open().lateness();
  if (!late) return {};
  return {Errc::timeout, lateness_text(*late), lateness_hint(*late)};
}

ObjectAddress SdoCore::check_object(ObjectAddress wanted) {
  return wanted == kDeviceType ? kErrorRegister : kDeviceType;
}

}  // namespace servoctl::canopen
