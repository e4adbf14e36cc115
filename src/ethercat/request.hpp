#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "base/bytes.hpp"
#include "base/time.hpp"
#include "ethercat/frame.hpp"

namespace servoctl::ethercat {

/// How one slave is addressed: by its place on the wire, which it always has, or by the station address that
/// the master gave it (0010h).
class SlaveAddress {
 public:
  /// 0 is the first slave.
  static constexpr SlaveAddress at_position(std::uint16_t position) {
    return {false, static_cast<std::uint16_t>(0U - position)};
  }
  static constexpr SlaveAddress station(std::uint16_t address) { return {true, address}; }

  constexpr Command read() const { return by_station_ ? Command::fprd : Command::aprd; }
  constexpr Command write() const { return by_station_ ? Command::fpwr : Command::apwr; }
  constexpr std::uint32_t at(std::uint16_t where) const { return physical_address(adp_, where); }

 private:
  constexpr SlaveAddress(bool by_station, std::uint16_t adp) : by_station_(by_station), adp_(adp) {}
  bool by_station_;
  std::uint16_t adp_;
};

/// What a machine asks of the wire: one datagram.
struct Request {
  Command command = Command::nop;
  std::uint32_t address = 0;
  Bytes data;
  bool repeatable = false;  ///< Sent again when its frame is lost or the slave does not count it: twice does
                            ///< what once does.
};

/// `size` bytes from `where` on. Not for a mailbox: reading it empties it.
inline Request read_registers(SlaveAddress slave, std::uint16_t where, std::size_t size) {
  return {slave.read(), slave.at(where), Bytes(size), true};
}
/// Not for a mailbox: the slave would take it twice.
inline Request write_registers(SlaveAddress slave, std::uint16_t where, Bytes data) {
  return {slave.write(), slave.at(where), std::move(data), true};
}
inline Request read_once(SlaveAddress slave, std::uint16_t where, std::size_t size) {
  return {slave.read(), slave.at(where), Bytes(size), false};
}
inline Request write_once(SlaveAddress slave, std::uint16_t where, Bytes data) {
  return {slave.write(), slave.at(where), std::move(data), false};
}

/// What became of a request.
struct Answer {
  ByteSpan data;                      ///< As it came back; valid until the ring takes a request again.
  std::uint16_t working_counter = 0;  ///< 0: no slave did it.
  bool lost = false;                  ///< The frame did not come back: whether it was done is not known.
  TimePoint sent;                     ///< When its frame was taken to be sent, the last time.
  std::uint16_t expected = 0;         ///< Counter of a request to one slave; 0: it went to all of them.

  /// It was done, by as many slaves as it was for. Any other counter is wrong: two slaves have one address,
  /// or the frame is not what the slaves made of it.
  bool done() const { return !lost && (expected == 0 ? working_counter != 0 : working_counter == expected); }
};

}  // namespace servoctl::ethercat
