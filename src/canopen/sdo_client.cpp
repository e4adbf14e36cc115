#include "canopen/sdo_client.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {
namespace {

std::uint8_t command_of(const can::Frame& frame) { return frame.data[0] & 0xE0U; }

}  // namespace

void SdoClient::start_upload(ObjectAddress object, TimePoint now, Transfer transfer, std::size_t size,
                             bool again) {
  core_.begin(again);
  is_shadowed_ = core_.is_shadowed(object);
  object_ = object;
  size_ = size;
  transfer_ = transfer;
  foreign_request_ = false;
  kind_ = SdoAnswerKind::read;
  begin(now);
}

/// Where a node's answers come twice, the second one comes before the next request.
void SdoClient::begin(TimePoint now) {
  const auto due = core_.copy_due(kind_, object_, now);
  if (!due) return begin_wanted(now);
  boot_up_ = false;
  state_ = State::copy;
  core_.wait_until(*due);
}

void SdoClient::begin_wanted(TimePoint now) {
  if (kind_ == SdoAnswerKind::write) return begin_wanted_download(now);
  if (!core_.is_clear(object_)) return check(now);
  begin_wanted_upload(now);
}

void SdoClient::begin_wanted_upload(TimePoint now) {
  if (transfer_ == Transfer::block || transfer_ == Transfer::domain) return begin_block_upload(now);
  begin_upload(now);
}

void SdoClient::begin_upload(TimePoint now) {
  data_.clear();
  announced_.reset();
  toggle_ = 0;
  core_.ask_read(object_, now);
  send(sdo_frame(kSdoRequest + node_, 0x40, object_), State::upload_initiate, now);
}

void SdoClient::start_download(ObjectAddress object, Bytes data, TimePoint now, Transfer transfer) {
  core_.begin(false);
  is_shadowed_ = core_.is_shadowed(object);
  object_ = object;
  transfer_ = transfer;
  foreign_request_ = false;
  data_ = std::move(data);
  announced_ = data_.size();
  kind_ = SdoAnswerKind::write;
  begin(now);
}

void SdoClient::begin_wanted_download(TimePoint now) {
  const bool by_size = transfer_ == Transfer::automatic || transfer_ == Transfer::domain;
  if (transfer_ == Transfer::block || (by_size && data_.size() > kBlockWorthwhile))
    return begin_block_download(now);
  begin_download(transfer_ == Transfer::expedited || (by_size && !data_.empty() && data_.size() <= 4), now);
}

void SdoClient::begin_download(bool expedited, TimePoint now) {
  offset_ = 0;
  toggle_ = 0;
  core_.ask_write(object_, data_, now);
  const auto size = static_cast<std::uint32_t>(data_.size());
  if (expedited) {
    const auto command = static_cast<std::uint8_t>(0x23U | (4U - size) << 2U);
    offset_ = size;
    send(sdo_frame(kSdoRequest + node_, command, object_, static_cast<std::uint32_t>(load_le(data_))),
         State::download_initiate, now);
    return;
  }
  send(sdo_frame(kSdoRequest + node_, 0x21, object_, size), State::download_initiate, now);
}

void SdoClient::on_frame(const can::Frame& frame, TimePoint now) {
  if (frame.extended || frame.remote || frame.error) return;
  if (frame.id == kSdoRequest + node_) return on_foreign_request(frame, now);
  if (frame.id == kErrorControl + node_ && frame.size == 1 && frame.data[0] == 0) return on_boot_up(now);
  if (frame.id != kSdoAnswer + node_) return;
  const bool in_block = state_ == State::block_upload_data;
  const auto whole = whole_sdo_answer(frame, in_block);
  if (!whole) {
    if (state_ != State::idle)
      abort(sdo_abort::kCommand, Errc::protocol,
            formatted("its answer has {} bytes instead of 8", frame.size));
    return;
  }
  if (frame.size != whole->size) note(SdoHabit::short_answer);
  on_answer(with_object(*whole), now);
}

/// Some servers put no object into an abort. It is for the request that is open, if there is only one.
can::Frame SdoClient::with_object(const can::Frame& answer) {
  auto out = answer;
  const bool waits = state_ != State::idle && state_ != State::copy && state_ != State::block_upload_data;
  const bool nameless = answer.data[0] == kSdoAbortCommand && sdo_object(answer) == ObjectAddress{};
  if (!waits || !nameless || foreign_request_ || core_.open().has_older()) return out;
  const auto asked = state_ == State::resync ? check_ : object_;
  if (asked != ObjectAddress{}) note(SdoHabit::abort_without_object);
  out.data[1] = static_cast<std::uint8_t>(asked.index);
  out.data[2] = static_cast<std::uint8_t>(asked.index >> 8U);
  out.data[3] = asked.sub;
  return out;
}

