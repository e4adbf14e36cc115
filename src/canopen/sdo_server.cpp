#include "canopen/sdo_server.hpp"

#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"
#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {

void SdoServer::on_frame(const can::Frame& frame, TimePoint now) {
  if (frame.id != kSdoRequest + node_ || frame.size != 8 || frame.extended || frame.remote || frame.error)
    return;
  const std::uint8_t command = frame.data[0];
  if (command == kSdoAbortCommand) return reset();
  if (state_ == State::block_download_data) return on_block_download_data(frame, now);
  if (state_ == State::block_download_end && receiver_.repeats(frame.data)) return;
  switch (command & 0xE0U) {
    case 0x40: return on_upload_initiate(sdo_object(frame), now);
    case 0x20: return on_download_initiate(frame, now);
    case 0x60: return on_upload_segment(frame, now);
    case 0x00: return on_download_segment(frame, now);
    case 0xA0:
      return (command & 0x03U) == 0 ? on_block_upload_initiate(frame, now) : on_block_upload(frame, now);
    case 0xC0:
      return (command & 0x01U) == 0 ? on_block_download_initiate(frame, now) : on_block_download_end(frame);
    default: return abort(sdo_object(frame), sdo_abort::kCommand);
  }
}

void SdoServer::on_upload_initiate(ObjectAddress object, TimePoint now) {
  reset();
  object_ = object;
  Bytes data;
  if (const auto code = store_->read(object, data); code != 0) return abort(object, code);
  answer_upload(object, std::move(data), now);
}

void SdoServer::answer_upload(ObjectAddress object, Bytes data, TimePoint now) {
  const auto size = static_cast<std::uint32_t>(data.size());
  if (size >= 1 && size <= 4) {
    const auto command = static_cast<std::uint8_t>(0x43U | (4U - size) << 2U);
    tx_ = sdo_frame(kSdoAnswer + node_, command, object, static_cast<std::uint32_t>(load_le(data)));
    return;
  }
  if (!options_.segmented) return abort(object, sdo_abort::kUnsupportedAccess);
  data_ = std::move(data);
  state_ = State::upload;
  deadline_ = now + options_.timeout;
  tx_ = sdo_frame(kSdoAnswer + node_, 0x41, object, size);
}

void SdoServer::on_download_initiate(const can::Frame& frame, TimePoint now) {
  reset();
  const auto object = sdo_object(frame);
  object_ = object;
  const std::uint8_t command = frame.data[0];
  const bool size_indicated = (command & 0x01U) != 0;
  if ((command & 0x02U) != 0) {
    const std::size_t announced = size_indicated ? 4U - (command >> 2U & 0x03U) : 4U;
    const auto size = std::min<std::size_t>(store_->expedited_size(object, announced), 4U);
    const auto code = store_->write(object, ByteSpan(frame.data).subspan(4, size));
    if (code != 0) return abort(object, code);
    tx_ = sdo_frame(kSdoAnswer + node_, 0x60, object, options_.echo ? sdo_data(frame) : 0);
    return;
  }
  if (!options_.segmented) return abort(object, sdo_abort::kCommand);
  if (size_indicated) announced_ = sdo_data(frame);
  if (announced_ > kMaxSdoDownload) return abort(object, sdo_abort::kOutOfMemory);
  if (const auto code = store_->check_writable(object); code != 0) return abort(object, code);
  state_ = State::download;
  deadline_ = now + options_.timeout;
  tx_ = sdo_frame(kSdoAnswer + node_, 0x60, object);
}

void SdoServer::on_upload_segment(const can::Frame& frame, TimePoint now) {
  if (state_ != State::upload) return abort(object_, sdo_abort::kCommand);
  if ((frame.data[0] & kToggleBit) != toggle_) return abort(object_, sdo_abort::kToggle);
  const std::size_t size = std::min<std::size_t>(7, data_.size() - offset_);
  const bool last = offset_ + size == data_.size();
  auto answer = sdo_segment(kSdoAnswer + node_,
                            static_cast<std::uint8_t>(toggle_ | (7U - size) << 1U | (last ? 1U : 0U)));
  std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(offset_), size, answer.data.begin() + 1);
  offset_ += size;
  toggle_ ^= kToggleBit;
  deadline_ = now + options_.timeout;
  if (last) reset();
  tx_ = answer;
}

void SdoServer::on_download_segment(const can::Frame& frame, TimePoint now) {
  if (state_ != State::download) return abort(object_, sdo_abort::kCommand);
  const std::uint8_t command = frame.data[0];
  if ((command & kToggleBit) != toggle_) return abort(object_, sdo_abort::kToggle);
  const auto size = 7 - (command >> 1U & 0x07);
  data_.insert(data_.end(), frame.data.begin() + 1, frame.data.begin() + 1 + size);
  const bool last = (command & 0x01U) != 0;
  if (data_.size() > announced_.value_or(kMaxSdoDownload)) return abort(object_, sdo_abort::kTooLong);
  if (last) {
    if (announced_ && data_.size() < *announced_) return abort(object_, sdo_abort::kTooShort);
    if (const auto code = store_->write(object_, data_); code != 0) return abort(object_, code);
  }
  const auto answer = sdo_segment(kSdoAnswer + node_, static_cast<std::uint8_t>(0x20U | toggle_));
  toggle_ ^= kToggleBit;
  deadline_ = now + options_.timeout;
  if (last) reset();
  tx_ = answer;
}

void SdoServer::on_time(TimePoint now) {
  if (state_ == State::idle || now < deadline_) return;
  // The last segment of a block has just been handed over: the client's time begins now.
  if (deadline_ == TimePoint::min()) {
    deadline_ = now + options_.timeout;
    return;
  }
  // The end of a block was lost: an early acknowledge asks for it again.
  if (state_ == State::block_download_data && receiver_.has_some() && !nudged_) {
    acknowledge_block(now);
    nudged_ = true;
    return;
  }
  abort(object_, sdo_abort::kTimeout);
}

std::optional<can::Frame> SdoServer::take_frame() {
  if (tx_ || state_ != State::block_upload_data) return std::exchange(tx_, std::nullopt);
  const auto segment = sender_.next_segment();
  if (!segment) return std::nullopt;
  if (sender_.is_waiting()) deadline_ = TimePoint::min();
  return can::make_frame(kSdoAnswer + node_, *segment);
}

void SdoServer::reset() {
  state_ = State::idle;
  data_.clear();
  offset_ = 0;
  announced_.reset();
  toggle_ = 0;
  deadline_ = kNever;
}

void SdoServer::abort(ObjectAddress object, std::uint32_t code) {
  reset();
  tx_ = sdo_frame(kSdoAnswer + node_, kSdoAbortCommand, object, code);
}

}  // namespace servoctl::canopen
