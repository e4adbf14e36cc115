#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "base/bytes.hpp"
#include "base/result.hpp"
#include "base/time.hpp"
#include "ethercat/request.hpp"

namespace servoctl::ethercat {

/// Reads the SII of one slave through its registers 0500h to 050Fh (ETG.1000.4, 6.4), as far as its
/// categories go. Performs no I/O and reads no clock; a Carrier takes its requests.
///
/// Where the slave's own processor has the SII it is asked for it and gets it back; it is not taken by force.
/// What is wrong with the content is no error here: see parse_sii().
class SiiReader {
 public:
  /// `node` 1..127 is for messages; `timeout` is the longest that one access may take.
  SiiReader(std::uint8_t node, SlaveAddress slave, Duration timeout = std::chrono::milliseconds(100))
      : node_(node), slave_(slave), timeout_(timeout) {}

  /// The whole image: header and categories to their end, or to the end of the memory by word 3Eh.
  void start(TimePoint now);
  /// Words 0 to `words` only: 40h have the identity and the mailboxes.
  void start_head(std::size_t words, TimePoint now);

  std::optional<Request> take_request();
  void on_answer(const Answer& answer, TimePoint now);
  void on_time(TimePoint now);
  TimePoint deadline() const { return deadline_; }
  bool busy() const { return state_ != State::idle; }
  /// Set once: the image. Errc::timeout when the slave does not answer or its memory stays busy,
  /// Errc::protocol when it reports an error.
  std::optional<Result<Bytes>> take_result();

 private:
  enum class State : std::uint8_t {
    idle,
    ask_owner,
    take_over,
    ready,
    acknowledge,
    command,
    fetch,
    give_back,
  };

  void begin(std::size_t words, TimePoint now);
  void go(State state, TimePoint now, Duration pause = Duration{});
  void on_owner(ByteSpan data, TimePoint now);
  void on_ready(ByteSpan data, TimePoint now);
  void on_fetched(ByteSpan data, TimePoint now);
  void on_error(TimePoint now);
  void take_in(ByteSpan data, TimePoint now);
  std::size_t needed() const;
  void end(Result<Bytes> result, TimePoint now);
  Error error(Errc code, Message what, Message hint) const;

  std::uint8_t node_;
  SlaveAddress slave_;
  Duration timeout_;
  State state_ = State::idle;
  bool asking_ = false;    ///< A request is to be taken.
  bool lent_ = false;      ///< The processor gets the SII back.
  bool whole_ = false;     ///< The categories say where to end.
  unsigned errors_ = 0;    ///< In succession.
  std::size_t words_ = 0;  ///< To be read, unless the categories say it.
  TimePoint until_;        ///< The present access must be done by then.
  TimePoint deadline_ = kNever;
  Bytes image_;
  std::optional<Result<Bytes>> held_;  ///< Told when the SII was given back.
  std::optional<Result<Bytes>> result_;
};

}  // namespace servoctl::ethercat
