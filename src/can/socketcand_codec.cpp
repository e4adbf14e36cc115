#include "can/socketcand_codec.hpp"

#include <linux/can/error.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/format.hpp"
#include "base/hex.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::can {
namespace {

using Element = SocketcandElement;

constexpr std::size_t kMostElement = 300;
constexpr std::size_t kMostElements = 1U << 20U;
/// What the protocol allows (doc/protocol.md: at most 16 characters); a name of Linux has 15.
constexpr std::size_t kMostName = 15;

struct ElementWords {
  std::array<std::string_view, 5> at;
  std::size_t count = 0;
};

ElementWords element_words(std::string_view text) {
  ElementWords out;
  for (text = trim(text); !text.empty() && out.count < out.at.size(); text = trim(text)) {
    const auto end = std::min(text.find(' '), text.size());
    out.at[out.count++] = text.substr(0, end);
    text.remove_prefix(end);
  }
  return out;
}

/// `23.424242`
std::optional<Duration> server_time(std::string_view text) {
  const auto point = text.find('.');
  if (point == std::string_view::npos || point > 11 || text.size() != point + 7) return std::nullopt;
  const auto seconds = parse_digits(text.substr(0, point), 10);
  const auto fraction = parse_digits(text.substr(point + 1), 10);
  if (!seconds || !fraction) return std::nullopt;
  return Duration(static_cast<std::int64_t>(*seconds * 1'000'000 + *fraction));
}

bool read_id(std::string_view text, Frame& out) {
  const auto id = text.size() == 3 || text.size() == 8 ? parse_digits(text, 16) : std::nullopt;
  out.extended = text.size() == 8;
  if (!id || *id > (out.extended ? 0x1FFF'FFFFU : 0x7FFU)) return false;
  out.id = static_cast<std::uint32_t>(*id);
  return true;
}

bool read_frame_words(const ElementWords& words, Element& out) {
  const auto time = words.count == 3 || words.count == 4 ? server_time(words.at[2]) : std::nullopt;
  if (!time || !read_id(words.at[1], out.frame)) return false;
  const auto data = words.at[3];
  if (data.size() % 2 != 0 || data.size() > 2 * out.frame.data.size()) return false;
  for (std::size_t i = 0; i < data.size() / 2; ++i) {
    const auto byte = parse_digits(data.substr(2 * i, 2), 16);
    if (!byte) return false;
    out.frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  out.frame.size = static_cast<std::uint8_t>(data.size() / 2);
  out.time = *time;
  return true;
}

/// `error 004 23.424242`: the class of an error frame, without its data. Anything else is a sentence.
bool read_error_words(const ElementWords& words, Element& out) {
  const auto time = words.count == 3 ? server_time(words.at[2]) : std::nullopt;
  const auto id = parse_digits(words.at[1], 16);
  if (!time || !id || *id > 0x1FFF'FFFFU) return false;
  out.time = *time;
  out.frame.error = true;
  out.frame.id = static_cast<std::uint32_t>(*id);
  out.frame.size = CAN_ERR_DLC;
  return true;
}

Element parse_element(std::string_view text) {
  const auto words = element_words(text);
  Element out;
  const auto first = words.at[0];
  if (first == "hi" && words.count == 1) {
    out.kind = Element::Kind::hi;
  } else if (first == "ok" && words.count == 1) {
    out.kind = Element::Kind::ok;
  } else if (first == "echo" && words.count == 1) {
    out.kind = Element::Kind::echo;
  } else if (first == "frame") {
    out.kind = read_frame_words(words, out) ? Element::Kind::frame : Element::Kind::damaged;
  } else if (first == "error" && read_error_words(words, out)) {
    out.kind = Element::Kind::frame;
  } else if (first == "error") {
    out.kind = Element::Kind::refusal;
    out.text = trim(trim(text).substr(first.size()));
  }
  return out;
}

tl::unexpected<Error> no_server_place(std::string_view text, const Message& why) {
  return fail(
      Errc::usage, message("socketcand:{}: {}", as_it_is(text), why),
      "write socketcand://HOST/can0: the server, perhaps its port (socketcand://HOST:29536/can0), and the "
      "CAN interface that it has there");
}

}  // namespace

std::string SocketcandPlace::server() const {
  return host.find(':') == std::string::npos ? formatted("{}:{}", host, port)
                                             : formatted("[{}]:{}", host, port);
}

Result<SocketcandPlace> parse_socketcand_place(std::string_view text) {
  if (!text.starts_with("//")) return no_server_place(text, "// stands in front of the server");
  const auto rest = text.substr(2);
  const auto slash = rest.find('/');
  if (slash == std::string_view::npos || slash + 1 == rest.size())
    return no_server_place(text, "the CAN interface is missing");
  SocketcandPlace out;
  out.interface_name = rest.substr(slash + 1);
  if (out.interface_name.size() > kMostName ||
      out.interface_name.find_first_of(" \t\r\n<>/") != std::string::npos)
    return no_server_place(text, message("'{}' is no name of an interface", as_it_is(out.interface_name)));
  auto server = rest.substr(0, slash);
  const auto bracket = server.starts_with('[') ? server.find(']') : std::string_view::npos;
  const auto colon = server.find(':', bracket == std::string_view::npos ? 0 : bracket);
  auto host = server.substr(0, colon);
  if (bracket != std::string_view::npos && host.size() == bracket + 1) host = host.substr(1, bracket - 1);
  if (host.empty() || host.find_first_of(" \t\r\n[]@") != std::string_view::npos)
    return no_server_place(text, "the server is missing");
  out.host = host;
  if (colon == std::string_view::npos) return out;
  const auto port = parse_digits(server.substr(colon + 1), 10);
  if (!port || *port == 0 || *port > 0xFFFF)
    return no_server_place(text, message("'{}' is no port", as_it_is(server.substr(colon + 1))));
  out.port = static_cast<std::uint16_t>(*port);
  return out;
}

void SocketcandReader::put(std::string_view bytes) {
  for (const char byte : bytes) {
    if (byte == '<') {
      if (inside_) add({.kind = Element::Kind::damaged});
      element_.clear();
      inside_ = true;
      garbage_ = false;
    } else if (byte == '>' && inside_) {
      end_element();
    } else if (inside_ && element_.size() < kMostElement) {
      element_ += byte == '\r' || byte == '\n' || byte == '\t' ? ' ' : byte;
    } else if (inside_) {
      add({.kind = Element::Kind::damaged});
      inside_ = false;
      garbage_ = true;
    } else if (byte != ' ' && byte != '\r' && byte != '\n' && !std::exchange(garbage_, true)) {
      add({.kind = Element::Kind::damaged});
    }
  }
}

void SocketcandReader::end_element() {
  inside_ = false;
  add(parse_element(element_));
}

void SocketcandReader::add(SocketcandElement element) {
  if (elements_.size() < kMostElements) elements_.push_back(std::move(element));
}

std::optional<SocketcandElement> SocketcandReader::take() {
  if (elements_.empty()) return std::nullopt;
  auto out = std::move(elements_.front());
  elements_.pop_front();
  return out;
}

std::string socketcand_send(const Frame& frame) {
  std::string out = "< send ";
  append_hex(frame.id, frame.extended ? 8 : 3, out);
  out += formatted(" {}", frame.size);
  for (const auto byte : frame.payload()) out += formatted(" {:x}", byte);
  return out += " >";
}

}  // namespace servoctl::can
