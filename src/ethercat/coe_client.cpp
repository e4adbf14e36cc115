#include "ethercat/coe_client.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_frame.hpp"
#include "ethercat/coe_abort.hpp"
#include "ethercat/coe_message.hpp"
#include "ethercat/mailbox_message.hpp"

namespace servoctl::ethercat {
namespace {

namespace sdo_abort = canopen::sdo_abort;
using canopen::Transfer;

constexpr std::uint8_t kToggleBit = 0x10;
constexpr std::uint8_t kCompleteAccess = 0x10;
constexpr std::size_t kInitiate = kCoeHeader + kSdoHeader;  ///< Of an initiate message, in front of its data.
constexpr std::size_t kSegment = kCoeHeader + 1;            ///< Of a segment, in front of its data.
/// A segment has as many bytes at least; one that needs fewer says how many are not used.
constexpr std::size_t kLeastSegment = 7;

std::uint8_t command(ByteSpan message) { return message[kCoeHeader]; }
std::uint8_t specifier(ByteSpan message) { return command(message) & 0xE0U; }

}  // namespace

bool CoeClient::begin(ObjectAddress object, Transfer transfer, bool again) {
  core_.begin(again);
  is_shadowed_ = core_.is_shadowed(object);
  object_ = object;
  transfer_ = transfer;
  data_.clear();
  offset_ = 0;
  announced_.reset();
  toggle_ = 0;
  if (transfer != Transfer::block) return true;
  finish(
      fail(error(Errc::usage, "there are no block transfers over EtherCAT", "leave --transfer block out")));
  return false;
}

void CoeClient::start_upload(ObjectAddress object, TimePoint now, Transfer transfer, bool complete,
                             bool again) {
  if (!begin(object, transfer, again)) return;
  complete_ = complete;
  if (!core_.is_clear(object)) return check(now);
  begin_upload(now);
}

void CoeClient::begin_upload(TimePoint now) {
  core_.ask_read(object_, now);
  const auto request = static_cast<std::uint8_t>(0x40U | (complete_ ? kCompleteAccess : 0U));
  send(sdo_message(request, object_, 0), State::upload_initiate, now);
}

void CoeClient::start_download(ObjectAddress object, Bytes data, TimePoint now, Transfer transfer,
                               bool complete) {
  if (!begin(object, transfer, false)) return;
  data_ = std::move(data);
  announced_ = data_.size();
  const bool fits = !data_.empty() && data_.size() <= 4;
  if (transfer == Transfer::expedited && !fits)
    return finish(
        fail(error(Errc::usage, message("{} bytes do not fit into one expedited message", data_.size()),
                   "leave --transfer expedited out")));
  core_.ask_write(object, data_, now);
  const auto access = complete ? kCompleteAccess : 0U;
  if (fits && !complete && transfer != Transfer::segmented) {
    const auto request = static_cast<std::uint8_t>(0x23U | (4U - data_.size()) << 2U);
    offset_ = data_.size();
    return send(sdo_message(request, object, static_cast<std::uint32_t>(load_le(data_))),
                State::download_initiate, now);
  }
  auto message = sdo_message(static_cast<std::uint8_t>(0x21U | access), object,
                             static_cast<std::uint32_t>(data_.size()));
  offset_ = std::min(data_.size(), max_message_ - kInitiate);
  message.insert(message.end(), data_.begin(), data_.begin() + static_cast<std::ptrdiff_t>(offset_));
  send(std::move(message), State::download_initiate, now);
}

void CoeClient::on_message(ByteSpan message, TimePoint now) {
  if (message.size() <= kCoeHeader) return;
  const auto service = coe_service(message);
  // Some servers abort in the service of requests.
  const bool aborts = specifier(message) == canopen::kSdoAbortCommand &&
                      (service == CoeService::sdo_response || service == CoeService::sdo_request);
  if (!aborts && service != CoeService::sdo_response) return;
  if (!is_anonymous() && !is_first_answer(message, now)) return;
  if (aborts) return on_abort(message);
  switch (state_) {
    case State::idle:
    case State::resync: return;
    case State::upload_initiate: return on_upload_initiate(message, now);
    case State::upload_segment: return on_upload_segment(message, now);
    case State::download_initiate: return on_download_initiate(message, now);
    case State::download_segment: return on_download_segment(message, now);
  }
}

void CoeClient::on_abort(ByteSpan message) {
  if (message.size() < kInitiate) return;
  const auto code = sdo_data(message);
  if (sdo_object(message) != object_) return core_.note(command(message), sdo_object(message), code);
  const bool writes = state_ != State::upload_initiate && state_ != State::upload_segment;
  auto refused = error(Errc::sdo_abort,
                       servoctl::message("refused: {} (abort 0x{:08X})", canopen::sdo_abort_text(code), code),
                       coe_abort_hint(code, object_, writes));
  refused.abort_code = code;
  finish(fail(std::move(refused)));
}

void CoeClient::on_upload_initiate(ByteSpan message, TimePoint now) {
  if (message.size() < kInitiate)
    return abort(sdo_abort::kCommand, Errc::protocol,
                 formatted("its answer has {} bytes instead of {}", message.size(), kInitiate));
  if (specifier(message) != 0x40)
    return abort(sdo_abort::kCommand, Errc::protocol,
                 formatted("it answered a read with command 0x{:02X}", command(message)));
  if ((command(message) & 0x02U) != 0) return on_expedited(message);
  if (transfer_ == Transfer::expedited)
    return abort(sdo_abort::kUnsupportedAccess, Errc::protocol,
                 "it does not answer this read in one expedited message", "leave --transfer expedited out");
  const auto came = message.subspan(kInitiate);
  announced_ = (command(message) & 0x01U) != 0 ? sdo_data(message) : came.size();
  if (announced_ > canopen::kMaxSdoUpload)
    return abort(sdo_abort::kOutOfMemory, Errc::protocol,
                 formatted("it announces {} bytes for this object", *announced_));
  // What is behind the data is not the object's.
  const auto size = std::min(came.size(), *announced_);
  data_.reserve(*announced_);
  data_.assign(came.begin(), came.begin() + static_cast<std::ptrdiff_t>(size));
  if (data_.size() == *announced_) return finish(std::exchange(data_, {}));
  request_segment(now);
}

void CoeClient::on_expedited(ByteSpan message) {
  const bool size_indicated = (command(message) & 0x01U) != 0;
  const std::size_t size = size_indicated ? 4U - (command(message) >> 2U & 0x03U) : 4U;
  const auto data = message.subspan(kInitiate - 4, size);
  finish(Bytes(data.begin(), data.end()));
}

void CoeClient::on_upload_segment(ByteSpan message, TimePoint now) {
  if (message.size() >= kInitiate && specifier(message) == 0x40 && sdo_object(message) == object_)
    return;  // The first answer, twice.
  if (specifier(message) != 0x00)
    return abort(sdo_abort::kCommand, Errc::protocol,
                 formatted("it answered a segment request with command 0x{:02X}", command(message)));
  if ((command(message) & kToggleBit) != toggle_)
    return abort(sdo_abort::kToggle, Errc::protocol, "the toggle bit of its segment did not alternate");
  const bool last = (command(message) & 0x01U) != 0;
  auto came = message.subspan(kSegment);
  if (last && came.size() <= kLeastSegment)
    came = came.first(std::min<std::size_t>(came.size(), kLeastSegment - (command(message) >> 1U & 0x07U)));
  const auto missing = *announced_ - data_.size();
  // Padding of the last segment up to the least length is not the object's.
  if (last && came.size() <= kLeastSegment) came = came.first(std::min(came.size(), missing));
  data_.insert(data_.end(), came.begin(), came.end());
  if (came.size() > missing || (last ? came.size() < missing : came.empty() || came.size() == missing))
    return abort(sdo_abort::kLength, Errc::protocol,
                 formatted("it announced {} bytes and sent {}{}", *announced_, data_.size(),
                           last ? "" : " and has more"));
  if (last) return finish(std::exchange(data_, {}));
  toggle_ ^= kToggleBit;
  request_segment(now);
}

void CoeClient::on_download_initiate(ByteSpan message, TimePoint now) {
  if (message.size() < kInitiate)
    return abort(sdo_abort::kCommand, Errc::protocol,
                 formatted("its answer has {} bytes instead of {}", message.size(), kInitiate));
  if (specifier(message) != 0x60)
    return abort(sdo_abort::kCommand, Errc::protocol,
                 formatted("it answered a write with command 0x{:02X}", command(message)));
  if (offset_ == data_.size()) return finish(Bytes{});
  send_segment(now);
}

void CoeClient::on_download_segment(ByteSpan message, TimePoint now) {
  if (message.size() >= kInitiate && specifier(message) == 0x60 && sdo_object(message) == object_)
    return;  // The first answer, twice.
  if (specifier(message) != 0x20)
    return abort(sdo_abort::kCommand, Errc::protocol,
                 formatted("it answered a segment with command 0x{:02X}", command(message)));
  if ((command(message) & kToggleBit) != toggle_)
    return abort(sdo_abort::kToggle, Errc::protocol, "the toggle bit of its answer did not alternate");
  if (offset_ == data_.size()) return finish(Bytes{});
  toggle_ ^= kToggleBit;
  send_segment(now);
}

void CoeClient::request_segment(TimePoint now) {
  auto message = sdo_message(static_cast<std::uint8_t>(0x60U | toggle_), {}, 0);
  send(std::move(message), State::upload_segment, now);
}

void CoeClient::send_segment(TimePoint now) {
  const auto size = std::min(data_.size() - offset_, max_message_ - kSegment);
  const bool last = offset_ + size == data_.size();
  const auto unused = size < kLeastSegment ? kLeastSegment - size : 0;
  auto message = sdo_message(static_cast<std::uint8_t>(toggle_ | unused << 1U | (last ? 1U : 0U)), {}, 0);
  message.resize(kSegment + std::max(size, kLeastSegment));
  std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(offset_), size, message.begin() + kSegment);
  offset_ += size;
  send(std::move(message), State::download_segment, now);
}

