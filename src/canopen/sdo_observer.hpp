#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "can/frame.hpp"

namespace servoctl::canopen {

/// What one frame of an SDO channel says, seen from outside.
struct SdoStep {
  enum class Kind : std::uint8_t {
    read,         ///< The client asks for an object.
    write,        ///< The client sends an object, or announces that it will.
    answer,       ///< The server gives the object, or announces that it will.
    acknowledge,  ///< The server has taken the object, or is ready to.
    next,         ///< Request or acknowledge of a segment or block.
    segment,      ///< Part of an object.
    end,          ///< Last frame of a block transfer.
    abort,        ///< One side gives up.
    unknown,      ///< No SDO of CiA 301.
  };
  Kind kind = Kind::unknown;
  bool from_client = false;
  bool block = false;
  std::optional<ObjectAddress> object;   ///< Of the transfer; empty when its beginning was not seen.
  std::optional<Bytes> data;             ///< The whole object, with the frame that completes it.
  std::optional<std::size_t> announced;  ///< Bytes of the object, where the frame says so.
  std::size_t received = 0;              ///< Bytes seen so far.
  std::uint32_t abort_code = 0;
};

/// Follows one SDO channel (CiA 301, 7.2.4) from outside: knows what each frame belongs to and puts the
/// objects together. Never fails: what makes no sense is SdoStep::Kind::unknown.
class SdoObserver {
 public:
  SdoStep on_client_frame(const can::Frame& frame);
  SdoStep on_server_frame(const can::Frame& answer);

 private:
  enum class Phase : std::uint8_t { none, block_up, block_down };

  SdoStep begin(const can::Frame& frame, SdoStep::Kind kind);
  SdoStep begin_block_down(const can::Frame& frame);
  SdoStep step(SdoStep::Kind kind) const;
  SdoStep initiate(const can::Frame& frame, SdoStep::Kind kind);
  SdoStep segment(const can::Frame& frame);
  SdoStep block_segment(const can::Frame& frame);
  SdoStep block_acknowledge(const can::Frame& frame);
  SdoStep block_end(const can::Frame& frame);
  SdoStep abort(const can::Frame& frame);

  Phase phase_ = Phase::none;
  std::optional<ObjectAddress> object_;
  Bytes data_;
  std::size_t block_begin_ = 0;  ///< Where the present block begins in the data.
  std::uint8_t sequence_ = 0;    ///< Last segment of the block that came in its turn.
  bool last_seen_ = false;       ///< It was the last of all.
};

}  // namespace servoctl::canopen
