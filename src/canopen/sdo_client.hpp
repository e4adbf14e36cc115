#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "base/time.hpp"
#include "can/frame.hpp"
#include "canopen/sdo_block.hpp"
#include "canopen/sdo_core.hpp"
#include "canopen/sdo_habits.hpp"
#include "canopen/transfer.hpp"

namespace servoctl::canopen {

/// A write of more bytes than these is tried as a block transfer first.
inline constexpr std::size_t kBlockWorthwhile = 64;

/// The client side of one SDO channel (CiA 301, 7.2.4): one transfer at a time. Performs no I/O and reads no
/// clock: give it frames and time, take frames and the result from it.
///
/// Frames of other nodes, late answers to an earlier request and remote frames are ignored. Before an object
/// is read again whose last read may still be answered, another object is read that every node has: behind
/// that answer none is late. A write goes out at once; where its answer may be that to an earlier write of
/// the object, it ends with Errc::timeout: whether it was done is not known. All frames of the channel have
/// to be given, also between transfers: answers that come late are known by them. Every transfer ends with
/// exactly one result: the data, or Errc::sdo_abort, timeout or protocol with node and object set. When the
/// client gives up it tells the server with an abort. After a boot-up message of the node the answer has 100
/// ms more: without it the transfer ends as by a timeout. Where block transfer is tried and refused as such,
/// the transfer is made in segments.
class SdoClient {
 public:
  /// `node` 1..127; `timeout` is the longest silence of the server between two frames.
  SdoClient(std::uint8_t node, Duration timeout) : node_(node), core_(timeout) {}

  /// Reads an object. Must not be called while a transfer is under way. `size` is how many bytes the object
  /// has, 1..4, if that is known: servers may answer in one frame without saying it. `again`: it is a further
  /// try of the read before it, and a late answer to that one will do.
  void start_upload(ObjectAddress object, TimePoint now, Transfer transfer = Transfer::automatic,
                    std::size_t size = 0, bool again = false);
  /// Writes an object. With Transfer::automatic: expedited up to 4 bytes, in segments or blocks above and for
  /// none. With Transfer::expedited, 1 to 4 bytes only.
  void start_download(ObjectAddress object, Bytes data, TimePoint now,
                      Transfer transfer = Transfer::automatic);
  /// Does not wait for the second copy of an older answer, as a transfer of a node whose answers come twice
  /// does: for a write that must not wait. Such a copy may be taken for its answer then.
  void go_at_once(TimePoint now) {
    if (state_ == State::copy) begin_wanted(now);
  }

  /// The longest silence from now on. Must not be called while a transfer is under way.
  void set_timeout(Duration timeout) { core_.set_timeout(timeout); }

  /// A frame that another client of this process has sent to the node.
  void overhear(const can::Frame& request, TimePoint now);
  /// What the node may still answer, as another client of this process knows it.
  void adopt(const OpenRequests& open) { core_.open() = open; }
  const OpenRequests& open_requests() const { return core_.open(); }

  void on_frame(const can::Frame& frame, TimePoint now);
  void on_time(TimePoint now);

  /// Whether take_frame() may give one.
  bool may_send() const { return tx_ || state_ == State::block_download_data; }
  std::optional<can::Frame> take_frame();  ///< The next frame to send, if any.
  std::optional<Result<Bytes>>
  take_result();  ///< Set once, when the transfer has ended; empty bytes after a download.
  /// What of the server deviated from CiA 301 since the last call, by SdoHabit.
  std::bitset<kSdoHabits> take_habits() { return std::exchange(habits_, {}); }
  TimePoint deadline() const {
    return core_.deadline();
  }  ///< When on_time() has something to do; kNever while idle.
  bool busy() const { return state_ != State::idle; }
  std::uint8_t node() const { return node_; }
  std::size_t transferred() const;  ///< Bytes of this transfer that the other side has, or that came.
  /// Bytes of the whole transfer, when known.
  std::optional<std::size_t> total() const { return announced_; }

