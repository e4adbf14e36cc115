#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "canopen/pdo.hpp"
#include "commands/command.hpp"
#include "session/write_plan.hpp"

namespace servoctl::commands {

/// Puts objects of one node into a TPDO that is not in use, for as long as it lives.
class ScopeMapping {
 public:
  ScopeMapping(Context& context, std::uint8_t node) : context_(&context), node_(node) {}
  ScopeMapping(const ScopeMapping&) = delete;
  ScopeMapping& operator=(const ScopeMapping&) = delete;
  ~ScopeMapping() { end(); }

  /// Maps them, sent every `period`. Errc::negative or Errc::refused, with the reason, where that is not
  /// possible: no spare TPDO with an event timer, a node that is not Operational, objects that cannot be
  /// mapped, a family that leaves Operational for it while the drive is energised. Then nothing has changed.
  Result<void> begin(std::span<const std::string> objects, Duration period);
  /// Puts the TPDO back as it was; what goes wrong is in `context.errors`. Ctrl-C waits for it.
  void end();

 private:
  Result<canopen::Pdo> choose(std::span<const std::string> objects, Duration period,
                              const std::vector<canopen::Pdo>& pdos) const;
  Result<void> check_state(const std::vector<session::PlannedWrite>& plan) const;

  Context* context_;
  std::uint8_t node_;
  session::Values before_;  ///< Empty while nothing is mapped.
  session::Values mapped_;
};

}  // namespace servoctl::commands
