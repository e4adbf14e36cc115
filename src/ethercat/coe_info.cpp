#include "ethercat/coe_info.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"
#include "ethercat/coe_message.hpp"
#include "ethercat/mailbox_message.hpp"
#include "ethercat/words.hpp"

namespace servoctl::ethercat {
namespace {

constexpr std::uint8_t kAskList = 1;
constexpr std::uint8_t kAskObject = 3;
constexpr std::uint8_t kAskEntry = 5;
constexpr std::uint8_t kError = 7;
constexpr std::uint8_t kIncomplete = 0x80;
constexpr std::size_t kInfoHeader = 4;
constexpr std::size_t kData = kCoeHeader + kInfoHeader;
/// 65536 objects are all there can be; no name is longer.
constexpr std::size_t kMostBytes = 2 + 2 * 65536;
/// Of an entry: access rights, category, and whether it can be mapped.
constexpr std::uint8_t kValueInfo = 0x07;
constexpr std::uint8_t kHasUnit = 0x08;
constexpr std::uint8_t kHasValues = 0x70;  ///< Default, lowest and highest value, each as long as the entry.

constexpr std::string_view kNoInfo =
    "many drives do not provide their dictionary: name a family with -d, or the ESI file of the drive, -d FILE.xml";

std::string text(ByteSpan bytes) {
  // Some put zeros behind the name.
  return {bytes.begin(), std::find(bytes.begin(), bytes.end(), std::uint8_t{0})};
}

}  // namespace

void CoeInfo::start_list(ObjectList list, TimePoint now) {
  object_ = {};
  ask(kAskList, store_le(static_cast<std::uint8_t>(list), 2), now);
}

void CoeInfo::start_object(std::uint16_t index, TimePoint now) {
  object_ = {index, 0};
  ask(kAskObject, store_le(index, 2), now);
}

void CoeInfo::start_entry(ObjectAddress object, TimePoint now) {
  object_ = object;
  const std::array<std::uint8_t, 4> what{static_cast<std::uint8_t>(object.index),
                                         static_cast<std::uint8_t>(object.index >> 8U), object.sub,
                                         kValueInfo};
  ask(kAskEntry, what, now);
}

void CoeInfo::ask(std::uint8_t opcode, ByteSpan what, TimePoint now) {
  asked_ = opcode;
  // The value info that comes back is what there is, not what was asked for.
  question_.assign(what.begin(),
                   what.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(what.size(), 3)));
  data_.clear();
  left_.reset();
  Bytes message(kData);
  message[1] = static_cast<std::uint8_t>(static_cast<unsigned>(CoeService::sdo_info) << 4U);
  message[2] = opcode;
  message.insert(message.end(), what.begin(), what.end());
  tx_ = std::move(message);
  deadline_ = now + timeout_;
}

void CoeInfo::on_message(ByteSpan message, TimePoint now) {
  if (asked_ == 0) return;
  if (coe_service(message) == CoeService::sdo_response && message.size() >= kCoeHeader + kSdoHeader &&
      message[kCoeHeader] == 0x80)
    return on_error(message.subspan(kCoeHeader + 4));
  if (coe_service(message) != CoeService::sdo_info || message.size() < kData) return;
  const auto opcode = static_cast<std::uint8_t>(message[kCoeHeader] & ~kIncomplete);
  const auto left = word_at(message, kCoeHeader + 2);
  const auto data = message.subspan(kData);
  if (opcode == kError) return on_error(data);
  if (opcode != asked_ + 1) return;
  if (!left_) {
    // What comes late for an earlier question is no answer.
    if (data.size() < question_.size() || !std::equal(question_.begin(), question_.end(), data.begin()))
      return;
  } else if (!follows(left)) {
    return;
  }
  take_in(data);
  if (asked_ == 0) return;
  left_ = left;
  deadline_ = now + timeout_;
  if ((message[kCoeHeader] & kIncomplete) == 0 || left == 0) complete();
}

