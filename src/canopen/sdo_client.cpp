#include "canopen/sdo_client.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"
#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {
namespace {

/// An answer that a node had ready when it sent its boot-up comes at once; a node that has restarted has
/// none.
constexpr Duration kAnswerAfterBootUp = std::chrono::milliseconds(100);

std::uint8_t command_of(const can::Frame& frame) { return frame.data[0] & 0xE0U; }

}  // namespace

void SdoClient::start_upload(ObjectAddress object, TimePoint now, Transfer transfer, std::size_t size) {
  object_ = object;
  size_ = size;
  transfer_ = transfer;
  foreign_request_ = false;
  if (transfer == Transfer::block || transfer == Transfer::domain) return begin_block_upload(now);
  begin_upload(now);
}

void SdoClient::begin_upload(TimePoint now) {
  data_.clear();
  announced_.reset();
  toggle_ = 0;
  send(sdo_frame(kSdoRequest + node_, 0x40, object_), State::upload_initiate, now);
}

void SdoClient::start_download(ObjectAddress object, Bytes data, TimePoint now, Transfer transfer) {
  object_ = object;
  transfer_ = transfer;
  foreign_request_ = false;
  data_ = std::move(data);
  announced_ = data_.size();
  const bool by_size = transfer == Transfer::automatic || transfer == Transfer::domain;
  if (transfer == Transfer::block || (by_size && data_.size() > kBlockWorthwhile))
    return begin_block_download(now);
  begin_download(transfer == Transfer::expedited || (by_size && !data_.empty() && data_.size() <= 4), now);
}

void SdoClient::begin_download(bool expedited, TimePoint now) {
  offset_ = 0;
  toggle_ = 0;
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
  if (state_ == State::idle || frame.extended || frame.remote || frame.error) return;
  if (frame.id == kSdoRequest + node_) return on_foreign_request();
  if (frame.id == kErrorControl + node_ && frame.size == 1 && frame.data[0] == 0) return on_boot_up(now);
  if (frame.id != kSdoAnswer + node_) return;
  if (frame.size != 8) {
    abort(sdo_abort::kCommand, Errc::protocol,
          fmt::format("its answer has {} bytes instead of 8", frame.size));
    return;
  }
  if (frame.data[0] == kSdoAbortCommand) return on_abort(frame, now);
  switch (state_) {
    case State::idle: break;
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
  if (sdo_object(frame) != object_) return;
  const auto code = sdo_data(frame);
  const bool may_fall_back = transfer_ != Transfer::block && refuses_block_transfer(code);
  if (state_ == State::block_upload_initiate && may_fall_back) return begin_upload(now);
  if (state_ == State::block_download_initiate && may_fall_back) return begin_download(false, now);
  const bool reads = state_ == State::upload_initiate || state_ == State::block_upload_initiate;
  auto refused =
      error(Errc::sdo_abort, fmt::format("refused: {} (abort 0x{:08X})", sdo_abort_text(code), code),
            reads ? sdo_abort_hint(code) : sdo_abort_hint(code, object_));
  refused.abort_code = code;
  finish(fail(std::move(refused)));
}

/// Segments carry no object: what another master asks for would be taken as ours. Before them, answers tell
/// by their object whose they are.
void SdoClient::on_foreign_request() {
  foreign_request_ = true;
  const bool anonymous = state_ != State::upload_initiate && state_ != State::download_initiate &&
                         state_ != State::block_upload_initiate && state_ != State::block_download_initiate;
  if (anonymous)
    finish(fail(error(Errc::protocol, "another master uses its SDO channel at the same time",
                      "stop the other master, a PLC or a second tool, and try again")));
}

/// Some send it without having restarted, when 1017h is written: the answer that follows is the true one.
void SdoClient::on_boot_up(TimePoint now) {
  if (state_ == State::block_download_data) return end_by_boot_up();
  boot_up_ = true;
  deadline_ = std::min(deadline_, now + kAnswerAfterBootUp);
}

void SdoClient::end_by_boot_up() {
  finish(fail(error(Errc::timeout, "the node restarted (boot-up) in the middle of the transfer",
                    "did it lose its supply, or did somebody reset it? Try again when it has started")));
}

void SdoClient::on_upload_initiate(const can::Frame& frame, TimePoint now) {
  if (sdo_object(frame) != object_) return;
  if (command_of(frame) != 0x40) {
    abort(sdo_abort::kCommand, Errc::protocol,
          fmt::format("it answered a read with command 0x{:02X}", frame.data[0]));
    return;
  }
  const bool expedited = (frame.data[0] & 0x02U) != 0;
  const bool size_indicated = (frame.data[0] & 0x01U) != 0;
  if (expedited) {
    const std::size_t known = size_ == 0 ? 4 : std::min<std::size_t>(size_, 4);
    const std::size_t size = size_indicated ? 4U - (frame.data[0] >> 2U & 0x03U) : known;
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
          fmt::format("it announces {} bytes for this object", *announced_));
    return;
  }
  if (announced_) data_.reserve(*announced_);
  request_segment(now);
}

