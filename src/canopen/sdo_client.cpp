#include "canopen/sdo_client.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"
#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {
namespace {

constexpr std::uint8_t kToggleBit = 0x10;
/// More than any object of a drive holds; ends a server that never sends its last segment.
constexpr std::size_t kMaxUpload = 64U << 20U;

std::uint8_t specifier(const can::Frame& frame) { return frame.data[0] & 0xE0U; }

}  // namespace

void SdoClient::start_upload(ObjectAddress object, TimePoint now) {
  object_ = object;
  data_.clear();
  announced_.reset();
  toggle_ = 0;
  send(sdo_frame(kSdoRequest + node_, 0x40, object), State::upload_initiate, now);
}

void SdoClient::start_download(ObjectAddress object, Bytes data, TimePoint now) {
  object_ = object;
  data_ = std::move(data);
  offset_ = 0;
  toggle_ = 0;
  const auto size = static_cast<std::uint32_t>(data_.size());
  if (size >= 1 && size <= 4) {
    const auto command = static_cast<std::uint8_t>(0x23U | (4U - size) << 2U);
    offset_ = size;
    send(sdo_frame(kSdoRequest + node_, command, object, static_cast<std::uint32_t>(load_le(data_))),
         State::download_initiate, now);
    return;
  }
  send(sdo_frame(kSdoRequest + node_, 0x21, object, size), State::download_initiate, now);
}

void SdoClient::on_frame(const can::Frame& frame, TimePoint now) {
  if (state_ == State::idle || frame.id != kSdoAnswer + node_ || frame.extended || frame.remote ||
      frame.error)
    return;
  if (frame.size != 8) {
    abort(sdo_abort::kCommand, Errc::protocol,
          fmt::format("its answer has {} bytes instead of 8", frame.size));
    return;
  }
  if (frame.data[0] == kSdoAbortCommand) {
    if (sdo_object(frame) != object_) return;
    const auto code = sdo_data(frame);
    auto refused =
        error(Errc::sdo_abort, fmt::format("refused: {} (abort 0x{:08X})", sdo_abort_text(code), code),
              sdo_abort_hint(code));
    refused.abort_code = code;
    finish(tl::unexpected<Error>(std::move(refused)));
    return;
  }
  switch (state_) {
    case State::idle: break;
    case State::upload_initiate: on_upload_initiate(frame, now); break;
    case State::upload_segment: on_upload_segment(frame, now); break;
    case State::download_initiate: on_download_initiate(frame, now); break;
    case State::download_segment: on_download_segment(frame, now); break;
  }
}

void SdoClient::on_upload_initiate(const can::Frame& frame, TimePoint now) {
  if (sdo_object(frame) != object_) return;
  if (specifier(frame) != 0x40) {
    abort(sdo_abort::kCommand, Errc::protocol,
          fmt::format("it answered a read with command 0x{:02X}", frame.data[0]));
    return;
  }
  const bool expedited = (frame.data[0] & 0x02U) != 0;
  const bool size_indicated = (frame.data[0] & 0x01U) != 0;
  if (expedited) {
    const auto size = size_indicated ? 4 - (frame.data[0] >> 2U & 0x03) : 4;
    finish(Bytes(frame.data.begin() + 4, frame.data.begin() + 4 + size));
    return;
  }
  if (size_indicated) announced_ = sdo_data(frame);
  if (announced_.value_or(0) > kMaxUpload) {
    abort(sdo_abort::kOutOfMemory, Errc::protocol,
          fmt::format("it announces {} bytes for this object", *announced_));
    return;
  }
  data_.reserve(announced_.value_or(0));
  request_segment(now);
}

void SdoClient::on_upload_segment(const can::Frame& frame, TimePoint now) {
  if (specifier(frame) == 0x40 && sdo_object(frame) == object_ && data_.empty())
    return;  // The first answer, twice.
  if (specifier(frame) != 0x00) {
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
  if (data_.size() > announced_.value_or(kMaxUpload) || (last && announced_ && data_.size() < *announced_)) {
    abort(sdo_abort::kLength, Errc::protocol,
          fmt::format("it announced {} bytes and sent {}", announced_.value_or(kMaxUpload), data_.size()));
    return;
  }
  if (last) return finish(std::exchange(data_, {}));
  toggle_ ^= kToggleBit;
  request_segment(now);
}

void SdoClient::on_download_initiate(const can::Frame& frame, TimePoint now) {
  if (sdo_object(frame) != object_) return;
  if (specifier(frame) != 0x60) {
    abort(sdo_abort::kCommand, Errc::protocol,
          fmt::format("it answered a write with command 0x{:02X}", frame.data[0]));
    return;
  }
  if (offset_ == data_.size() && !data_.empty()) return finish(Bytes{});
  send_segment(now);
}

void SdoClient::on_download_segment(const can::Frame& frame, TimePoint now) {
  if (specifier(frame) == 0x60 && sdo_object(frame) == object_ && offset_ <= 7)
    return;  // The first answer, twice.
  if (specifier(frame) != 0x20) {
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
  const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(timeout_).count();
  abort(sdo_abort::kTimeout, Errc::timeout, fmt::format("no answer within {} ms", waited));
}

void SdoClient::send(const can::Frame& frame, State next, TimePoint now) {
  tx_ = frame;
  state_ = next;
  deadline_ = now + timeout_;
}

void SdoClient::abort(std::uint32_t code, Errc errc, std::string why, std::string hint) {
  finish(tl::unexpected<Error>(error(errc, std::move(why), std::move(hint))));
  tx_ = sdo_frame(kSdoRequest + node_, kSdoAbortCommand, object_, code);
}

void SdoClient::finish(Result<Bytes> result) {
  state_ = State::idle;
  deadline_ = kNever;
  result_ = std::move(result);
}

Error SdoClient::error(Errc code, std::string message, std::string hint) const {
  Error out;
  out.code = code;
  out.message = fmt::format("node {}, object {}: {}", node_, to_string(object_), message);
  out.hint = std::move(hint);
  out.node = node_;
  out.object = object_;
  return out;
}

std::optional<can::Frame> SdoClient::take_frame() { return std::exchange(tx_, std::nullopt); }
std::optional<Result<Bytes>> SdoClient::take_result() { return std::exchange(result_, std::nullopt); }

}  // namespace servoctl::canopen
