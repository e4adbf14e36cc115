// Clients and gateways of CiA 309-3 that say anything: lines are the same however they are cut and take no
// room, what is read is written and read again, and an answer is one line.
#include <algorithm>
#include <string>
#include <vector>

#include "base/base64.hpp"
#include "gateway/address.hpp"
#include "gateway/answer.hpp"
#include "gateway/client.hpp"
#include "gateway/line_reader.hpp"
#include "gateway/request.hpp"
#include "gateway/value.hpp"
#include "gateway/words.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

namespace {

constexpr std::size_t kLongest = 64;

std::vector<gateway::LineReader::Line> lines_in(std::string_view bytes, std::size_t piece) {
  gateway::LineReader reader(kLongest);
  std::vector<gateway::LineReader::Line> out;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    reader.put(bytes.substr(at, piece));
    while (auto line = reader.take()) out.push_back(std::move(*line));
    fuzz::require(reader.pending() <= kLongest, "a line without an end takes no room");
  }
  return out;
}

void check_value(std::span<const std::string> words) {
  if (words.size() < 2) return;
  const auto type = gateway::parse_value_type(words.front());
  if (!type) return;
  const auto bytes = gateway::parse_value(*type, words.subspan(1));
  if (!bytes) return;
  fuzz::require(!bytes->empty(), "no value has no bytes");
  const auto text = gateway::value_text(*type, *bytes);
  fuzz::require(text.find_first_of("\r\n") == std::string::npos, "a value is no line of its own");
  // What ends a line is left out of a text.
  if (type->form == gateway::ValueType::Form::text) return;
  const auto again = gateway::split_words(text);
  fuzz::require(again.has_value(), "a value that is written is words");
  const auto read = gateway::parse_value(*type, *again);
  fuzz::require(read && *read == *bytes, "a value that is written is read again");
}

void check_request(const std::string& line) {
  const auto words = gateway::split_words(line);
  if (!words) return;
  const auto request = gateway::take_apart(*words);
  fuzz::require(request.numbers.size() <= 2, "a network and a node");
  (void)gateway::service_of(request);
  (void)gateway::object_of(request);
  if (request.words.size() > 3) check_value(std::span(request.words).subspan(3));
  check_value(request.words);
}

void check_one_line(const std::string& text) {
  fuzz::require(text.ends_with("\r\n") && std::count(text.begin(), text.end(), '\n') == 1,
                "an answer is a line");
}

void check_answer(const std::string& line) {
  check_one_line(gateway::error_line(1, gateway::Code::syntax, line));
  check_one_line(gateway::failure_line(1, make_error(Errc::protocol, line)));
  const auto answer = gateway::parse_answer(line);
  if (!answer || answer->kind != gateway::Answer::Kind::value) return;
  const auto again = gateway::parse_answer(gateway::value_line(answer->sequence, answer->text));
  fuzz::require(again && again->sequence == answer->sequence && again->text == answer->text,
                "a value that is written is read again");
  if (const auto bytes = parse_base64(answer->text))
    fuzz::require(parse_base64(to_base64(*bytes)) == bytes, "base64 goes both ways");
}

/// What a client makes of the answers, as one text.
std::string outcomes_of(std::string_view bytes, std::size_t piece) {
  gateway::Client client;
  TimePoint now{};
  std::string out;
  (void)client.start("1 1 r 0x1000 0 d", now, std::chrono::seconds(1));
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    client.on_bytes(bytes.substr(at, piece), now);
    client.on_time(now);
    while (const auto outcome = client.take_outcome()) {
      fuzz::require(outcome->answer.sequence == 1 && !outcome->silent, "only its own answer is one");
      out += outcome->answer.text + "\n";
    }
  }
  for (int steps = 0; client.busy(); ++steps) {
    fuzz::require(steps < 10, "a gateway that is silent is given up");
    now = std::max(now, client.deadline());
    client.on_time(now);
  }
  return out;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = fuzz::text(data, size);
  const auto lines = lines_in(input, input.size() + 1);
  const auto cut = lines_in(input, 1);
  fuzz::require(lines.size() == cut.size(), "a cut makes no line");
  for (std::size_t i = 0; i < lines.size(); ++i) {
    fuzz::require(lines[i].text == cut[i].text && lines[i].too_long == cut[i].too_long,
                  "a cut changes no line");
    check_request(lines[i].text);
    check_answer(lines[i].text);
  }
  fuzz::require(outcomes_of(input, input.size() + 1) == outcomes_of(input, 1), "a cut changes no answer");
  (void)gateway::parse_place(input);
  if (const auto url = gateway::parse_url(input)) (void)url->is_local();
  return 0;
}
