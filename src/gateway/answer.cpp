#include "gateway/answer.hpp"

#include <array>
#include <limits>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::gateway {
namespace {

constexpr std::array kTexts{
    std::pair{100U, std::string_view("Request not supported")},
    std::pair{101U, std::string_view("Syntax error")},
    std::pair{102U, std::string_view("Request not processed due to internal state")},
    std::pair{103U, std::string_view("Time-out")},
    std::pair{104U, std::string_view("No default net set")},
    std::pair{105U, std::string_view("No default node set")},
    std::pair{106U, std::string_view("Unsupported net")},
    std::pair{107U, std::string_view("Unsupported node")},
    std::pair{200U, std::string_view("Lost guarding message")},
    std::pair{201U, std::string_view("Lost connection")},
    std::pair{202U, std::string_view("Heartbeat started")},
    std::pair{203U, std::string_view("Heartbeat lost")},
    std::pair{204U, std::string_view("Wrong NMT state")},
    std::pair{205U, std::string_view("Boot-up")},
    std::pair{300U, std::string_view("Error passive")},
    std::pair{301U, std::string_view("Bus off")},
    std::pair{303U, std::string_view("CAN buffer overflow")},
    std::pair{304U, std::string_view("CAN init")},
    std::pair{305U, std::string_view("CAN active")},
    std::pair{400U, std::string_view("PDO already used")},
    std::pair{401U, std::string_view("PDO length exceeded")},
    std::pair{501U, std::string_view("LSS manufacturer-specific error")},
    std::pair{502U, std::string_view("LSS node-ID not supported")},
    std::pair{503U, std::string_view("LSS bit-rate not supported")},
    std::pair{504U, std::string_view("LSS parameter storing failed")},
    std::pair{505U, std::string_view("LSS command failed because of media error")},
    std::pair{600U, std::string_view("Running out of memory")},
};

/// What stands in front of the digits of a code decides of which kind it is: CANopenNode writes abort codes
/// with 0x, lely-core eight hexadecimal digits without.
void read_error(std::string_view text, Answer& out) {
  text = trim(text);
  const auto end = text.find_first_of(" \t#(");
  const auto word = text.substr(0, end);
  out.text = end == std::string_view::npos ? std::string() : std::string(trim(text.substr(end)));
  const bool prefixed = starts_with_nocase(word, "0x");
  out.kind = prefixed || word.size() == 8 ? Answer::Kind::abort : Answer::Kind::error;
  const auto number = out.kind == Answer::Kind::abort ? parse_digits(prefixed ? word.substr(2) : word, 16)
                                                      : parse_digits(word, 10);
  if (number && *number <= std::numeric_limits<std::uint32_t>::max()) {
    out.number = static_cast<std::uint32_t>(*number);
    return;
  }
  out.kind = Answer::Kind::error;
  out.text = std::string(text);
}

}  // namespace

std::string_view code_text(unsigned code) {
  for (const auto& [known, text] : kTexts)
    if (known == code) return text;
  return {};
}

std::string ok_line(std::uint32_t sequence) { return formatted("[{}] OK\r\n", sequence); }

std::string value_line(std::uint32_t sequence, std::string_view value) {
  return formatted("[{}] {}\r\n", sequence, value);
}

std::string error_line(std::uint32_t sequence, Code code, std::string_view why) {
  const auto number = static_cast<unsigned>(code);
  return formatted("[{}] ERROR:{} #{}{}{}.\r\n", sequence, number, code_text(number), why.empty() ? "" : ": ",
                   printable(why));
}

std::string failure_line(std::uint32_t sequence, const Error& error) {
  auto code = error.abort_code;
  if (error.code == Errc::timeout) code = canopen::sdo_abort::kTimeout;
  if (error.code == Errc::protocol) code = canopen::sdo_abort::kCommand;
  if (!code) return error_line(sequence, Code::internal_state, error.message.text());
  auto why = error.code == Errc::protocol ? printable(error.message.text()) : canopen::sdo_abort_text(*code);
  // What is known of a node that did not answer in time is what to do about it.
  if (error.code == Errc::timeout && !error.hint.empty()) why += ": " + printable(error.hint.text());
  return formatted("[{}] ERROR:0x{:08X} #{}.\r\n", sequence, *code, why);
}

std::optional<Answer> parse_answer(std::string_view line) {
  line = trim(line);
  if (line.empty()) return std::nullopt;
  Answer out;
  out.text = std::string(line);
  const auto end = line.find(']');
  if (line.front() != '[' || end == std::string_view::npos) return out;
  const auto sequence = parse_digits(trim(line.substr(1, end - 1)), 10);
  if (!sequence || *sequence > std::numeric_limits<std::uint32_t>::max()) return out;
  out.sequence = static_cast<std::uint32_t>(*sequence);
  const auto rest = trim(line.substr(end + 1));
  constexpr std::string_view kError = "ERROR:";
  if (rest.starts_with(kError)) {
    read_error(rest.substr(kError.size()), out);
    return out;
  }
  out.kind = rest == "OK" ? Answer::Kind::ok : Answer::Kind::value;
  out.text = std::string(rest);
  return out;
}

}  // namespace servoctl::gateway
