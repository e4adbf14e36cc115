#pragma once

#include <optional>
#include <utility>

#include "session/modbus_network.hpp"

namespace servoctl::session {

/// The way to the registers of one unit. An object that has no register is refused here, and nothing is
/// sent: Errc::sdo_abort without an abort code. So is what the unit answers with an exception.
///
/// 1000h asks whether the unit is there: a register is read, and whatever the answer, the object is refused,
/// because no unit has it.
class ModbusObjectChannel final : public ObjectChannel {
 public:
  ModbusObjectChannel(ModbusNetwork& network, std::uint8_t node, Duration timeout)
      : network_(&network), node_(node), timeout_(timeout) {}
  ~ModbusObjectChannel() override;

  void set_timeout(Duration timeout) override { timeout_ = timeout; }
  void start_upload(ObjectAddress object, TimePoint now, canopen::Transfer transfer,
                    std::size_t size) override;
  void try_again() override { again_ = true; }
  void start_download(ObjectAddress object, Bytes data, TimePoint now, canopen::Transfer transfer) override;
  /// Any request; the result is the PDU of its answer.
  void start_request(Bytes pdu);
  Result<void> on_time(TimePoint now) override;
  std::optional<Result<Bytes>> take_result() override { return std::exchange(result_, std::nullopt); }
  bool busy() const override { return !pdu_.empty(); }
  TimePoint deadline() const override;
  std::size_t transferred() const override { return 0; }
  std::optional<std::size_t> total() const override { return std::nullopt; }

  std::uint8_t node() const { return node_; }
  const Bytes& pdu() const { return pdu_; }
  Duration timeout() const { return timeout_; }
  /// Whether what is asked is a further try.
  bool is_again() const { return again_; }
  void on_outcome(const modbus::Outcome& outcome);
  /// Before this time it does not ask: the unit was busy.
  TimePoint not_before() const { return not_before_; }
  /// The line is lost: what was under way ends without a result.
  void forget();

 private:
  enum class Way : std::uint8_t { read, write, presence, request };

  void ask(Way way, Bytes pdu);
  void refuse(ObjectAddress object, std::string what, std::string hint);
  void refuse_unknown(ObjectAddress object);
  bool repeats_while_busy(std::uint8_t exception);
  void finish(Result<Bytes> result);
  Error refusal(std::uint8_t exception) const;
  Error silence(const modbus::Outcome& outcome) const;
  std::string what_text() const;

  ModbusNetwork* network_;
  std::uint8_t node_;
  Duration timeout_;
  Way way_ = Way::read;
  ObjectAddress object_;
  bool again_ = false;  ///< As try_again() says, until the transfer has ended.
  TimePoint not_before_ = TimePoint::min();
  TimePoint busy_until_ = kNever;  ///< When a unit that says that it is busy has had its time.
  Bytes pdu_;                      ///< Empty while nothing is under way.
  std::optional<Result<Bytes>> result_;
};

}  // namespace servoctl::session
