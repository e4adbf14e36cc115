#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "show/desk.hpp"
#include "show/reading.hpp"
#include "traffic/node_source.hpp"

namespace servoctl::traffic {

/// One object of one node that is looked at again and again.
struct Channel {
  std::uint8_t node = 0;
  drive::Target target;
  std::string name;                               ///< `Statusword`
  bool several_nodes = false;                     ///< The name alone does not tell which it is.
  std::optional<drive::Bridge> bridge = {};       ///< What the drive's own measures say of the unit.
  std::optional<session::DriveUnits> units = {};  ///< As show::Reading::units.

  /// Its bits are what it says: shown in words, and not plotted.
  bool is_word() const { return drive::meaning(target, node).bits; }
};

/// A value of the channel, taken apart.
show::DecodedValue decoded(const show::Desk& desk, const Channel& channel, ByteSpan bytes);

/// A value of a channel.
struct Sample {
  std::size_t channel = 0;
  TimePoint time{};  ///< As of a session::ProcessValues; of a read, when it was over.
  Result<Bytes> bytes = Bytes{};
  bool by_pdo = false;  ///< A TPDO brought it, or a cycle of process data.
};

/// Looks at objects of drives: takes what they send by themselves, and reads by SDO what they do not.
class Sampler {
 public:
  /// The objects of all nodes of the desk. Errc::usage for an unknown name. Asks the nodes for their PDO
  /// mapping; one that does not tell it is read by SDO alone.
  static Result<Sampler> make(show::Desk& desk, std::span<const std::string> names);

  /// What came by itself since the call before, in all waits. To be called often: it notices as well when
  /// what was learned of a node no longer holds, and asks the node again.
  std::vector<Sample> gather();
  /// Reads these channels, all nodes at the same time; in the order of `wanted`.
  std::vector<Sample> read(std::span<const std::size_t> wanted);
  /// A value of each channel: the last one that came by itself since the call before, else read now.
  std::vector<Sample> take();

  std::span<const Channel> channels() const { return channels_; }
  /// Whether the node sends it by itself now.
  bool is_carried(std::size_t channel) const;

 private:
  explicit Sampler(show::Desk& desk) : desk_(&desk) {}
  void begin_hearing();
  void renew();

  show::Desk* desk_;
  std::vector<Channel> channels_;
  std::vector<NodeSource> sources_;
};

/// The value that was read as a number of the channel's unit; empty where it is none.
struct Quantity {
  double value = 0;
  std::string_view unit;
};
std::optional<Quantity> quantity(const Channel& channel, ByteSpan bytes);

/// Errc::usage for a channel whose object is known to be no number.
Result<void> check_number(const Channel& channel);
/// The same of what was read, where the dictionary does not tell.
Result<void> check_number(const Channel& channel, ByteSpan bytes);

/// Why no further look is worth while: the bus was lost, or somebody interrupts; null otherwise.
const Error* end_of_looks(std::span<const Sample> samples);

/// The reads that fail still: of each node the first error, for `desk.errors`.
std::vector<Error> failures_of(std::span<const Sample> last);

}  // namespace servoctl::traffic
