#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "base/transfer_core.hpp"

namespace servoctl::canopen {

/// Which request the first answer of a transfer is for, by its command (CiA 301, 7.2.4.3).
enum class SdoAnswerKind : std::uint8_t {
  read,
  write,
  abort,
  none,  ///< It begins no transfer: a segment, an acknowledge, or nothing of the standard.
};
SdoAnswerKind sdo_answer_kind(std::uint8_t command);

/// The same of a request; `abort` and `none` begin no transfer.
SdoAnswerKind sdo_request_kind(std::uint8_t command);

/// The transfer core of SDO, over CAN and over EtherCAT: an answer names object and kind of its request.
class SdoCore : public TransferCore<Result<Bytes>> {
 public:
  using TransferCore::TransferCore;
  using Fit = OpenRequests::Fit;

  void begin(bool again);
  void ask_read(ObjectAddress object, TimePoint now);
  void ask_write(ObjectAddress object, ByteSpan data, TimePoint now);
  /// As OpenRequests::copy_due(), before a read of the object, or a write.
  std::optional<TimePoint> copy_due(SdoAnswerKind kind, ObjectAddress object, TimePoint now) const;
  /// Somebody else asks.
  void overhear(std::uint8_t command, ObjectAddress object, ByteSpan data, TimePoint now);

  /// The first answer of a transfer came, and it names `object`.
  Fit settle(std::uint8_t command, ObjectAddress object, TimePoint now, bool awaited);
  /// The same of an answer that was there before the present request went out.
  void settle_older(std::uint8_t command, ObjectAddress object, TimePoint now);
  /// Keeps for silence() what came and nobody had asked for.
  /// `code` is that of an abort.
  void note(std::uint8_t command, ObjectAddress object, std::uint32_t code) {
    heard_ = Heard{command, object, code};
  }
  void forget_noted() { heard_.reset(); }
  /// Whether an answer to a read of the object can only be for the present transfer.
  bool is_clear(ObjectAddress object) const;
  bool awaits_read(ObjectAddress object) const;
  /// Whether an earlier request for the object may still be answered.
  bool is_shadowed(ObjectAddress object) const;

  /// Why a transfer ends that was not answered in time: with what was heard instead. Errc::protocol where the
  /// server answers something else, Errc::timeout where it says nothing, or answers late.
  struct Silence {
    Errc code = Errc::timeout;
    std::string heard;  ///< Follows `no answer within 500 ms`.
    std::string hint;   ///< Empty where there is nothing to say.
  };
  Silence silence() const;

  /// The object that is read to find out what a server has not answered so far: every node has it.
  static ObjectAddress check_object(ObjectAddress wanted);

 private:
  struct Heard {
    std::uint8_t command;
    ObjectAddress object;
    std::uint32_t code;
  };

  std::optional<Heard> heard_;
};

}  // namespace servoctl::canopen
