#include "sim/esc_sdo_server.hpp"

#include <algorithm>

#include "canopen/sdo_abort.hpp"

namespace servoctl::sim {
namespace abort_code = canopen::sdo_abort;

namespace {

constexpr std::size_t kSdoHead = 8;  ///< Of a request and of the first answer.
constexpr std::size_t kSegmentHead = 1;
constexpr std::size_t kLeastSegment = 7;
constexpr unsigned kCompleteAccess = 0x10;
constexpr unsigned kToggle = 0x10;
constexpr unsigned kExpedited = 0x02;
constexpr unsigned kSized = 0x01;
constexpr unsigned kLast = 0x01;

/// Bits 5 to 7 of the first byte: of requests, and of answers.
enum Request : unsigned { kDownloadSegment, kDownload, kUpload, kUploadSegment, kAbort };
enum Answered : unsigned {
  kUploadedSegment = 0x00,
  kDownloadedSegment = 0x20,
  kUploaded = 0x40,
  kDownloaded = 0x60,
  kAborted = 0x80,
};

}  // namespace

std::optional<EscSdoServer::Answer> EscSdoServer::on_request(ByteSpan request, std::size_t most) {
  const unsigned specifier = request[0] >> 5U;
  if (specifier == kDownload || specifier == kUpload) {
    state_ = State::idle;
    object_ = {static_cast<std::uint16_t>(load_le(request.subspan(1, 2))), request[3]};
    complete_ = (request[0] & kCompleteAccess) != 0;
    const bool from_start = object_.sub <= 1;
    if (complete_ && (!options_.complete_access || !from_start)) return abort(abort_code::kUnsupportedAccess);
  }
  switch (specifier) {
    case kDownload: return start_download(request);
    case kUpload: return start_upload(most);
    case kDownloadSegment: return take_segment(request);
    case kUploadSegment: return send_segment(request, most);
    case kAbort: state_ = State::idle; return std::nullopt;
    default: return abort(abort_code::kCommand);
  }
}

Bytes EscSdoServer::head(unsigned command) const {
  Bytes out(kSdoHead, 0);
  out[0] = static_cast<std::uint8_t>(command | (complete_ ? kCompleteAccess : 0U));
  store_le(object_.index, std::span(out).subspan(1, 2));
  out[3] = object_.sub;
  return out;
}

EscSdoServer::Answer EscSdoServer::abort(std::uint32_t code) {
  state_ = State::idle;
  complete_ = false;
  auto out = head(kAborted);
  store_le(code, std::span(out).subspan(4, 4));
  return {std::move(out), true};
}

namespace {

/// 1C00h, what each sync manager is for (ETG.1000.6, 5.6.7.2), of a family whose dictionary does not list it:
/// mailboxes out and in, process data out and in.
std::optional<Bytes> sync_manager_use(ObjectAddress object) {
  constexpr std::uint16_t kSyncManagerUse = 0x1C00;
  constexpr std::uint8_t kUses = 4;
  if (object.index != kSyncManagerUse || object.sub > kUses) return std::nullopt;
  return Bytes{object.sub == 0 ? kUses : object.sub};
}

}  // namespace

std::uint32_t EscSdoServer::read(Bytes& out) {
  if (auto use = complete_ ? std::nullopt : sync_manager_use(object_)) {
    if (store_->read(object_, out) != abort_code::kNoObject) return store_->read(object_, out);
    out = std::move(*use);
    return 0;
  }
  return complete_ ? whole_.read(object_.index, object_.sub, out) : store_->read(object_, out);
}

std::uint32_t EscSdoServer::write(ByteSpan data) {
  return complete_ ? whole_.write(object_.index, object_.sub, data) : store_->write(object_, data);
}

EscSdoServer::Answer EscSdoServer::start_upload(std::size_t most) {
  constexpr std::size_t kMostExpedited = 4;
  Bytes data;
  if (const auto code = read(data); code != 0) return abort(code);
  if (!data.empty() && data.size() <= kMostExpedited) {
    const auto unused = static_cast<unsigned>(kMostExpedited - data.size());
    auto out = head(kUploaded | unused << 2U | kExpedited | kSized);
    std::copy(data.begin(), data.end(), out.begin() + 4);
    return {std::move(out)};
  }
  auto out = head(kUploaded | kSized);
  store_le(data.size(), std::span(out).subspan(4, 4));
  const auto here = std::min(data.size(), most - kSdoHead);
  const auto rest = data.begin() + static_cast<std::ptrdiff_t>(here);
  out.insert(out.end(), data.begin(), rest);
  data_.assign(rest, data.end());
  toggle_ = 0;
  if (!data_.empty()) state_ = State::upload;
  return {std::move(out)};
}

EscSdoServer::Answer EscSdoServer::send_segment(ByteSpan request, std::size_t most) {
  if (state_ != State::upload) return abort(abort_code::kCommand);
  if ((request[0] & kToggle) != toggle_) return abort(abort_code::kToggle);
  const auto here = std::min(data_.size(), most - kSegmentHead);
  const auto rest = data_.begin() + static_cast<std::ptrdiff_t>(here);
  Bytes out{static_cast<std::uint8_t>(kUploadedSegment | toggle_)};
  out.insert(out.end(), data_.begin(), rest);
  data_.erase(data_.begin(), rest);
  toggle_ ^= kToggle;
  if (data_.empty()) {
    out[0] |= kLast;
    state_ = State::idle;
  }
  // A segment has seven bytes at least; what is too many of them its head says.
  const auto unused = static_cast<unsigned>(kLeastSegment - std::min(here, kLeastSegment));
  out[0] = static_cast<std::uint8_t>(out[0] | unused << 1U);
  out.resize(std::max(out.size(), kSegmentHead + kLeastSegment));
  return {std::move(out)};
}

EscSdoServer::Answer EscSdoServer::start_download(ByteSpan request) {
  if (const auto code = complete_ ? 0 : store_->check_writable(object_); code != 0) return abort(code);
  const unsigned command = request[0];
  if ((command & kExpedited) != 0) {
    const std::size_t size = (command & kSized) != 0 ? 4 - (command >> 2U & 3U) : 4;
    if (const auto code = write(request.subspan(4, size)); code != 0) return abort(code);
    return {head(kDownloaded)};
  }
  if ((command & kSized) == 0) return abort(abort_code::kCommand);
  total_ = load_le(request.subspan(4, 4));
  const auto data = request.subspan(kSdoHead);
  if (data.size() > total_) return abort(abort_code::kTooLong);
  data_.assign(data.begin(), data.end());
  toggle_ = 0;
  if (data_.size() == total_) return finish_download();
  state_ = State::download;
  return {head(kDownloaded)};
}

EscSdoServer::Answer EscSdoServer::finish_download() {
  state_ = State::idle;
  if (const auto code = write(data_); code != 0) return abort(code);
  return {head(kDownloaded)};
}

EscSdoServer::Answer EscSdoServer::take_segment(ByteSpan request) {
  if (state_ != State::download) return abort(abort_code::kCommand);
  if ((request[0] & kToggle) != toggle_) return abort(abort_code::kToggle);
  auto data = request.subspan(kSegmentHead);
  if (data.size() == kLeastSegment) data = data.first(kLeastSegment - (request[0] >> 1U & 7U));
  data_.insert(data_.end(), data.begin(), data.end());
  if (data_.size() > total_) return abort(abort_code::kTooLong);
  Bytes out(kSdoHead, 0);
  out[0] = static_cast<std::uint8_t>(kDownloadedSegment | toggle_);
  toggle_ ^= kToggle;
  if ((request[0] & kLast) == 0) return {std::move(out)};
  if (data_.size() < total_) return abort(abort_code::kTooShort);
  const auto done = finish_download();
  return done.abort ? done : Answer{std::move(out)};
}

}  // namespace servoctl::sim
