// A server that says anything: elements are the same however they are cut, frames are frames of the bus, and
// the dialogue ends or goes on, but never floods.
#include "can/socketcand_codec.hpp"
#include "can/socketcand_dialogue.hpp"

#include <algorithm>
#include <vector>

#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

namespace {

std::vector<can::SocketcandElement> elements_in(std::string_view bytes, std::size_t piece) {
  can::SocketcandReader reader;
  for (std::size_t at = 0; at < bytes.size(); at += piece) reader.put(bytes.substr(at, piece));
  std::vector<can::SocketcandElement> out;
  while (auto element = reader.take()) out.push_back(std::move(*element));
  return out;
}

void check_frame(const can::SocketcandElement& element) {
  if (element.kind != can::SocketcandElement::Kind::frame) return;
  fuzz::require(element.frame.size <= 8, "a classical frame has at most 8 bytes");
  fuzz::require(element.frame.id <= 0x1FFF'FFFFU, "an identifier has at most 29 bits");
  fuzz::require(element.time >= Duration::zero(), "no time lies before 1970");
}

void talk(const std::vector<can::SocketcandElement>& elements, Duration distance) {
  TimePoint now{};
  can::SocketcandDialogue dialogue("can0", now);
  for (const auto& element : elements) {
    now += distance;
    dialogue.on_life(now);
    dialogue.on_element(element, now);
    dialogue.on_time(now);
    if (dialogue.state() == can::SocketcandDialogue::State::raw && dialogue.has_room(30))
      dialogue.on_sent(30, now);
    fuzz::require(dialogue.take_text().size() < 100, "a word is answered by a word");
  }
  for (int steps = 0; dialogue.deadline() != kNever; ++steps) {
    fuzz::require(steps < 100, "a server that is silent is given up");
    now = std::max(now, dialogue.deadline());
    dialogue.on_time(now);
    (void)dialogue.take_text();
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = fuzz::text(data, size);
  const auto elements = elements_in(input, input.size() + 1);
  const auto cut = elements_in(input, 1);
  fuzz::require(elements.size() == cut.size(), "a cut makes no element");
  for (std::size_t i = 0; i < elements.size(); ++i) {
    fuzz::require(elements[i].kind == cut[i].kind && elements[i].frame == cut[i].frame,
                  "a cut changes no element");
    check_frame(elements[i]);
  }
  for (const int distance : {0, 100'000, 1'500'000}) talk(elements, Duration(distance));
  (void)can::parse_socketcand_place(input);
  return 0;
}
