#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>

#include "base/bytes.hpp"
#include "canopen/sdo_observer.hpp"
#include "drive/profile.hpp"
#include "show/pdo_book.hpp"

namespace servoctl::traffic {

/// The modes that drives are in, as far as frames tell: what 6061h said last, or what 6060h was written
/// since.
class ModesSeen {
 public:
  /// `profile` may be null; it outlives this.
  explicit ModesSeen(const drive::Profile* profile) : profile_(profile) {}

  /// The family of one node, where it is not that of the others.
  void set_family(std::uint8_t node, const drive::Profile* profile) { families_[node] = profile; }

  /// A mode of CiA 402-2; 0: not known.
  std::int8_t of(std::uint8_t node) const { return nodes_[node % nodes_.size()].mode; }

  /// A mode that was read holds at once, one that was written when the node has taken it.
  void on_sdo(std::uint8_t node, const canopen::SdoStep& step);
  /// An RPDO that repeats a mode asks for nothing anew.
  void on_pdo(const show::PdoView& view, ByteSpan data);
  void forget(std::uint8_t node) { nodes_[node % nodes_.size()] = {}; }

 private:
  struct Node {
    std::int8_t mode = 0;
    std::optional<std::int8_t> asked;    ///< 6060h, as it stands in the frame.
    std::optional<std::int8_t> pending;  ///< Of a write whose acknowledge has not come.
  };

  std::int8_t meaning_of(std::uint8_t id, std::int8_t mode) const;
  void ask(std::uint8_t id, Node& node, std::int8_t mode) const;

  const drive::Profile* profile_;
  std::map<std::uint8_t, const drive::Profile*> families_;
  std::array<Node, 128> nodes_{};
};

}  // namespace servoctl::traffic
