#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/object_address.hpp"
#include "od/data_type.hpp"
#include "od/doubts.hpp"
#include "od/encoding.hpp"
#include "od/value.hpp"

namespace servoctl::od {

enum class Access : std::uint8_t { ro, rw, wo, constant };

std::string_view name(Access access);  ///< `ro rw wo const`
inline bool readable(Access access) { return access != Access::wo; }
inline bool writable(Access access) { return access == Access::rw || access == Access::wo; }

/// Which process data objects an entry may be mapped into. An EDS tells only whether; the direction comes
/// from access
/// (`rwr` and `rww` included) or from the objects table.
enum class PdoMapping : std::uint8_t { no, rpdo, tpdo, both };

std::string_view name(PdoMapping mapping);  ///< `no rpdo tpdo both`

enum class ObjectCode : std::uint8_t {
  domain = 0x02,
  deftype = 0x05,
  defstruct = 0x06,
  var = 0x07,
  array = 0x08,
  record = 0x09
};

/// Value and its label, in the order of the table it comes from.
struct EnumLabel {
  std::int64_t value = 0;
  std::string label;
  std::string label_zh;
};

/// When a written value takes effect.
enum class Effect : std::uint8_t { unstated, immediate, restart, standstill };

std::string_view name(Effect effect);  ///< empty, `immediate restart standstill`
std::optional<Effect> parse_effect(std::string_view name);

/// A value that may contain the node-ID: `$NODEID+0x600`.
struct NodeValue {
  Value value;  ///< Without the node-ID.
  bool plus_node_id = false;
  /// The value for one node.
  Value for_node(std::uint8_t node) const;
};

/// One entry: an index and a sub-index with a type of its own (CiA 301, 7.4.5).
struct Entry {
  ObjectAddress address;
  std::string name;  ///< Of the entry; for a plain variable the same as the object's.
  std::string name_zh;
  DataType type = DataType::u32;
  Access access = Access::rw;
  PdoMapping pdo = PdoMapping::no;
  std::optional<NodeValue> default_value;
  std::optional<NodeValue> low;
  std::optional<NodeValue> high;
  std::optional<NodeValue> configured;  ///< ParameterValue of a DCF.

  std::string unit;  ///< After scaling; empty if none.
  double scale = 1;  ///< Value in `unit` = raw × scale.
  Encoding encoding = Encoding::plain;
  Effect effect = Effect::unstated;
  std::vector<EnumLabel> labels;
  std::string note;
  std::string note_zh;
  bool command = false;      ///< Writing it starts an action: kept out of backups.
  bool is_volatile = false;  ///< A reading, not a setting: kept out of backups.
  /// Below this no value but 0, which switches off what the object is about.
  std::optional<std::uint64_t> least;
  Doubts doubts;
  std::uint32_t line = 0;  ///< Line of the manual or of the file it comes from; 0: unknown.
};

/// An object: an index with one entry (VAR, DOMAIN) or several.
struct Object {
  std::uint16_t index = 0;
  std::string name;
  ObjectCode code = ObjectCode::var;
  std::vector<Entry> entries;  ///< In rising sub-index; gaps are allowed.
  std::string name_zh = {};    ///< Of an object of several entries; empty where the data has none.
};

/// An object dictionary, ordered by index.
class Dictionary {
 public:
  /// Adds an object; one that is there already under this index is replaced.
  void add(Object object);

  const Object* object(std::uint16_t index) const;
  Object* object(std::uint16_t index);
  const Entry* find(ObjectAddress address) const;
  Entry* find(ObjectAddress address);

  std::span<const Object> objects() const { return objects_; }
  bool empty() const { return objects_.empty(); }
  std::size_t entry_count() const;

 private:
  std::vector<Object> objects_;
};

/// Gives the entries what they do not say themselves (unit, scale, labels, names, flags) from entries of the
/// same address and type in `parent`.
void inherit(Dictionary& dictionary, const Dictionary& parent);

/// `Position actual value` → `position_actual_value`, `Homing speeds` → `homing_speeds`: the form in which
/// objects are named on the command line.
std::string identifier(std::string_view name);

}  // namespace servoctl::od
