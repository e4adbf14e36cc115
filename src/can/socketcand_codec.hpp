#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "base/time.hpp"
#include "can/frame.hpp"

/// The protocol of socketcand (linux-can/socketcand, doc/protocol.md), raw mode: elements `< word … >` of
/// ASCII, one after the other.
namespace servoctl::can {

/// What stands behind `socketcand:`.
struct SocketcandPlace {
  static constexpr std::uint16_t kPort = 29536;
  std::string host;
  std::uint16_t port = kPort;
  std::string interface_name;  ///< Of the server, such as `can0`.
  bool operator==(const SocketcandPlace&) const = default;
  /// `host:29536`, for messages.
  std::string server() const;
};

/// Reads `//host:29536/can0`, `//[fe80::1]/can0`; Errc::usage with the form.
Result<SocketcandPlace> parse_socketcand_place(std::string_view text);

/// What the server said.
struct SocketcandElement {
  enum class Kind : std::uint8_t {
    hi,
    ok,
    echo,
    frame,  ///< `< frame 581 1700000000.123456 4300100092010200 >`; also `< error 004 … >`, an error frame.
    refusal,  ///< `< error could not open bus >`
    other,    ///< Anything else that is an element.
    damaged,  ///< No element, or one that is no whole frame.
  };
  Kind kind = Kind::other;
  Frame frame = {};
  Duration time{};        ///< Of `frame`: by the server's clock, since 1970.
  std::string text = {};  ///< Of `refusal`: why.
};

/// Makes elements of bytes, however they were cut.
class SocketcandReader {
 public:
  void put(std::string_view bytes);
  std::optional<SocketcandElement> take();

 private:
  void end_element();
  void add(SocketcandElement element);

  std::string element_;
  bool inside_ = false;   ///< Of an element.
  bool garbage_ = false;  ///< Something stood outside since the last element, and was counted.
  std::deque<SocketcandElement> elements_;
};

/// `< send 601 8 40 41 60 0 0 0 0 0 >`. The protocol has no remote frames.
std::string socketcand_send(const Frame& frame);

}  // namespace servoctl::can