void SdoClient::on_answer(const can::Frame& frame, TimePoint now) {
  const bool again = std::exchange(last_answer_, frame) == frame;
  if (is_anonymous()) core_.open().pass_copy();
  // Toggle bits alternate: what is equal is one answer that came twice.
  if (state_ == State::upload_segment || state_ == State::download_segment) {
    if (again) {
      core_.note(frame.data[0], object_, 0);
      return core_.open().note_copy();
    }
    core_.forget_noted();
  }
  if (!is_anonymous() && !is_first_answer(frame, now)) return;
  if (frame.data[0] == kSdoAbortCommand) return on_abort(frame, now);
  switch (state_) {
    case State::idle:
    case State::copy:
    case State::resync: break;
    case State::upload_initiate: return on_upload_initiate(frame, now);
    case State::upload_segment: return on_upload_segment(frame, now);
    case State::download_initiate: return on_download_initiate(frame, now);
    case State::download_segment: return on_download_segment(frame, now);
    case State::block_upload_initiate: return on_block_upload_initiate(frame, now);
    case State::block_upload_data: return on_block_upload_data(frame, now);
    case State::block_upload_end: return on_block_upload_end(frame, now);
    case State::block_download_initiate: return on_block_download_initiate(frame, now);
    case State::block_download_data: return on_block_download_data(frame, now);
    case State::block_download_end: return on_block_download_end(frame, now);
  }
}

void SdoClient::on_abort(const can::Frame& frame, TimePoint now) {
  const auto code = sdo_data(frame);
  if (sdo_object(frame) != object_) return core_.note(frame.data[0], sdo_object(frame), code);
  const bool may_fall_back = transfer_ != Transfer::block && refuses_block_transfer(code);
  if (state_ == State::block_upload_initiate && may_fall_back) return begin_upload(now);
  if (state_ == State::block_download_initiate && may_fall_back) return begin_download(false, now);
  const bool reads = state_ == State::upload_initiate || state_ == State::block_upload_initiate;
  auto refused = error(Errc::sdo_abort, message("refused: {} (abort 0x{:08X})", sdo_abort_text(code), code),
                       reads ? sdo_abort_hint(code) : sdo_abort_hint(code, object_));
  refused.abort_code = code;
  finish(fail(std::move(refused)));
}

void SdoClient::end_by_boot_up() {
  finish(fail(error(Errc::timeout, "the node restarted (boot-up) in the middle of the transfer",
                    "did it lose its supply, or did somebody reset it? Try again when it has started")));
}

void SdoClient::on_upload_initiate(const can::Frame& frame, TimePoint now) {
  if (command_of(frame) != 0x40) {
    abort(sdo_abort::kCommand, Errc::protocol,
          formatted("it answered a read with command 0x{:02X}", frame.data[0]));
    return;
  }
  const bool expedited = (frame.data[0] & 0x02U) != 0;
  const bool size_indicated = (frame.data[0] & 0x01U) != 0;
  if (expedited) {
    const std::size_t known = size_ == 0 ? 4 : std::min<std::size_t>(size_, 4);
    std::size_t size = size_indicated ? 4U - (frame.data[0] >> 2U & 0x03U) : known;
    // Where the sign bit of the smaller one is set, the four bytes may be another number.
    if (size == 4 && known < size && (sdo_data(frame) >> (known * 8 - 1)) == 0) {
      if (size_indicated) note(SdoHabit::always_four_bytes);
      size = known;
    }
    finish(Bytes(frame.data.begin() + 4, frame.data.begin() + 4 + static_cast<std::ptrdiff_t>(size)));
    return;
  }
  if (transfer_ == Transfer::expedited) {
    abort(sdo_abort::kUnsupportedAccess, Errc::protocol, "it does not answer this read in one frame",
          "leave --transfer expedited out");
    return;
  }
  if (size_indicated) announced_ = sdo_data(frame);
  if (announced_ > kMaxSdoUpload) {
    abort(sdo_abort::kOutOfMemory, Errc::protocol,
          formatted("it announces {} bytes for this object", *announced_));
    return;
  }
  if (announced_) data_.reserve(*announced_);
  request_segment(now);
}

/// Some servers announce the room of a text and send the text. Of more than that a part may be missing.
bool SdoClient::is_short() const {
  constexpr std::size_t kRoomOfText = 64;
  return announced_.value_or(0) > kRoomOfText && data_.size() < *announced_;
}