void SdoClient::on_upload_segment(const can::Frame& frame, TimePoint now) {
  if (command_of(frame) == 0x40 && sdo_object(frame) == object_ && data_.empty())
    return;  // The first answer, twice.
  if (command_of(frame) != 0x00) {
    abort(sdo_abort::kCommand, Errc::protocol,
          fmt::format("it answered a segment request with command 0x{:02X}", frame.data[0]));
    return;
  }
  if ((frame.data[0] & kToggleBit) != toggle_) {
    abort(sdo_abort::kToggle, Errc::protocol, "the toggle bit of its segment did not alternate");
    return;
  }
  const auto size = 7 - (frame.data[0] >> 1U & 0x07);
  data_.insert(data_.end(), frame.data.begin() + 1, frame.data.begin() + 1 + size);
  const bool last = (frame.data[0] & 0x01U) != 0;
  if (data_.size() > announced_.value_or(kMaxSdoUpload) ||
      (last && announced_ && data_.size() < *announced_)) {
    abort(sdo_abort::kLength, Errc::protocol,
          fmt::format("it announced {} bytes and sent {}", announced_.value_or(kMaxSdoUpload), data_.size()));
    return;
  }
  if (last) return finish(std::exchange(data_, {}));
  toggle_ ^= kToggleBit;
  request_segment(now);
}

void SdoClient::on_download_initiate(const can::Frame& frame, TimePoint now) {
  if (sdo_object(frame) != object_) return;
  if (command_of(frame) != 0x60) {
    abort(sdo_abort::kCommand, Errc::protocol,
          fmt::format("it answered a write with command 0x{:02X}", frame.data[0]));
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
          fmt::format("it answered a segment with command 0x{:02X}", frame.data[0]));
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

void SdoClient::on_time(TimePoint now) {
  if (state_ == State::idle || now < deadline_) return;
  if (boot_up_) return end_by_boot_up();
  // The last segment of a block has just been handed over: the other side's time begins now.
  if (deadline_ == TimePoint::min()) {
    deadline_ = now + timeout_;
    return;
  }
  // The end of a block was lost: an early acknowledge asks for it again.
  if (state_ == State::block_upload_data && receiver_.has_some() && !nudged_) {
    acknowledge_block(State::block_upload_data, now);
    nudged_ = true;
    return;
  }
  const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(timeout_).count();
  const bool asked_for_block =
      state_ == State::block_upload_initiate || state_ == State::block_download_initiate;
  abort(sdo_abort::kTimeout, Errc::timeout,
        fmt::format("no answer{} within {} ms", asked_for_block ? " to the block transfer request" : "",
                    waited),
        asked_for_block ? "if the node answers `read 0x1000`, try --transfer segmented" : "");
}

void SdoClient::send(const can::Frame& frame, State next, TimePoint now) {
  tx_ = frame;
  boot_up_ = false;
  state_ = next;
  deadline_ = now + timeout_;
}

void SdoClient::abort(std::uint32_t code, Errc errc, std::string why, std::string hint) {
  finish(fail(error(errc, std::move(why), std::move(hint))));
  tx_ = sdo_frame(kSdoRequest + node_, kSdoAbortCommand, object_, code);
}

void SdoClient::finish(Result<Bytes> result) {
  state_ = State::idle;
  boot_up_ = false;
  deadline_ = kNever;
  result_ = std::move(result);
}

Error SdoClient::error(Errc code, std::string message, std::string hint) const {
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
  if (sender_.is_waiting()) deadline_ = TimePoint::min();
  return can::make_frame(kSdoRequest + node_, *segment);
}
std::optional<Result<Bytes>> SdoClient::take_result() { return std::exchange(result_, std::nullopt); }

}  // namespace servoctl::canopen