 private:
  enum class State : std::uint8_t {
    idle,
    copy,    ///< The answer before may come a second time, and would be taken for that to this request.
    resync,  ///< What was asked before may still be answered: another object is read first.
    upload_initiate,
    upload_segment,
    download_initiate,
    download_segment,
    block_upload_initiate,
    block_upload_data,
    block_upload_end,
    block_download_initiate,
    block_download_data,
    block_download_end,
  };

  void on_answer(const can::Frame& frame, TimePoint now);
  can::Frame with_object(const can::Frame& abort);
  void note(SdoHabit habit) { habits_.set(static_cast<std::size_t>(habit)); }
  bool is_first_answer(const can::Frame& frame, TimePoint now);
  void begin(TimePoint now);
  void begin_wanted(TimePoint now);
  void check(TimePoint now);
  void on_check(TimePoint now);
  void end_in_doubt();
  bool is_short() const;
  void on_silence();
  void on_abort(const can::Frame& frame, TimePoint now);
  void begin_wanted_upload(TimePoint now);
  void begin_wanted_download(TimePoint now);
  void begin_upload(TimePoint now);
  void begin_download(bool expedited, TimePoint now);

  void on_upload_initiate(const can::Frame& frame, TimePoint now);
  void on_upload_segment(const can::Frame& frame, TimePoint now);
  void on_download_initiate(const can::Frame& frame, TimePoint now);
  void on_download_segment(const can::Frame& frame, TimePoint now);
  void begin_block_upload(TimePoint now);
  void begin_block_download(TimePoint now);
  void on_block_upload_initiate(const can::Frame& frame, TimePoint now);
  void on_block_upload_data(const can::Frame& frame, TimePoint now);
  void on_block_upload_end(const can::Frame& frame, TimePoint now);
  void on_block_download_initiate(const can::Frame& frame, TimePoint now);
  void on_block_download_data(const can::Frame& frame, TimePoint now);
  void on_block_download_end(const can::Frame& frame, TimePoint now);
  void acknowledge_block(State next, TimePoint now);
  void on_foreign_request(const can::Frame& frame, TimePoint now);
  bool is_anonymous() const;
  void on_boot_up(TimePoint now);
  void end_by_boot_up();
  void leave_block_upload(TimePoint now);
  void request_segment(TimePoint now);
  void send_segment(TimePoint now);
  void send(const can::Frame& frame, State next, TimePoint now);
  void abort(std::uint32_t code, Errc errc, std::string why, std::string hint = {});
  void finish(Result<Bytes> result);
  Error error(Errc code, Message message, Message hint = {}) const;

  std::uint8_t node_;
  SdoCore core_;
  State state_ = State::idle;
  ObjectAddress object_;
  SdoAnswerKind kind_ = SdoAnswerKind::read;  ///< What is done with it.
  Bytes data_;
  std::size_t offset_ = 0;
  std::optional<std::size_t> announced_;  ///< Size of the whole transfer.
  Transfer transfer_ = Transfer::automatic;
  std::size_t size_ = 0;          ///< Of the object that is read; 0: not known.
  bool foreign_request_ = false;  ///< Another master has asked this node since the transfer began.
  bool boot_up_ = false;          ///< The node has sent a boot-up since the last request.
  std::uint8_t toggle_ = 0;
  ObjectAddress check_;          ///< What is read in State::resync.
  bool is_shadowed_ = false;     ///< Of this object something older may still be answered.
  bool check_answered_ = false;  ///< Perhaps an earlier reading of it.
  BlockSender sender_;
  BlockReceiver receiver_;
  bool crc_ = false;                        ///< Both sides make one.
  bool nudged_ = false;                     ///< The present block was acknowledged before its end.
  std::optional<can::Frame> acknowledged_;  ///< The acknowledge received last.
  std::optional<can::Frame> last_answer_;   ///< Of whatever transfer.
  std::optional<can::Frame> tx_;
  std::bitset<kSdoHabits> habits_;
  std::optional<can::Frame> following_;  ///< To be sent behind `tx_`.
};

}  // namespace servoctl::canopen
