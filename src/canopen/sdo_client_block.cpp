// The block transfers of the SDO client (CiA 301, 7.2.4.2.9 to 7.2.4.2.16 and 7.2.4.3.8 to 7.2.4.3.16).
#include <utility>

#include "base/format.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_client.hpp"
#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {
namespace {

/// Command specifier and sub-command, without the bits that carry data.
std::uint8_t block_command(const can::Frame& frame) { return frame.data[0] & 0xE3U; }

}  // namespace

void SdoClient::begin_block_upload(TimePoint now) {
  data_.clear();
  announced_.reset();
  toggle_ = 0;
  core_.ask_read(object_, now);
  auto request = sdo_frame(kSdoRequest + node_, 0xA0 | kCrcSupported, object_);
  request.data[4] = kMaxBlockSize;
  send(request, State::block_upload_initiate, now);
}

void SdoClient::on_block_upload_initiate(const can::Frame& frame, TimePoint now) {
  const auto command = frame.data[0];
  if ((command & 0xE0U) == 0x40 && transfer_ != Transfer::block) return on_upload_initiate(frame, now);
  if ((command & 0xE1U) != 0xC0) {
    abort(sdo_abort::kCommand, Errc::protocol,
          formatted("it answered the block transfer request with command 0x{:02X}", command));
    return;
  }
  crc_ = (command & kCrcSupported) != 0;
  if ((command & 0x02U) != 0) announced_ = sdo_data(frame);
  if (announced_ > kMaxSdoUpload) {
    abort(sdo_abort::kOutOfMemory, Errc::protocol,
          formatted("it announces {} bytes for this object", *announced_));
    return;
  }
  if (announced_ == 0 && transfer_ != Transfer::block) return leave_block_upload(now);
  receiver_.start(kMaxBlockSize, frame.data);
  nudged_ = false;
  send(sdo_segment(kSdoRequest + node_, 0xA3), State::block_upload_data, now);
}

/// A block has at least one segment, and a segment at least one byte: nothing at all is read without blocks.
void SdoClient::leave_block_upload(TimePoint now) {
  begin_upload(now);
  following_ =
      std::exchange(tx_, sdo_frame(kSdoRequest + node_, kSdoAbortCommand, object_, sdo_abort::kGeneral));
}

void SdoClient::on_block_upload_data(const can::Frame& frame, TimePoint now) {
  const bool ended = receiver_.on_segment(frame.data);
  if (receiver_.received() > announced_.value_or(kMaxSdoUpload) + 7) {
    abort(sdo_abort::kLength, Errc::protocol,
          formatted("it sends more than the {} bytes it announced", announced_.value_or(kMaxSdoUpload)));
    return;
  }
  // Half of the time, so that a lost end of a block can be asked for before the other side gives up.
  core_.wait_until(now + (nudged_ ? core_.timeout() : core_.timeout() / 2));
  if (!ended) return;
  nudged_ = false;
  acknowledge_block(receiver_.has_last() ? State::block_upload_end : State::block_upload_data, now);
}

void SdoClient::acknowledge_block(State next, TimePoint now) {
  auto acknowledge = sdo_segment(kSdoRequest + node_, 0xA2);
  acknowledge.data[1] = receiver_.acknowledge();
  acknowledge.data[2] = kMaxBlockSize;
  send(acknowledge, next, now);
}

void SdoClient::on_block_upload_end(const can::Frame& frame, TimePoint) {
  if (receiver_.repeats(frame.data)) return;
  if ((frame.data[0] & 0xE3U) != 0xC1) {
    abort(sdo_abort::kCommand, Errc::protocol,
          formatted("it ended a block transfer with command 0x{:02X}", frame.data[0]));
    return;
  }
  auto data = receiver_.take(frame.data[0] >> 2U & 0x07U);
  const auto crc = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8U);
  if (crc_ && crc != sdo_crc(data)) {
    abort(sdo_abort::kCrc, Errc::protocol, "the checksum of the block transfer is wrong",
          "disturbed bus, or the object changed while being read: try again");
    return;
  }
  data_ = std::move(data);
  if (is_short() || (announced_ && data_.size() > *announced_)) {
    abort(sdo_abort::kLength, Errc::protocol,
          formatted("it announced {} bytes and sent {}", *announced_, data_.size()));
    return;
  }
  if (announced_ && data_.size() < *announced_) note(SdoHabit::announced_more);
  finish(std::exchange(data_, {}));
  tx_ = sdo_segment(kSdoRequest + node_, 0xA1);
}

void SdoClient::begin_block_download(TimePoint now) {
  acknowledged_.reset();
  core_.ask_write(object_, data_, now);
  send(
      sdo_frame(kSdoRequest + node_, 0xC2 | kCrcSupported, object_, static_cast<std::uint32_t>(data_.size())),
      State::block_download_initiate, now);
}

void SdoClient::on_block_download_initiate(const can::Frame& frame, TimePoint) {
  if (block_command(frame) != 0xA0) {
    abort(sdo_abort::kCommand, Errc::protocol,
          formatted("it answered the block transfer request with command 0x{:02X}", frame.data[0]));
    return;
  }
  const auto block_size = frame.data[4];
  if (block_size == 0 || block_size > kMaxBlockSize) {
    abort(sdo_abort::kBlockSize, Errc::protocol, formatted("it asks for blocks of {} segments", block_size));
    return;
  }
  crc_ = (frame.data[0] & kCrcSupported) != 0;
  sender_.start(std::exchange(data_, {}), block_size);
  state_ = State::block_download_data;
  core_.wait_until(kNever);
}

void SdoClient::on_block_download_data(const can::Frame& frame, TimePoint now) {
  if (block_command(frame) == 0xA0 && sdo_object(frame) == object_) return;  // The first answer, twice.
  if (block_command(frame) != 0xA2) {
    abort(sdo_abort::kCommand, Errc::protocol,
          formatted("it answered a block with command 0x{:02X}", frame.data[0]));
    return;
  }
  const bool repeated = acknowledged_ == frame && frame.data[1] != 0;
  acknowledged_ = frame;
  const auto code = sender_.on_acknowledge(frame.data[1], frame.data[2]);
  if (code != 0 && repeated) return;
  if (code != 0) {
    abort(code, Errc::protocol,
          formatted("it acknowledged segment {} and asked for blocks of {}", frame.data[1], frame.data[2]));
    return;
  }
  if (!sender_.is_done()) {
    core_.wait_until(kNever);
    return;
  }
  auto end =
      sdo_segment(kSdoRequest + node_,
                  static_cast<std::uint8_t>(0xC1U | static_cast<unsigned>(sender_.unused_bytes()) << 2U));
  const auto crc = crc_ ? sender_.crc() : std::uint16_t{0};
  end.data[1] = static_cast<std::uint8_t>(crc & 0xFFU);
  end.data[2] = static_cast<std::uint8_t>(crc >> 8);
  send(end, State::block_download_end, now);
}

void SdoClient::on_block_download_end(const can::Frame& frame, TimePoint) {
  if (block_command(frame) == 0xA2) return;  // The last acknowledge, twice.
  if (block_command(frame) != 0xA1) {
    abort(sdo_abort::kCommand, Errc::protocol,
          formatted("it answered the end of a block transfer with command 0x{:02X}", frame.data[0]));
    return;
  }
  finish(Bytes{});
}

}  // namespace servoctl::canopen
