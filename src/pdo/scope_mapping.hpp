#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "canopen/pdo.hpp"
#include "pdo/pdo_record.hpp"
#include "session/restore.hpp"
#include "show/desk.hpp"

namespace servoctl::pdo {

/// What went wrong, and of which node it is said, once: many errors name it themselves.
Message reason_naming(std::uint8_t node, const Error& error);

/// Puts objects of one node into a TPDO that is not in use, for as long as it lives.
class ScopeMapping {
 public:
  ScopeMapping(show::Desk& desk, std::uint8_t node) : desk_(&desk), node_(node), record_(desk, node) {}
  ScopeMapping(const ScopeMapping&) = delete;
  ScopeMapping& operator=(const ScopeMapping&) = delete;
  ~ScopeMapping() { end(); }

  /// Maps them, sent every `period`. Errc::negative or Errc::refused, with the reason, where that is not
  /// possible: no spare TPDO with an event timer, a node that is not Operational, objects that cannot be
  /// mapped, an energised drive whose family leaves Operational for it or is not known. Then nothing has
  /// changed, or `desk.errors` says what could not be put back.
  Result<void> begin(std::span<const std::string> objects, Duration period);
  /// Puts the TPDO back as it was; what goes wrong is in `desk.errors`. Ctrl-C waits for it.
  void end();

 private:
  Result<canopen::Pdo> choose(std::span<const std::string> objects, Duration period,
                              const std::vector<canopen::Pdo>& pdos) const;
  Result<void> check_state(const std::vector<session::PlannedWrite>& plan) const;
  /// Errc::refused while the drive is energised, unless its family is known to take these writes then: one
  /// that refuses them may answer with a fault, and leaving Operational stops it.
  Result<void> check_still(const std::vector<session::PlannedWrite>& plan) const;
  Result<void> change(const session::Values& present, const session::Values& wanted,
                      const session::RestoreOptions& options);
  Result<void> put_back();
  session::Values values_before() const;
  std::string astray() const;

  show::Desk* desk_;
  std::uint8_t node_;
  session::Values before_;  ///< All PDOs of the node.
  canopen::Pdo pdo_;        ///< The one that is used.
  bool changed_ = false;    ///< It may not be as it was.
  PdoRecord record_;
};

}  // namespace servoctl::pdo
