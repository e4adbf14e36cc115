#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "od/dictionary.hpp"
#include "od/esi_findings.hpp"
#include "od/xml.hpp"

namespace servoctl::od {

/// A type that one value can have.
struct EsiType {
  DataType type = DataType::u32;
  std::size_t bits = 0;  ///< 0: varies.
  std::vector<EnumLabel> labels;
  std::optional<NodeValue> low;
  std::optional<NodeValue> high;
};

/// A base type by its name in ETG.1020 (`UDINT`, `BIT3`, `STRING(10)`, `ARRAY [0..7] OF BYTE`), or in CiA 301
/// (`UNSIGNED32`), as some files write it. Empty for others.
std::optional<EsiType> esi_base_type(std::string_view name);

/// The same for the number that SDO information tells (ETG.1000.6, table of data types), where CiA 301 has
/// none.
std::optional<EsiType> esi_base_type(std::uint16_t number);

/// One entry of a structure.
struct EsiMember {
  std::uint8_t sub = 0;
  std::string name;
  std::string name_zh;
  std::string type;       ///< Name of a plain type.
  XmlElement element;     ///< The SubItem it comes from.
  bool of_array = false;  ///< One of several that the SubItem stands for.
};

/// The DataTypes of a dictionary.
class EsiTypes {
 public:
  EsiTypes(XmlElement data_types, EsiFindings& findings);

  /// The plain type of this name: a base type, one the file defines by another, or an enumeration. Empty when
  /// it is none.
  std::optional<EsiType> plain(std::string_view name) const;

  /// The same; that there is none is told at `at`.
  std::optional<EsiType> demand(std::string_view name, XmlElement at, EsiFindings& findings) const;

  /// The type's own element, where it is made of several entries: a structure or an array; else empty.
  XmlElement composite(std::string_view name) const;

  /// The entries of a composite type, each with a plain type; others are told and left out. There is an end
  /// to those of all types together: more are told and left out.
  const std::vector<EsiMember>& members(std::string_view name, EsiFindings& findings);

 private:
  /// Which sub-indices an ArrayInfo stands for, and of what type.
  struct Elements {
    std::uint64_t first = 1;
    std::uint64_t count = 0;
    std::string base;
  };

  /// What is known of a name; found out once, however many objects are of it.
  struct Known {
    std::optional<EsiType> plain;
    XmlElement composite;
    std::optional<std::vector<EsiMember>> members;
  };

  XmlElement find(std::string_view name) const;
  const Known& know(std::string_view name) const;
  std::optional<EsiType> find_plain(std::string_view name, int depth) const;
  std::vector<EsiMember> find_members(XmlElement composite, EsiFindings& findings) const;
  Elements elements_of(XmlElement data_type, EsiFindings& findings) const;
  void add_item(XmlElement item, std::vector<EsiMember>& out, EsiFindings& findings) const;

  std::map<std::string_view, XmlElement, std::less<>> by_name_;
  mutable std::map<std::string, Known, std::less<>> known_;
  std::size_t members_left_ = 200'000;
};

}  // namespace servoctl::od
