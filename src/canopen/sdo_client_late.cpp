// Answers of the SDO client that come late, instead of the one that is waited for, or not at all.
#include <algorithm>

#include "base/format.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_client.hpp"
#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {
namespace {

/// An answer that a node had ready when it sent its boot-up comes at once; a node that has restarted has
/// none.
constexpr Duration kAnswerAfterBootUp = std::chrono::milliseconds(100);

}  // namespace

/// Whether the answers that are waited for name no object.
bool SdoClient::is_anonymous() const {
  switch (state_) {
    case State::idle:
    case State::copy:
    case State::resync:
    case State::upload_initiate:
    case State::download_initiate:
    case State::block_upload_initiate:
    case State::block_download_initiate: return false;
    default: return true;
  }
}

/// Whether the frame is to be looked at as the first answer to the present request.
bool SdoClient::is_first_answer(const can::Frame& frame, TimePoint now) {
  const auto named = sdo_object(frame);
  const auto kind = sdo_answer_kind(frame.data[0]);
  const bool awaits = state_ != State::idle && state_ != State::copy;
  // Where it repeats the refusal of an earlier request, this one stays open.
  const bool is_doubtful = is_shadowed_ && kind == SdoAnswerKind::abort && named == object_;
  const auto fit = core_.settle(frame.data[0], named, now, awaits && !is_doubtful);
  if (state_ == State::copy && !core_.copy_due(kind_, object_, now)) begin_wanted(now);
  if (!awaits) return false;
  if (state_ == State::resync) {
    if (named == check_ && fit != SdoCore::Fit::none) on_check(now);
    return false;
  }
  const bool writes = state_ == State::download_initiate && offset_ == data_.size() && !data_.empty();
  if (fit == SdoCore::Fit::late && writes && kind == SdoAnswerKind::write && named == object_) end_in_doubt();
  if (fit == SdoCore::Fit::ours && is_doubtful && writes) end_in_doubt();
  if (fit == SdoCore::Fit::ours) return named == object_ && !is_doubtful;
  if (fit == SdoCore::Fit::late) return false;
  if (kind == SdoAnswerKind::none) {
    if (named == object_) core_.open().forget_own();
    return named == object_;
  }
  if (!foreign_request_) core_.note(frame.data[0], named, sdo_data(frame));
  return false;
}

/// A server answers in the order of the requests: what it has not answered when this answer comes is lost.
void SdoClient::check(TimePoint now) {
  check_ = SdoCore::check_object(object_);
  check_answered_ = false;
  core_.ask_read(check_, now);
  send(sdo_frame(kSdoRequest + node_, 0x40, check_), State::resync, now);
}

void SdoClient::on_check(TimePoint now) {
  check_answered_ = true;
  is_shadowed_ = core_.awaits_read(check_);
  if (!is_shadowed_) return begin_wanted_upload(now);
  core_.wait_for_quiet(now);
}

/// What came may be the answer to an earlier write of the object, and that to this one may be lost.
void SdoClient::end_in_doubt() {
  finish(fail(error(Errc::timeout, "its answer may be that to an earlier write of this object",
                    "read the object: an earlier write was not answered in time")));
}

void SdoClient::on_time(TimePoint now) {
  if (state_ == State::idle || !core_.is_due(now)) return;
  if (boot_up_) return end_by_boot_up();
  if (state_ == State::copy) {
    core_.open().miss_copy();
    return begin_wanted(now);
  }
  // The last segment of a block has just been handed over: the other side's time begins now.
  if (core_.deadline() == TimePoint::min()) return core_.wait(now);
  // The end of a block was lost: an early acknowledge asks for it again.
  if (state_ == State::block_upload_data && receiver_.has_some() && !nudged_) {
    acknowledge_block(State::block_upload_data, now);
    nudged_ = true;
    return;
  }
  // It answers, and nothing that is older came.
  if (state_ == State::resync && check_answered_) {
    core_.open().forget_older();
    is_shadowed_ = false;
    return begin_wanted_upload(now);
  }
  on_silence();
}

void SdoClient::on_silence() {
  const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(core_.timeout()).count();
  const bool asked_for_block =
      state_ == State::block_upload_initiate || state_ == State::block_download_initiate;
  auto silence = core_.silence();
  if (silence.hint.empty() && asked_for_block)
    silence.hint = "if the node answers `read 0x1000`, try --transfer segmented";
  abort(sdo_abort::kTimeout, silence.code,
        formatted("no answer{} within {} ms{}", asked_for_block ? " to the block transfer request" : "",
                  waited, silence.heard),
        std::move(silence.hint));
}

void SdoClient::overhear(const can::Frame& request, TimePoint now) {
  if (request.size != 8) return;
  const auto command = request.data[0];
  const bool expedited = (command & 0xE2U) == 0x22;
  const std::size_t size = expedited ? 4U - ((command & 0x01U) != 0 ? command >> 2U & 0x03U : 0U) : 0U;
  core_.overhear(command, sdo_object(request), ByteSpan(request.data).subspan(4, size), now);
}

/// Segments carry no object: what another master asks for would be taken as ours. Before them, answers tell
/// by their object whose they are.
void SdoClient::on_foreign_request(const can::Frame& frame, TimePoint now) {
  overhear(frame, now);
  if (state_ == State::idle) return;
  foreign_request_ = true;
  if (is_anonymous())
    finish(fail(error(Errc::protocol, "another master uses its SDO channel at the same time",
                      "stop the other master, a PLC or a second tool, and try again")));
}

/// Some send it without having restarted, when 1017h is written: the answer that follows is the true one. A
/// node that has restarted answers nothing that it was asked before.
void SdoClient::on_boot_up(TimePoint now) {
  if (state_ == State::idle) return core_.open().clear();
  core_.open().forget_older();
  if (state_ == State::block_download_data) return end_by_boot_up();
  boot_up_ = true;
  core_.wait_until(std::min(core_.deadline(), now + kAnswerAfterBootUp));
}

}  // namespace servoctl::canopen
