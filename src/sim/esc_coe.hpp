#pragma once

#include <cstdint>

#include "sim/drive_model.hpp"
#include "sim/esc_faults.hpp"
#include "sim/esc_mailbox.hpp"
#include "sim/esc_sdo_info.hpp"
#include "sim/esc_sdo_server.hpp"

namespace servoctl::sim {

/// The CoE of a slave (ETG.1000.6, 5.6): SDO, SDO information where it has it, and emergencies, each with its
/// service in front. It knows no mailbox.
class EscCoe final : public EscProtocol {
 public:
  struct Options {
    bool sdo_info = false;
    bool complete_access = false;
    /// Aborts come as a request (2), as the standard has it, or as a response (3), as many slaves do.
    std::uint8_t abort_service = 2;
  };

  /// `model` and `faults` outlive it.
  EscCoe(DriveModel& model, Options options, EscFaults& faults)
      : server_(model.profile(), model, {options.complete_access}),
        info_(model.profile(), model.node()),
        options_(options),
        faults_(&faults) {}

  Answer on_request(ByteSpan request, std::size_t most) override;
  /// The message that tells of an emergency.
  static Bytes emergency(const Emergency& emergency);
  /// PRE-OP begins or ends.
  void reset() { server_.reset(); }
  /// From now on its statusword reads 0, or no longer.
  void set_asleep(bool asleep) { asleep_ = asleep; }

 private:
  EscSdoServer server_;
  EscSdoInfo info_;
  Options options_;
  EscFaults* faults_;
  bool asleep_ = false;
};

}  // namespace servoctl::sim
