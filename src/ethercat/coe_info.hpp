#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "base/time.hpp"

namespace servoctl::ethercat {

/// Which objects a list is to have (ETG.1000.6, table 44).
enum class ObjectList : std::uint8_t { all = 1, rx_pdo = 2, tx_pdo = 3, backup = 4, settings = 5 };

/// What a slave says of an object of its dictionary.
struct CoeObject {
  std::uint16_t index = 0;
  std::uint16_t data_type = 0;  ///< CiA 301, 7.4.7, or the index of a structure.
  std::uint8_t max_sub = 0;
  std::uint8_t code = 0;  ///< 7 variable, 8 array, 9 record.
  std::string name;
};

/// What a slave says of one entry of an object.
struct CoeEntry {
  ObjectAddress object;
  std::uint16_t data_type = 0;
  std::uint16_t bits = 0;
  std::uint16_t access = 0;  ///< kEntry… bits.
  std::string name;
};
inline constexpr std::uint16_t kEntryReadPreop = 1U << 0U;
inline constexpr std::uint16_t kEntryReadSafeop = 1U << 1U;
inline constexpr std::uint16_t kEntryReadOp = 1U << 2U;
inline constexpr std::uint16_t kEntryWritePreop = 1U << 3U;
inline constexpr std::uint16_t kEntryWriteSafeop = 1U << 4U;
inline constexpr std::uint16_t kEntryWriteOp = 1U << 5U;
inline constexpr std::uint16_t kEntryRxPdo = 1U << 6U;
inline constexpr std::uint16_t kEntryTxPdo = 1U << 7U;
inline constexpr std::uint16_t kEntryBackup = 1U << 8U;
inline constexpr std::uint16_t kEntrySetting = 1U << 9U;

/// The client side of SDO information over a mailbox (ETG.1000.6, 5.6.3): asks a slave for its dictionary,
/// one question at a time. Performs no I/O and reads no clock. Many drives have none: that is an error of the
/// result.
class CoeInfo {
 public:
  using Description = std::variant<std::vector<std::uint16_t>, CoeObject, CoeEntry>;

  /// `node` 1..127; `timeout` is the longest silence between two messages.
  CoeInfo(std::uint8_t node, Duration timeout) : node_(node), timeout_(timeout) {}

  void start_list(ObjectList list, TimePoint now);
  void start_object(std::uint16_t index, TimePoint now);
  void start_entry(ObjectAddress object, TimePoint now);

  void on_message(ByteSpan message, TimePoint now);
  void on_refusal(std::uint16_t detail);
  void on_failure(Errc code, std::string what, std::string hint);
  void on_time(TimePoint now);

  bool may_send() const { return tx_.has_value(); }  ///< Whether take_message() gives one.
  std::optional<Bytes> take_message();
  /// Set once: what was asked for. Errc::sdo_abort with the code of the slave, timeout or protocol else.
  std::optional<Result<Description>> take_result();
  TimePoint deadline() const { return deadline_; }
  bool busy() const { return asked_ != 0; }
  std::uint8_t node() const { return node_; }
  Duration timeout() const { return timeout_; }

 private:
  void ask(std::uint8_t opcode, ByteSpan what, TimePoint now);
  void on_error(ByteSpan data);
  bool follows(std::uint16_t left);
  void take_in(ByteSpan data);
  void complete();
  void complete_list();
  void complete_object();
  void complete_entry();
  void finish(Result<Description> result);
  Error error(Errc code, Message what, Message hint) const;

  std::uint8_t node_;
  Duration timeout_;
  std::uint8_t asked_ = 0;  ///< Opcode of the request under way; 0: none.
  ObjectAddress object_;
  Bytes question_;  ///< Comes back in front of the answer.
  Bytes data_;
  std::optional<std::uint16_t> left_;  ///< Fragments still to come.
  TimePoint deadline_ = kNever;
  std::optional<Bytes> tx_;
  std::optional<Result<Description>> result_;
};

}  // namespace servoctl::ethercat
