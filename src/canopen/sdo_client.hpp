#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "base/time.hpp"
#include "can/frame.hpp"

namespace servoctl::canopen {

/// The client side of one SDO channel (CiA 301, 7.2.4): expedited and segmented transfers, one at a time.
/// Performs no I/O and reads no clock: give it frames and time, take frames and the result from it.
///
/// Frames of other nodes, answers for other objects (late ones of an earlier request) and remote frames are
/// ignored. Every transfer ends with exactly one result: the data, or Errc::sdo_abort, timeout or protocol
/// with node and object set. When the client gives up it tells the server with an abort.
class SdoClient {
 public:
  /// `node` 1..127; `timeout` is the longest silence of the server between two frames.
  SdoClient(std::uint8_t node, Duration timeout) : node_(node), timeout_(timeout) {}

  /// Reads an object. Must not be called while a transfer is under way.
  void start_upload(ObjectAddress object, TimePoint now);
  /// Writes an object: expedited up to 4 bytes, segmented above and for none.
  void start_download(ObjectAddress object, Bytes data, TimePoint now);

  void on_frame(const can::Frame& frame, TimePoint now);
  void on_time(TimePoint now);

  std::optional<can::Frame> take_frame();  ///< The next frame to send, if any.
  std::optional<Result<Bytes>>
  take_result();  ///< Set once, when the transfer has ended; empty bytes after a download.
  TimePoint deadline() const {
    return deadline_;
  }  ///< When on_time() has something to do; kNever while idle.
  bool busy() const { return state_ != State::idle; }
  std::uint8_t node() const { return node_; }

 private:
  enum class State : std::uint8_t {
    idle,
    upload_initiate,
    upload_segment,
    download_initiate,
    download_segment
  };

  void on_upload_initiate(const can::Frame& frame, TimePoint now);
  void on_upload_segment(const can::Frame& frame, TimePoint now);
  void on_download_initiate(const can::Frame& frame, TimePoint now);
  void on_download_segment(const can::Frame& frame, TimePoint now);
  void request_segment(TimePoint now);
  void send_segment(TimePoint now);
  void send(const can::Frame& frame, State next, TimePoint now);
  void abort(std::uint32_t code, Errc errc, std::string why, std::string hint = {});
  void finish(Result<Bytes> result);
  Error error(Errc code, std::string message, std::string hint = {}) const;

  std::uint8_t node_;
  Duration timeout_;
  State state_ = State::idle;
  ObjectAddress object_;
  Bytes data_;
  std::size_t offset_ = 0;
  std::optional<std::size_t> announced_;  ///< Size the server announced for a segmented upload.
  std::uint8_t toggle_ = 0;
  TimePoint deadline_ = kNever;
  std::optional<can::Frame> tx_;
  std::optional<Result<Bytes>> result_;
};

}  // namespace servoctl::canopen
