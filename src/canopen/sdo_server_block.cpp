// The block transfers of the SDO server (CiA 301, 7.2.4.2.9 to 7.2.4.2.16 and 7.2.4.3.8 to 7.2.4.3.16).
#include "canopen/cob_id.hpp"

#include <utility>
#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_frame.hpp"
#include "canopen/sdo_server.hpp"

namespace servoctl::canopen {
namespace {

constexpr std::uint8_t kSizeIndicated = 0x02;

}  // namespace

void SdoServer::on_block_upload_initiate(const can::Frame& frame, TimePoint now) {
  reset();
  object_ = sdo_object(frame);
  if (!options_.block) return abort(object_, sdo_abort::kCommand);
  const auto block_size = frame.data[4];
  const auto switch_threshold = frame.data[5];
  if (block_size == 0 || block_size > kMaxBlockSize) return abort(object_, sdo_abort::kBlockSize);
  Bytes data;
  if (const auto code = store_->read(object_, data); code != 0) return abort(object_, code);
  if (switch_threshold != 0 && data.size() <= switch_threshold)
    return answer_upload(object_, std::move(data), now);
  const auto size = static_cast<std::uint32_t>(data.size());
  sender_.start(std::move(data), block_size);
  crc_ = options_.crc && (frame.data[0] & kCrcSupported) != 0;
  state_ = State::block_upload_start;
  deadline_ = now + options_.timeout;
  const auto command = 0xC0U | kSizeIndicated | (options_.crc ? kCrcSupported : 0U);
  tx_ = sdo_frame(kSdoAnswer + node_, static_cast<std::uint8_t>(command), object_, size);
}

/// Start, acknowledge or end of a block upload.
void SdoServer::on_block_upload(const can::Frame& frame, TimePoint now) {
  const auto command = frame.data[0] & 0x03U;
  if (command == 3 && state_ == State::block_upload_start) {
    state_ = State::block_upload_data;
    deadline_ = kNever;
    return;
  }
  if (command == 3 && state_ == State::block_upload_data) return;  // It comes twice.
  if (command == 2 && state_ == State::block_upload_data) return on_block_upload_acknowledge(frame, now);
  if (command == 2 && state_ == State::block_upload_end) return;  // It comes twice.
  if (command == 1 && state_ == State::block_upload_end) return reset();
  abort(object_, sdo_abort::kCommand);
}

void SdoServer::on_block_upload_acknowledge(const can::Frame& frame, TimePoint now) {
  if (const auto code = sender_.on_acknowledge(frame.data[1], frame.data[2]); code != 0)
    return abort(object_, code);
  deadline_ = kNever;
  if (!sender_.is_done()) return;
  auto end =
      sdo_segment(kSdoAnswer + node_,
                  static_cast<std::uint8_t>(0xC1U | static_cast<unsigned>(sender_.unused_bytes()) << 2U));
  const auto crc = crc_ ? sender_.crc() : std::uint16_t{0};
  end.data[1] = static_cast<std::uint8_t>(crc & 0xFFU);
  end.data[2] = static_cast<std::uint8_t>(crc >> 8);
  state_ = State::block_upload_end;
  deadline_ = now + options_.timeout;
  tx_ = end;
}

void SdoServer::on_block_download_initiate(const can::Frame& frame, TimePoint now) {
  reset();
  object_ = sdo_object(frame);
  if (!options_.block) return abort(object_, sdo_abort::kCommand);
  if ((frame.data[0] & kSizeIndicated) != 0) announced_ = sdo_data(frame);
  if (announced_ > kMaxSdoDownload) return abort(object_, sdo_abort::kOutOfMemory);
  if (const auto code = store_->check_writable(object_); code != 0) return abort(object_, code);
  crc_ = options_.crc && (frame.data[0] & kCrcSupported) != 0;
  receiver_.start(options_.block_size, frame.data);
  nudged_ = false;
  state_ = State::block_download_data;
  deadline_ = now + options_.timeout;
  const auto command = 0xA0U | (options_.crc ? kCrcSupported : 0U);
  tx_ = sdo_frame(kSdoAnswer + node_, static_cast<std::uint8_t>(command), object_, options_.block_size);
}

void SdoServer::on_block_download_data(const can::Frame& frame, TimePoint now) {
  const bool ended = receiver_.on_segment(frame.data);
  if (receiver_.received() > announced_.value_or(kMaxSdoDownload) + 7)
    return abort(object_, sdo_abort::kTooLong);
  // A lost end of a block is asked for before the client, whose patience may be shorter, gives up.
  deadline_ = now + (nudged_ ? options_.timeout : options_.timeout / 4);
  if (!ended) return;
  nudged_ = false;
  if (receiver_.has_last()) state_ = State::block_download_end;
  acknowledge_block(now);
}

void SdoServer::acknowledge_block(TimePoint now) {
  auto acknowledge = sdo_segment(kSdoAnswer + node_, 0xA2);
  acknowledge.data[1] = receiver_.acknowledge();
  acknowledge.data[2] = options_.block_size;
  deadline_ = now + options_.timeout;
  tx_ = acknowledge;
}

void SdoServer::on_block_download_end(const can::Frame& frame) {
  if (state_ != State::block_download_end) return abort(object_, sdo_abort::kCommand);
  const auto data = receiver_.take(frame.data[0] >> 2U & 0x07U);
  const auto crc = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8U);
  if (crc_ && crc != sdo_crc(data)) return abort(object_, sdo_abort::kCrc);
  if (announced_ && data.size() > *announced_) return abort(object_, sdo_abort::kTooLong);
  if (announced_ && data.size() < *announced_) return abort(object_, sdo_abort::kTooShort);
  if (const auto code = store_->write(object_, data); code != 0) return abort(object_, code);
  reset();
  tx_ = sdo_segment(kSdoAnswer + node_, 0xA1);
}

}  // namespace servoctl::canopen
