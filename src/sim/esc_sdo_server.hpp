#pragma once

#include <cstdint>
#include <optional>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "canopen/object_store.hpp"
#include "sim/esc_complete_access.hpp"

namespace servoctl::sim {

/// The SDO server of CoE (ETG.1000.6, 5.6.2): the eight bytes of CANopen and, where there are more, the data
/// behind them. It knows no mailbox and no clock.
class EscSdoServer {
 public:
  struct Options {
    bool complete_access = false;
  };
  struct Answer {
    Bytes message;
    bool abort = false;
  };

  EscSdoServer(const drive::Profile& profile, canopen::ObjectStore& store, Options options)
      : store_(&store), whole_(profile, store), options_(options) {}

  /// `request` begins with the command specifier and has 8 bytes at least; `most` bytes can be in an answer.
  /// Empty: nothing is to be said (to an abort).
  std::optional<Answer> on_request(ByteSpan request, std::size_t most);
  void reset() { state_ = State::idle; }

 private:
  enum class State : std::uint8_t { idle, upload, download };

  Answer start_upload(std::size_t most);
  Answer send_segment(ByteSpan request, std::size_t most);
  Answer start_download(ByteSpan request);
  Answer take_segment(ByteSpan request);
  Answer finish_download();
  Answer abort(std::uint32_t code);
  std::uint32_t read(Bytes& out);
  std::uint32_t write(ByteSpan data);
  Bytes head(unsigned command) const;

  canopen::ObjectStore* store_;
  EscCompleteAccess whole_;
  Options options_;
  State state_ = State::idle;
  ObjectAddress object_;
  bool complete_ = false;
  unsigned toggle_ = 0;
  Bytes data_;             ///< What is still to be sent, or has come.
  std::size_t total_ = 0;  ///< Of a download.
};

}  // namespace servoctl::sim
