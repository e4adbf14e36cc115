#include "canopen/sdo_observer.hpp"

#include <algorithm>
#include <utility>

#include "canopen/sdo_frame.hpp"
#include "canopen/sdo_habits.hpp"

namespace servoctl::canopen {

using Kind = SdoStep::Kind;

SdoStep SdoObserver::on_client_frame(const can::Frame& frame) {
  auto out = [&] {
    if (frame.size != 8) return SdoStep{};
    const auto command = frame.data[0];
    if (command == kSdoAbortCommand) return abort(frame);
    if (phase_ == Phase::block_down) return block_segment(frame);
    switch (command & 0xE0U) {
      case 0x00: return segment(frame);
      case 0x20: return initiate(frame, Kind::write);
      case 0x40: return begin(frame, Kind::read);
      case 0x60: return step(Kind::next);
      case 0xA0:
        if ((command & 0x03U) == 0) return begin(frame, Kind::read);
        if ((command & 0x03U) == 1) return step(Kind::end);
        if ((command & 0x03U) == 2) return block_acknowledge(frame);
        phase_ = Phase::block_up;
        return step(Kind::next);
      case 0xC0:
        if ((command & 0x01U) != 0) return block_end(frame);
        return initiate(frame, Kind::write);
      default: return SdoStep{};
    }
  }();
  out.from_client = true;
  out.block = out.block || (frame.size == 8 && (frame.data[0] & 0xE0U) >= 0xA0);
  return out;
}

SdoStep SdoObserver::on_server_frame(const can::Frame& answer) {
  const auto whole = whole_sdo_answer(answer, phase_ == Phase::block_up);
  if (!whole) return {};
  const auto& frame = *whole;
  const auto command = frame.data[0];
  if (command == kSdoAbortCommand) return abort(frame);
  if (phase_ == Phase::block_up) return block_segment(frame);
  auto out = [&] {
    switch (command & 0xE0U) {
      case 0x00: return segment(frame);
      case 0x20: return step(Kind::next);
      case 0x40: return initiate(frame, Kind::answer);
      case 0x60: return begin(frame, Kind::acknowledge);
      case 0xA0:
        if ((command & 0x03U) == 1) return step(Kind::end);
        if ((command & 0x03U) == 2) return block_acknowledge(frame);
        return begin_block_down(frame);
      case 0xC0:
        if ((command & 0x01U) != 0) return block_end(frame);
        return initiate(frame, Kind::answer);
      default: return SdoStep{};
    }
  }();
  out.block = (command & 0xE0U) >= 0xA0;
  return out;
}

SdoStep SdoObserver::step(Kind kind) const {
  SdoStep out;
  out.kind = kind;
  out.object = object_;
  out.received = data_.size();
  return out;
}

/// A frame that names the object; nothing of it has been seen yet.
SdoStep SdoObserver::begin(const can::Frame& frame, Kind kind) {
  object_ = sdo_object(frame);
  data_.clear();
  block_begin_ = 0;
  sequence_ = 0;
  last_seen_ = false;
  phase_ = Phase::none;
  return step(kind);
}

SdoStep SdoObserver::begin_block_down(const can::Frame& frame) {
  const auto out = begin(frame, Kind::acknowledge);
  phase_ = Phase::block_down;
  return out;
}

/// A frame that names the object and carries it, or says how long it is.
SdoStep SdoObserver::initiate(const can::Frame& frame, Kind kind) {
  auto out = begin(frame, kind);
  const auto command = frame.data[0];
  const bool block = (command & 0xE0U) == 0xC0;
  if (!block && (command & 0x02U) != 0) {
    const auto size = (command & 0x01U) != 0 ? 4 - (command >> 2U & 0x03) : 4;
    out.data = Bytes(frame.data.begin() + 4, frame.data.begin() + 4 + size);
    out.received = out.data->size();
    return out;
  }
  if ((command & (block ? 0x02U : 0x01U)) != 0) out.announced = sdo_data(frame);
  return out;
}

SdoStep SdoObserver::segment(const can::Frame& frame) {
  const auto size = 7 - (frame.data[0] >> 1U & 0x07);
  if (object_ && data_.size() < kMaxSdoUpload)
    data_.insert(data_.end(), frame.data.begin() + 1, frame.data.begin() + 1 + size);
  auto out = step(Kind::segment);
  if (object_ && (frame.data[0] & 0x01U) != 0) out.data = std::exchange(data_, {});
  return out;
}

SdoStep SdoObserver::block_segment(const can::Frame& frame) {
  if ((frame.data[0] & 0x7F) == sequence_ + 1 && data_.size() < kMaxSdoUpload) {
    data_.insert(data_.end(), frame.data.begin() + 1, frame.data.end());
    ++sequence_;
    last_seen_ = (frame.data[0] & 0x80U) != 0;
  }
  auto out = step(Kind::segment);
  out.block = true;
  return out;
}

/// What was not acknowledged comes again.
SdoStep SdoObserver::block_acknowledge(const can::Frame& frame) {
  if (last_seen_ && frame.data[1] == sequence_) phase_ = Phase::none;
  block_begin_ = std::min(data_.size(), block_begin_ + std::size_t{7} * frame.data[1]);
  data_.resize(block_begin_);
  sequence_ = 0;
  auto out = step(Kind::next);
  out.block = true;
  return out;
}

SdoStep SdoObserver::block_end(const can::Frame& frame) {
  const auto unused = std::min<std::size_t>(frame.data[0] >> 2U & 0x07U, data_.size());
  data_.resize(data_.size() - unused);
  phase_ = Phase::none;
  auto out = step(Kind::end);
  out.block = true;
  if (object_) out.data = std::exchange(data_, {});
  return out;
}

SdoStep SdoObserver::abort(const can::Frame& frame) {
  auto out = step(Kind::abort);
  // Some servers name no object: it belongs to the transfer that is under way.
  const auto named = sdo_object(frame);
  out.object = named == ObjectAddress{} ? object_.value_or(named) : named;
  out.abort_code = sdo_data(frame);
  object_.reset();
  data_.clear();
  phase_ = Phase::none;
  return out;
}

}  // namespace servoctl::canopen
