// SDO frames that are too short.
#include "report/told.hpp"
#include "show/reading.hpp"
#include "traffic/frame_decoder.hpp"
#include "traffic/sdo_words.hpp"

namespace servoctl::traffic {

/// Such a frame is none of CiA 301 (7.2.4.3: 8 bytes), and drives answer it or not, as they like: what its
/// bytes would say is shown as far as they are there, and not learnt.
void FrameDecoder::tell_short_sdo(const can::Frame& frame, bool from_client) {
  out_.text = report::told(options_.chinese, "SDO frame with {} of 8 bytes", frame.size);
  auto whole = frame;
  whole.size = static_cast<std::uint8_t>(whole.data.size());
  canopen::SdoObserver observer;
  const auto step = from_client ? observer.on_client_frame(whole) : observer.on_server_frame(whole);
  constexpr std::size_t kHead = 4;
  if (!step.object || step.kind == canopen::SdoStep::Kind::abort || frame.size < kHead) return;
  const auto target = drive::target_at(family_of(*out_.node), *step.object);
  auto says = step_text(step, name_of(target), {}, options_.chinese);
  if (step.data && frame.size >= kHead + step.data->size())
    says += " = " + show::decode_value({*out_.node, target, {}, Bytes{}}, *step.data).text;
  out_.text = report::told(options_.chinese, "SDO frame with {} of 8 bytes: {}", frame.size, says);
  out_.objects.push_back(*step.object);
}

}  // namespace servoctl::traffic