bool CoeInfo::follows(std::uint16_t left) {
  if (left + 1 == *left_) return true;
  finish(fail(error(Errc::protocol, message("part {} from the end of its answer is missing", *left_ - 1),
                    "try again; if it persists, frames are being lost")));
  return false;
}

void CoeInfo::take_in(ByteSpan data) {
  data_.insert(data_.end(), data.begin(), data.end());
  if (data_.size() > kMostBytes) finish(fail(error(Errc::protocol, "its answer does not end", "")));
}

void CoeInfo::on_error(ByteSpan data) {
  if (data.size() < 4)
    return finish(fail(error(Errc::protocol, "refused without a code", std::string(kNoInfo))));
  const auto code = dword_at(data, 0);
  auto refused =
      error(Errc::sdo_abort, message("refused: {} (abort 0x{:08X})", canopen::sdo_abort_text(code), code),
            asked_ == kAskList ? std::string(kNoInfo) : canopen::sdo_abort_hint(code));
  refused.abort_code = code;
  finish(fail(std::move(refused)));
}

void CoeInfo::complete() {
  switch (asked_) {
    case kAskList: return complete_list();
    case kAskObject: return complete_object();
    default: return complete_entry();
  }
}

void CoeInfo::complete_list() {
  std::vector<std::uint16_t> out;
  for (std::size_t at = 2; at + 2 <= data_.size(); at += 2) out.push_back(word_at(data_, at));
  finish(std::move(out));
}

void CoeInfo::complete_object() {
  const ByteSpan data = data_;
  if (data.size() < 6) return finish(fail(error(Errc::protocol, "it is too short", "")));
  CoeObject out;
  out.index = object_.index;
  out.data_type = word_at(data, 2);
  out.max_sub = data[4];
  out.code = data[5];
  out.name = text(data.subspan(6));
  finish(std::move(out));
}

void CoeInfo::complete_entry() {
  const ByteSpan data = data_;
  if (data.size() < 10) return finish(fail(error(Errc::protocol, "it is too short", "")));
  CoeEntry out;
  out.object = object_;
  out.data_type = word_at(data, 4);
  out.bits = word_at(data, 6);
  out.access = word_at(data, 8);
  std::size_t name = 10;
  if ((data[3] & kHasUnit) != 0) name += 2;
  for (unsigned bit = 0x10; (bit & kHasValues) != 0; bit <<= 1U)
    if ((data[3] & bit) != 0) name += (out.bits + 7U) / 8U;
  out.name = text(data.subspan(std::min(name, data.size())));
  finish(std::move(out));
}

void CoeInfo::on_refusal(std::uint16_t detail) {
  if (asked_ == 0) return;
  finish(fail(error(Errc::protocol,
                    message("its mailbox refuses the request: {} (mailbox error {:04X}h)",
                            mailbox_error_text(detail), detail),
                    std::string(kNoInfo))));
}

void CoeInfo::on_failure(Errc code, std::string what, std::string hint) {
  if (asked_ == 0) return;
  finish(fail(error(code, std::move(what), std::move(hint))));
}

void CoeInfo::on_time(TimePoint now) {
  if (asked_ == 0 || now < deadline_) return;
  const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(timeout_).count();
  finish(fail(error(Errc::timeout,
                    left_ ? message("its answer stopped {} parts before its end", *left_)
                          : message("no answer within {} ms", waited),
                    std::string(kNoInfo))));
}

void CoeInfo::finish(Result<Description> result) {
  asked_ = 0;
  deadline_ = kNever;
  tx_.reset();
  result_ = std::move(result);
}

Error CoeInfo::error(Errc code, Message what, Message hint) const {
  if (asked_ == kAskList)
    return drive_error(code, node_, "the list of its objects: " + what, std::move(hint));
  return drive_error(code, node_, object_, "its description: " + what, std::move(hint));
}

std::optional<Bytes> CoeInfo::take_message() { return std::exchange(tx_, std::nullopt); }
std::optional<Result<CoeInfo::Description>> CoeInfo::take_result() {
  return std::exchange(result_, std::nullopt);
}

}  // namespace servoctl::ethercat