void SdoClient::on_upload_segment(const can::Frame& frame, TimePoint now) {
  if (command_of(frame) == 0x40 && sdo_object(frame) == object_ && data_.empty())
    return;  // The first answer, twice.
  if (command_of(frame) != 0x00) {
    abort(sdo_abort::kCommand, Errc::protocol,
          formatted("it answered a segment request with command 0x{:02X}", frame.data[0]));
    return;
  }
  if ((frame.data[0] & kToggleBit) != toggle_) {
    abort(sdo_abort::kToggle, Errc::protocol, "the toggle bit of its segment did not alternate");
    return;
  }
  const auto size = 7 - (frame.data[0] >> 1U & 0x07);
  data_.insert(data_.end(), frame.data.begin() + 1, frame.data.begin() + 1 + size);
  const bool last = (frame.data[0] & 0x01U) != 0;
  if (size == 0 && !last) {  // It could go on so without end.
    abort(sdo_abort::kLength, Errc::protocol, "it sent a segment without data that is not the last");
    return;
  }
  if (data_.size() > announced_.value_or(kMaxSdoUpload)) {
    abort(sdo_abort::kLength, Errc::protocol,
          formatted("it announced {} bytes and sent {}", announced_.value_or(kMaxSdoUpload), data_.size()));
    return;
  }
  if (last && is_short()) {
    abort(sdo_abort::kLength, Errc::protocol,
          formatted("it announced {} bytes and sent {}", *announced_, data_.size()));
    return;
  }
  if (last && announced_ && data_.size() < *announced_) note(SdoHabit::announced_more);
  if (last) return finish(std::exchange(data_, {}));
  toggle_ ^= kToggleBit;
  request_segment(now);
}

void SdoClient::on_download_initiate(const can::Frame& frame, TimePoint now) {
  if (command_of(frame) != 0x60) {
    abort(sdo_abort::kCommand, Errc::protocol,
          formatted("it answered a write with command 0x{:02X}", frame.data[0]));
    return;
  }
  if (offset_ == data_.size() && !data_.empty()) return finish(Bytes{});
  send_segment(now);
}

void SdoClient::on_download_segment(const can::Frame& frame, TimePoint now) {
  if (command_of(frame) == 0x60 && sdo_object(frame) == object_ && offset_ <= 7)
    return;  // The first answer, twice.
  if (command_of(frame) != 0x20) {
    abort(sdo_abort::kCommand, Errc::protocol,
          formatted("it answered a segment with command 0x{:02X}", frame.data[0]));
    return;
  }
  if ((frame.data[0] & kToggleBit) != toggle_) {
    abort(sdo_abort::kToggle, Errc::protocol, "the toggle bit of its answer did not alternate");
    return;
  }
  if (offset_ == data_.size()) return finish(Bytes{});
  toggle_ ^= kToggleBit;
  send_segment(now);
}

void SdoClient::request_segment(TimePoint now) {
  send(sdo_segment(kSdoRequest + node_, static_cast<std::uint8_t>(0x60U | toggle_)), State::upload_segment,
       now);
}

void SdoClient::send_segment(TimePoint now) {
  const std::size_t size = std::min<std::size_t>(7, data_.size() - offset_);
  const bool last = offset_ + size == data_.size();
  auto frame = sdo_segment(kSdoRequest + node_,
                           static_cast<std::uint8_t>(toggle_ | (7U - size) << 1U | (last ? 1U : 0U)));
  std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(offset_), size, frame.data.begin() + 1);
  offset_ += size;
  send(frame, State::download_segment, now);
}

void SdoClient::send(const can::Frame& frame, State next, TimePoint now) {
  tx_ = frame;
  boot_up_ = false;
  state_ = next;
  core_.wait(now);
}

void SdoClient::abort(std::uint32_t code, Errc errc, std::string why, std::string hint) {
  const auto asked = state_ == State::resync ? check_ : object_;
  finish(fail(error(errc, std::move(why), std::move(hint))));
  tx_ = sdo_frame(kSdoRequest + node_, kSdoAbortCommand, asked, code);
}

void SdoClient::finish(Result<Bytes> result) {
  // Its later messages were answered: the answer to its first one has come.
  if (result && is_anonymous()) core_.open().forget_own();
  state_ = State::idle;
  boot_up_ = false;
  core_.finish(std::move(result));
}

Error SdoClient::error(Errc code, Message message, Message hint) const {
  if (foreign_request_ && hint.empty()) hint = "another master is also using SDO with this node";
  return drive_error(code, node_, object_, message, std::move(hint));
}

std::size_t SdoClient::transferred() const {
  if (state_ == State::block_upload_data || state_ == State::block_upload_end) return receiver_.received();
  if (state_ == State::block_download_data || state_ == State::block_download_end)
    return sender_.acknowledged();
  return state_ == State::download_segment ? offset_ : data_.size();
}

std::optional<can::Frame> SdoClient::take_frame() {
  if (tx_ || state_ != State::block_download_data)
    return std::exchange(tx_, std::exchange(following_, std::nullopt));
  const auto segment = sender_.next_segment();
  if (!segment) return std::nullopt;
  if (sender_.is_waiting()) core_.wait_until(TimePoint::min());
  return can::make_frame(kSdoRequest + node_, *segment);
}
std::optional<Result<Bytes>> SdoClient::take_result() { return core_.take_end(); }

}  // namespace servoctl::canopen