void CoeClient::on_refusal(std::uint16_t detail) {
  if (state_ == State::idle) return;
  finish(fail(error(
      Errc::protocol,
      message("its mailbox refuses the request: {} (mailbox error {:04X}h)", mailbox_error_text(detail),
              detail),
      "some slaves accept no further transfer after one that was left open: `state init` and up again clears it")));
}

void CoeClient::on_failure(Errc code, std::string what, std::string hint) {
  if (state_ == State::idle) return;
  finish(fail(error(code, std::move(what), std::move(hint))));
}

void CoeClient::send(Bytes message, State next, TimePoint now) {
  tx_ = std::move(message);
  state_ = next;
  core_.wait(now);
}

void CoeClient::abort(std::uint32_t code, Errc errc, std::string why, std::string hint) {
  const auto asked = state_ == State::resync ? check_ : object_;
  finish(fail(error(errc, std::move(why), std::move(hint))));
  tx_ = sdo_message(canopen::kSdoAbortCommand, asked, code);
}

void CoeClient::finish(Result<Bytes> result) {
  // As canopen::SdoClient's.
  if (result && is_anonymous()) core_.open().forget_own();
  state_ = State::idle;
  tx_.reset();
  core_.finish(std::move(result));
}

Error CoeClient::error(Errc code, Message message, Message hint) const {
  return drive_error(code, node_, object_, message, std::move(hint));
}

std::size_t CoeClient::transferred() const {
  const bool writes = state_ == State::download_initiate || state_ == State::download_segment;
  return writes ? offset_ : data_.size();
}

std::optional<Bytes> CoeClient::take_message() { return std::exchange(tx_, std::nullopt); }
std::optional<Result<Bytes>> CoeClient::take_result() { return core_.take_end(); }

}  // namespace servoctl::ethercat
