#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "session/identity.hpp"
#include "session/process_values.hpp"
#include "show/desk.hpp"

namespace servoctl::traffic {

/// The values that one node sends by itself, for a command that looks at them for long. When what is known of
/// the node's PDOs no longer holds (session::Lifetime) it says so and brings nothing; once the node is left
/// alone, it reads the PDOs again.
class NodeSource {
 public:
  /// Its PDOs were read (session::learn_pdos()); `lifetime` began before that. `desk` outlives it.
  NodeSource(show::Desk& desk, std::uint8_t node, std::vector<ObjectAddress> objects,
             const session::Lifetime& lifetime);

  std::uint8_t node() const { return node_; }
  bool carries(ObjectAddress object) const { return values_->carries(object); }
  std::vector<session::ProcessValues::Arrival> take_all();
  /// To be called often. True when the node was asked anew: what else it said before is to be asked again.
  bool renew();

 private:
  void hear();
  void tell_end(const std::string& why);
  void tell_renewal();
  void check_identity();

  show::Desk* desk_;
  std::uint8_t node_;
  std::vector<ObjectAddress> objects_;
  session::Lifetime lifetime_;
  std::unique_ptr<session::ProcessValues> values_;
  std::vector<session::ProcessValues::Arrival> arrivals_;  ///< Before the values were renewed.
  std::optional<session::Identity> identity_;              ///< As it was known at first.
  bool carried_ = false;                                   ///< A PDO brought any of the objects.
  bool ended_ = false;                                     ///< And that was told.
};

}  // namespace servoctl::traffic
