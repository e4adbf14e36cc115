#include "canopen/duplicate_watch.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {
namespace {

constexpr std::size_t kRemembered = 8;
constexpr std::ptrdiff_t kProof = 3;
constexpr std::size_t kMostOpen = 32;
constexpr std::size_t kMostConstants = 16;
/// A drive needs longer to start; two that get their supply at the same moment are not so far apart.
constexpr Duration kBootWindow = std::chrono::milliseconds(500);
/// One frame behind the other: the bus may have doubled it.
constexpr Duration kDoubledFrame = std::chrono::milliseconds(2);
/// After the end of a block transfer late acknowledges may follow; without any end it is over by then.
constexpr Duration kBlockSettles = std::chrono::milliseconds(200);
constexpr Duration kBlockEnds = std::chrono::seconds(1);

/// Command specifiers in the upper three bits of byte 0 (CiA 301, 7.2.4.3).
constexpr std::uint8_t kDownloadSegment = 0;
constexpr std::uint8_t kDownload = 1;
constexpr std::uint8_t kUpload = 2;
constexpr std::uint8_t kUploadSegment = 3;
constexpr std::uint8_t kBlockUpload = 5;
constexpr std::uint8_t kBlockDownload = 6;
constexpr std::uint8_t kUploadAnswer = 2;
constexpr std::uint8_t kDownloadAnswer = 3;

constexpr std::uint8_t kEndOfBlockUpload = 0xA1;

std::uint8_t specifier(const can::Frame& frame) { return static_cast<std::uint8_t>(frame.data[0] >> 5U); }
bool is_abort(const can::Frame& frame) { return frame.data[0] == kSdoAbortCommand; }
bool ends_block(const can::Frame& frame) {
  return is_abort(frame) || frame.data[0] == kEndOfBlockUpload ||
         (specifier(frame) == kBlockDownload && (frame.data[0] & 0x01U) != 0);
}

/// Its value stays the same as long as the device does (CiA 301, 7.5.2).
bool is_constant(ObjectAddress object) {
  switch (object.index) {
    case 0x1000:
    case 0x1008:
    case 0x1009:
    case 0x100A: return object.sub == 0;
    case 0x1018: return object.sub >= 1 && object.sub <= 4;
    default: return false;
  }
}

/// What an answer to a read says, for comparing and showing; the size of a text that comes in segments.
std::string content(const std::array<std::uint8_t, 8>& data) {
  const auto number = static_cast<std::uint32_t>(data[4]) | static_cast<std::uint32_t>(data[5]) << 8U |
                      static_cast<std::uint32_t>(data[6]) << 16U | static_cast<std::uint32_t>(data[7]) << 24U;
  if (data[0] == kSdoAbortCommand) return formatted("abort 0x{:08X}", number);
  if ((data[0] & 0x02U) == 0) return formatted("a text of {} bytes", number);
  return formatted("0x{:08X}", number);
}

bool is_sdo(const can::Frame& frame, std::uint32_t base) {
  return !frame.extended && !frame.remote && !frame.error && frame.size == 8 && frame.id > base &&
         frame.id <= base + kLastNode;
}

}  // namespace

void DuplicateWatch::on_sent(const can::Frame& frame, TimePoint now) {
  if (is_sdo(frame, kSdoRequest)) on_request(static_cast<std::uint8_t>(frame.id & 0x7FU), frame, now);
  if (!frame.extended && frame.id == kNmt) on_reset(frame);
}

void DuplicateWatch::on_frame(const can::Frame& frame, TimePoint now) {
  if (frame.extended || frame.error) return;
  const auto node = static_cast<std::uint8_t>(frame.id & 0x7FU);
  if (is_sdo(frame, kSdoAnswer)) return on_answer(node, frame, now);
  if (is_sdo(frame, kSdoRequest)) return on_request(node, frame, now);
  if (frame.id == kNmt) return on_reset(frame);
  if (frame.remote || frame.id < kErrorControl) return;
  if (const auto message = parse_error_control(frame); message && message->boot_up)
    on_boot_up(message->node, now);
}

void DuplicateWatch::on_request(std::uint8_t id, const can::Frame& frame, TimePoint now) {
  auto& node = nodes_[id];
  if (node.block && now - node.block_seen > kBlockEnds) node.block = false;
  if (node.block) {
    node.block_seen = now;
    if (ends_block(frame)) node.block = false;
    return;
  }
  if (is_abort(frame)) return;  // Nobody answers it; what was given up may still be answered.
  switch (specifier(frame)) {
    case kUpload:
    case kDownload:
      node.transfer = sdo_object(frame);
      node.open.push_back({node.transfer, false, now});
      break;
    case kUploadSegment:
    case kDownloadSegment: node.open.push_back({node.transfer, true, now}); break;
    case kBlockUpload:
    case kBlockDownload:
      node.block = true;
      node.block_seen = now;
      node.open.clear();
      break;
    default: break;
  }
  if (node.open.size() > kMostOpen) node.open.erase(node.open.begin());
}

