#include "traffic/explained_frame.hpp"

#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "can/candump.hpp"
#include "can/trace.hpp"
#include "report/catalogue.hpp"
#include "traffic/frame_decoder.hpp"

namespace servoctl::traffic {
namespace {

std::optional<can::Frame> frame_in(std::string_view text) {
  if (auto frame = can::parse_frame(trim(text))) return frame;
  if (auto line = can::parse_log_line(text)) return line->frame;
  if (auto line = can::parse_candump_line(text)) return line->frame;
  return std::nullopt;
}

/// In one language, as `decode` says it, with the node before it.
std::string words_of_frame(const can::Frame& frame, const drive::Profile& profile, bool chinese) {
  FrameDecoder decoder({.profile = &profile, .chinese = chinese, .fields = false});
  const auto& decoded = decoder.decode(frame);
  std::string out;
  if (decoded.node) {
    const auto node = formatted("node {}", *decoded.node);
    out = chinese ? report::in_chinese(node) + "，" : node + ", ";
  }
  return out + std::string(decoded.service) + (chinese ? "：" : ": ") + decoded.text;
}

}  // namespace

std::optional<show::Explanation> explained_frame(std::string_view text, const drive::Profile& profile) {
  const auto frame = frame_in(text);
  if (!frame) return std::nullopt;
  drive::Topic topic;
  topic.family = profile.family;
  topic.kind = "frame";
  topic.name = can::to_string(*frame);
  topic.title = words_of_frame(*frame, profile, false);
  topic.title_zh = words_of_frame(*frame, profile, true);
  return show::Explanation{std::move(topic), show::Found::value};
}

}  // namespace servoctl::traffic
