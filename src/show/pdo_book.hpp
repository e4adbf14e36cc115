#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "canopen/pdo.hpp"
#include "drive/quantity.hpp"
#include "report/json_writer.hpp"
#include "session/pdo_setup.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// One object in a PDO, ready to be taken out of a frame.
struct PdoField {
  canopen::PdoEntry entry;
  std::size_t first_bit = 0;
  drive::Target target;
  drive::Meaning meaning;
  od::DataType type = od::DataType::u32;   ///< As long as the entry.
  std::string name;                        ///< What a person reads: `Statusword`, `0x6041:0`.
  const drive::Profile* family = nullptr;  ///< May be null.
  std::string head;                        ///< `"index":24641,"sub":0,"name":"Statusword"` of its records.

  /// The value in a frame that is long enough.
  od::Value value(ByteSpan data) const;
  /// Of 6060h and 6061h what they say, also where nobody knows their type.
  std::int8_t mode(ByteSpan data) const;
};

/// A PDO of one node with all that is needed to read its frames.
struct PdoView {
  std::uint8_t node = 0;
  canopen::Pdo pdo;
  std::string name;              ///< `TPDO1`
  std::vector<PdoField> fields;  ///< Without gaps.
  bool assumed = false;          ///< Its mapping is that of the factory; the drive has not told it.
  const drive::Profile* profile = nullptr;

  std::uint32_t can_id() const { return pdo.can_id(); }
};

PdoView make_view(const drive::Profile* profile, bool chinese, std::uint8_t node, canopen::Pdo pdo);

/// Appends the value as a person reads it: `1200 inc`, `3 Profile velocity`, `0x0237 operation enabled` for
/// the statusword, `0x000F enable operation` for the controlword; see value_words(). `mode`: of CiA 402-2.
void append_value(const PdoField& field, const od::Value& value, bool chinese, std::string& out,
                  std::int8_t mode = 0);

/// The mode of CiA 402-2 that stands in the PDO itself (6060h, 6061h); 0 when none does.
std::int8_t mode_in(const PdoView& view, ByteSpan data);

/// Whether the values can be told from a frame: something is mapped, and it is as long as that.
bool shows_values(const PdoView& view, ByteSpan data);

/// Appends `Statusword 0x0237 …, Position actual value 1200 inc`; raw bytes where nothing is mapped, the
/// frame is too short, or the mapping is assumed and has another length. `mode`: what the drive is in, where
/// the PDO does not tell it.
void append_values(const PdoView& view, ByteSpan data, bool chinese, std::string& out, std::int8_t mode = 0);

/// Writes the values as a list of records; an empty one where append_values() shows raw bytes.
void write_values(const PdoView& view, ByteSpan data, report::JsonWriter& json, std::int8_t mode = 0);

/// Which PDO a CAN-ID belongs to, on a bus with many nodes. Of a node nothing is known of, the PDOs are those
/// its family leaves the factory with, at the CAN-IDs of the pre-defined connection set.
class PdoBook {
 public:
  /// `profile` may be null; it outlives the book.
  /// `standard`: as Desk::standard.
  PdoBook(const drive::Profile* profile, bool chinese, const drive::Profile* standard = nullptr)
      : profile_(profile), names_(profile != nullptr ? profile : standard), chinese_(chinese) {}

  /// The family of one node, where it is not that of the others; before anything else is said of the node.
  void set_family(std::uint8_t node, const drive::Profile* profile) { families_[node] = profile; }
  /// What a node says its PDO parameters are.
  void set(std::uint8_t node, session::Values values);
  /// A PDO parameter that was seen to be written or read on the bus; other objects change nothing.
  void learn(std::uint8_t node, ObjectAddress object, ByteSpan data);
  /// The node has booted: what was learnt of it holds no longer.
  void forget(std::uint8_t node);

  /// The PDO of this CAN-ID (canopen::can_id_of()), or null. Holds until the book changes.
  const PdoView* find(std::uint32_t can_id);

 private:
  struct Node {
    session::Values at_start;
    session::Values now;
    std::set<ObjectAddress> told;  ///< By the drive, since it started.
    std::vector<PdoView> views;
  };
  Node& node(std::uint8_t id);
  void rebuild(std::uint8_t id);
  void index();

  const drive::Profile* family_of(std::uint8_t node) const {
    const auto own = families_.find(node);
    return own == families_.end() ? profile_ : own->second;
  }
  const drive::Profile* names_of(std::uint8_t node) const {
    const auto* family = family_of(node);
    return family == nullptr ? names_ : family;
  }

  const drive::Profile* profile_;
  std::map<std::uint8_t, const drive::Profile*> families_;
  const drive::Profile* names_;
  bool chinese_;
  std::map<std::uint8_t, Node> nodes_;
  std::array<const PdoView*, 0x800> by_id_{};
  std::map<std::uint32_t, const PdoView*> by_long_id_;  ///< Of 29 bits.
};

}  // namespace servoctl::show
