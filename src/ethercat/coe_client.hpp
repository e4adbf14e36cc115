#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "base/time.hpp"
#include "canopen/sdo_core.hpp"
#include "canopen/transfer.hpp"

namespace servoctl::ethercat {

/// The client side of SDO over a mailbox (ETG.1000.6, 5.6.2): one transfer at a time. Performs no I/O and
/// reads no clock: give it messages and time, take messages and the result from it. The face is that of
/// canopen::SdoClient.
///
/// Answers that come late and other services are ignored; what is doubtful is checked as canopen::SdoClient
/// does it. Every transfer ends with exactly one result: the data, or Errc::sdo_abort, timeout or protocol
/// with node and object set. When the client gives up it tells the server with an abort.
class CoeClient {
 public:
  /// `node` 1..127; `timeout` is the longest silence between two messages; `max_message` is what one message
  /// to the slave can have, its mailbox without the header: 10 at least.
  CoeClient(std::uint8_t node, Duration timeout, std::size_t max_message)
      : node_(node), core_(timeout), max_message_(std::max<std::size_t>(max_message, 10)) {}

  /// Reads an object, with `complete` all its entries at once from sub-index 0 or 1 on (one byte of sub-index
  /// 0 and one of padding, then the entries). Must not be called while a transfer is under way.
  /// Transfer::expedited refuses an answer of more than 4 bytes; there are no blocks: Transfer::block is
  /// refused with Errc::usage. `again` as canopen::SdoClient's.
  void start_upload(ObjectAddress object, TimePoint now,
                    canopen::Transfer transfer = canopen::Transfer::automatic, bool complete = false,
                    bool again = false);
  /// Writes an object. With Transfer::automatic: expedited up to 4 bytes, else in as many messages as it
  /// takes.
  void start_download(ObjectAddress object, Bytes data, TimePoint now,
                      canopen::Transfer transfer = canopen::Transfer::automatic, bool complete = false);
  /// The longest silence from now on. Must not be called while a transfer is under way.
  void set_timeout(Duration timeout) { core_.set_timeout(timeout); }

  /// A CoE message came.
  void on_message(ByteSpan message, TimePoint now);
  /// A CoE message came that was there before the present request: an answer to an earlier one at most.
  void on_early(ByteSpan message, TimePoint now);
  /// The slave refused the message itself; see mailbox_error_text().
  void on_refusal(std::uint16_t detail);
  /// The message could not be sent; `what` is a phrase.
  void on_failure(Errc code, std::string what, std::string hint);
  void on_time(TimePoint now);

  bool may_send() const { return tx_.has_value(); }  ///< Whether take_message() gives one.
  std::optional<Bytes> take_message();               ///< The next message to send, if any.
  std::optional<Result<Bytes>>
  take_result();  ///< Set once, when the transfer has ended; empty bytes after a download.
  TimePoint deadline() const { return core_.deadline(); }
  bool busy() const { return state_ != State::idle; }
  std::uint8_t node() const { return node_; }
  Duration timeout() const { return core_.timeout(); }
  std::size_t transferred() const;  ///< Bytes of this transfer that the other side has, or that came.
  std::optional<std::size_t> total() const { return announced_; }

 private:
  enum class State : std::uint8_t {
    idle,
    resync,  ///< As canopen::SdoClient's.
    upload_initiate,
    upload_segment,
    download_initiate,
    download_segment
  };

  bool begin(ObjectAddress object, canopen::Transfer transfer, bool again);
  void begin_upload(TimePoint now);
  /// As canopen::SdoClient's.
  bool is_anonymous() const { return state_ == State::upload_segment || state_ == State::download_segment; }
  static std::uint8_t first_command(ByteSpan message);
  bool is_first_answer(ByteSpan message, TimePoint now);
  void check(TimePoint now);
  void on_check(TimePoint now);
  void end_in_doubt();
  void on_abort(ByteSpan message);
  void on_upload_initiate(ByteSpan message, TimePoint now);
  void on_expedited(ByteSpan message);
  void on_upload_segment(ByteSpan message, TimePoint now);
  void on_download_initiate(ByteSpan message, TimePoint now);
  void on_download_segment(ByteSpan message, TimePoint now);
  void request_segment(TimePoint now);
  void send_segment(TimePoint now);
  void send(Bytes message, State next, TimePoint now);
  void abort(std::uint32_t code, Errc errc, std::string why, std::string hint = {});
  void finish(Result<Bytes> result);
  Error error(Errc code, Message message, Message hint = {}) const;

  std::uint8_t node_;
  canopen::SdoCore core_;
  std::size_t max_message_;
  State state_ = State::idle;
  ObjectAddress object_;
  canopen::Transfer transfer_ = canopen::Transfer::automatic;
  Bytes data_;
  std::size_t offset_ = 0;
  std::optional<std::size_t> announced_;
  std::uint8_t toggle_ = 0;
  bool complete_ = false;        ///< A read of all entries.
  ObjectAddress check_;          ///< What is read in State::resync.
  bool is_shadowed_ = false;     ///< Of this object something older may still be answered.
  bool check_answered_ = false;  ///< Perhaps an earlier reading of it.
  std::optional<Bytes> tx_;
};

}  // namespace servoctl::ethercat