std::vector<DuplicateWatch::Request>::iterator DuplicateWatch::request_of(Node& node,
                                                                          const can::Frame& answer) {
  const bool segment = specifier(answer) < kUploadAnswer;
  return std::find_if(node.open.begin(), node.open.end(), [&](const Request& request) {
    if (is_abort(answer)) return request.object == sdo_object(answer);
    return request.segment == segment && (segment || request.object == sdo_object(answer));
  });
}

void DuplicateWatch::on_answer(std::uint8_t id, const can::Frame& frame, TimePoint now) {
  auto& node = nodes_[id];
  if (node.block) {
    node.block_seen = now;
    return;
  }
  if (!is_abort(frame) && specifier(frame) > kDownloadAnswer) return;
  if (specifier(frame) == kUploadAnswer || is_abort(frame)) check_constant(id, frame, now);
  const auto request = request_of(node, frame);
  if (request == node.open.end()) return on_surplus(id, frame, now);
  slowest_ = std::max<Duration>(slowest_, now - request->time);
  last_answer_ = now;
  if (!request->segment) node.answered.push_back({request->object, request->time, false});
  if (node.answered.size() > kRemembered) node.answered.erase(node.answered.begin());
  node.open.erase(request);
}

/// An answer nobody has asked for: the second one to a request that was answered, if it can be told which.
void DuplicateWatch::on_surplus(std::uint8_t id, const can::Frame& frame, TimePoint now) {
  auto& node = nodes_[id];
  if (!is_abort(frame) && specifier(frame) < kUploadAnswer) return;
  if (node.block_seen != TimePoint::min() && now - node.block_seen < kBlockSettles) return;
  const auto first = std::find_if(node.answered.begin(), node.answered.end(), [&](const Answered& answered) {
    return !answered.twice && answered.object == sdo_object(frame);
  });
  if (first == node.answered.end()) return;
  first->twice = true;
  slowest_second_ = std::max<Duration>(slowest_second_, now - first->asked);
  const auto twice = std::count_if(node.answered.begin(), node.answered.end(),
                                   [](const Answered& answered) { return answered.twice; });
  if (twice >= kProof)
    notice(id, formatted("{} of its last {} SDO responses came twice", twice, node.answered.size()), now);
}

void DuplicateWatch::check_constant(std::uint8_t id, const can::Frame& frame, TimePoint now) {
  auto& node = nodes_[id];
  const auto object = sdo_object(frame);
  if (!is_constant(object)) return;
  const auto known = std::find_if(node.constants.begin(), node.constants.end(),
                                  [&](const Constant& constant) { return constant.object == object; });
  if (known == node.constants.end()) {
    if (node.constants.size() == kMostConstants) return;
    node.constants.push_back({object, {}});
    std::copy(frame.data.begin(), frame.data.begin() + 8, node.constants.back().data.begin());
    return;
  }
  std::array<std::uint8_t, 8> data{};
  std::copy(frame.data.begin(), frame.data.begin() + 8, data.begin());
  // An abort tells of the moment, too: a drive that is busy may refuse what it gives at another time.
  if (data == known->data || is_abort(frame) || known->data[0] == kSdoAbortCommand) return;
  notice(id,
         formatted("{} was answered by {} and by {}", to_string(object), content(known->data), content(data)),
         now);
}

void DuplicateWatch::on_reset(const can::Frame& frame) {
  const auto message = parse_nmt(frame);
  if (!message ||
      (message->command != NmtCommand::reset_node && message->command != NmtCommand::reset_communication))
    return;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (message->node == 0 || message->node == i) ++nodes_[i].resets;
}

void DuplicateWatch::on_boot_up(std::uint8_t id, TimePoint now) {
  auto& node = nodes_[id];
  const bool explained = node.resets > 0;
  const auto gap = node.boot ? now - *node.boot : Duration::max();
  if (!explained && gap < kBootWindow && gap > kDoubledFrame)
    notice(id,
           formatted("two boot-ups within {} ms, unless one node keeps restarting",
                     std::chrono::duration_cast<std::chrono::milliseconds>(gap).count()),
           now);
  node = Node{.open = {},
              .answered = {},
              .constants = {},
              .transfer = {},
              .block = false,
              .block_seen = TimePoint::min(),
              .boot = now,
              .resets = explained ? node.resets - 1 : 0,
              .noticed = std::move(node.noticed)};
}

bool DuplicateWatch::is_suspect(std::uint8_t node) const {
  const auto& answered = nodes_[node].answered;
  return nodes_[node].noticed.empty() &&
         std::any_of(answered.begin(), answered.end(), [](const Answered& a) { return a.twice; });
}

void DuplicateWatch::notice(std::uint8_t id, std::string what, TimePoint now) {
  auto& node = nodes_[id];
  if (!node.noticed.empty()) return;
  node.noticed = std::move(what);
  events_.push_back({now, id, NodeEvent::Doubled{node.noticed}});
}

std::optional<NodeEvent> DuplicateWatch::take_event() {
  if (events_.empty()) return std::nullopt;
  auto event = std::move(events_.front());
  events_.pop_front();
  return event;
}

}  // namespace servoctl::canopen
