// Answers of the CoE client that come late, instead of the one that is waited for, or not at all.
#include <chrono>
#include <utility>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_frame.hpp"
#include "ethercat/coe_client.hpp"
#include "ethercat/coe_message.hpp"

namespace servoctl::ethercat {
namespace {

using canopen::SdoAnswerKind;
using canopen::SdoCore;

constexpr std::size_t kFirstAnswer = kCoeHeader + kSdoHeader;

}  // namespace

/// Some set low bits of an abort.
std::uint8_t CoeClient::first_command(ByteSpan message) {
  const auto command = message[kCoeHeader];
  return (command & 0xE0U) == canopen::kSdoAbortCommand ? canopen::kSdoAbortCommand : command;
}

void CoeClient::on_early(ByteSpan message, TimePoint now) {
  const auto service = coe_service(message);
  if (message.size() < kFirstAnswer ||
      (service != CoeService::sdo_response && service != CoeService::sdo_request))
    return;
  core_.settle_older(first_command(message), sdo_object(message), now);
  is_shadowed_ = core_.is_shadowed(object_);
}

/// Whether the message is to be looked at as the first answer to the present request.
bool CoeClient::is_first_answer(ByteSpan message, TimePoint now) {
  if (message.size() < kFirstAnswer) return state_ != State::idle;
  const auto command = first_command(message);
  const auto named = sdo_object(message);
  const auto kind = canopen::sdo_answer_kind(command);
  // Where it repeats the refusal of an earlier request, this one stays open.
  const bool is_doubtful = is_shadowed_ && kind == SdoAnswerKind::abort && named == object_;
  const auto fit = core_.settle(command, named, now, state_ != State::idle && !is_doubtful);
  if (state_ == State::idle) return false;
  if (state_ == State::resync) {
    if (named == check_ && fit != SdoCore::Fit::none) on_check(now);
    return false;
  }
  const bool writes = state_ == State::download_initiate && offset_ == data_.size();
  if (fit == SdoCore::Fit::late && writes && kind == SdoAnswerKind::write && named == object_) end_in_doubt();
  if (fit == SdoCore::Fit::ours && is_doubtful && writes) end_in_doubt();
  if (fit == SdoCore::Fit::ours) return named == object_ && !is_doubtful;
  if (fit == SdoCore::Fit::late) return false;
  if (kind == SdoAnswerKind::none) {
    if (named == object_) core_.open().forget_own();
    return named == object_;
  }
  core_.note(command, named, sdo_data(message));
  return false;
}

void CoeClient::check(TimePoint now) {
  check_ = SdoCore::check_object(object_);
  check_answered_ = false;
  core_.ask_read(check_, now);
  send(sdo_message(0x40, check_, 0), State::resync, now);
}

void CoeClient::on_check(TimePoint now) {
  check_answered_ = true;
  is_shadowed_ = core_.awaits_read(check_);
  if (!is_shadowed_) return begin_upload(now);
  core_.wait_for_quiet(now);
}

/// What came may be the answer to an earlier write of the object, and that to this one may be lost.
void CoeClient::end_in_doubt() {
  finish(fail(error(Errc::timeout, "its answer may be that to an earlier write of this object",
                    "read the object: an earlier write was not answered in time")));
}

void CoeClient::on_time(TimePoint now) {
  if (state_ == State::idle || !core_.is_due(now)) return;
  // It answers, and nothing that is older came.
  if (state_ == State::resync && check_answered_) {
    core_.open().forget_older();
    is_shadowed_ = false;
    return begin_upload(now);
  }
  const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(core_.timeout()).count();
  auto silence = core_.silence();
  abort(canopen::sdo_abort::kTimeout, silence.code,
        formatted("no answer within {} ms{}", waited, silence.heard), std::move(silence.hint));
}

}  // namespace servoctl::ethercat
