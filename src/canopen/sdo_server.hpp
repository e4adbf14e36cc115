#pragma once

#include <cstdint>
#include <optional>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/time.hpp"
#include "can/frame.hpp"
#include "canopen/object_store.hpp"
#include "canopen/sdo_block.hpp"

namespace servoctl::canopen {

/// The server side of the default SDO channel (CiA 301, 7.2.4). Performs no I/O and reads no clock.
class SdoServer {
 public:
  struct Options {
    bool segmented = true;                       ///< False: segmented requests are aborted with 0504 0001h.
    bool block = true;                           ///< False: block requests are aborted with 0504 0001h.
    std::uint8_t block_size = kMaxBlockSize;     ///< Segments of a block the client may send, 1..127.
    bool crc = true;                             ///< Makes and checks the CRC of block transfers.
    bool echo = false;                           ///< The acknowledge of an expedited write repeats its data.
    Duration timeout = std::chrono::seconds(1);  ///< Silence of the client that ends a segmented transfer.
  };

  SdoServer(std::uint8_t node, ObjectStore& store, Options options)
      : node_(node), store_(&store), options_(options) {}

  void on_frame(const can::Frame& frame, TimePoint now);
  void on_time(TimePoint now);
  std::optional<can::Frame> take_frame();
  TimePoint deadline() const { return deadline_; }
  /// Forgets a transfer under way, as a reset of the communication does.
  void reset();

 private:
  enum class State : std::uint8_t {
    idle,
    upload,
    download,
    block_upload_start,
    block_upload_data,
    block_upload_end,
    block_download_data,
    block_download_end,
  };

  void on_upload_initiate(ObjectAddress object, TimePoint now);
  void on_download_initiate(const can::Frame& frame, TimePoint now);
  void on_upload_segment(const can::Frame& frame, TimePoint now);
  void on_download_segment(const can::Frame& frame, TimePoint now);
  void on_block_upload_initiate(const can::Frame& frame, TimePoint now);
  void on_block_upload(const can::Frame& frame, TimePoint now);
  void on_block_upload_acknowledge(const can::Frame& frame, TimePoint now);
  void on_block_download_initiate(const can::Frame& frame, TimePoint now);
  void on_block_download_data(const can::Frame& frame, TimePoint now);
  void on_block_download_end(const can::Frame& frame);
  void answer_upload(ObjectAddress object, Bytes data, TimePoint now);
  void acknowledge_block(TimePoint now);
  void abort(ObjectAddress object, std::uint32_t code);

  std::uint8_t node_;
  ObjectStore* store_;
  Options options_;
  State state_ = State::idle;
  ObjectAddress object_;
  Bytes data_;
  std::size_t offset_ = 0;
  std::optional<std::size_t> announced_;
  std::uint8_t toggle_ = 0;
  TimePoint deadline_ = kNever;
  BlockSender sender_;
  BlockReceiver receiver_;
  bool crc_ = false;     ///< Both sides make one.
  bool nudged_ = false;  ///< The present block was acknowledged before its end.
  std::optional<can::Frame> tx_;
};

}  // namespace servoctl::canopen
