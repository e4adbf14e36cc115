#include "od/esi_entry.hpp"

#include <array>

#include "base/format.hpp"
#include "base/text.hpp"
#include "od/eds_value.hpp"
#include "od/esi_unit.hpp"
#include "od/esi_value.hpp"

namespace servoctl::od {
namespace {

struct EsiAccessRow {
  std::string_view word;
  Access access;
};
constexpr std::array kEsiAccess{EsiAccessRow{"ro", Access::ro}, EsiAccessRow{"rw", Access::rw},
                                EsiAccessRow{"wo", Access::wo}, EsiAccessRow{"const", Access::constant}};

/// `PreOP_SafeOP` as people say it: `PRE-OP and SAFE-OP`.
std::string states_of(std::string_view restriction) {
  std::string out;
  for (const auto state : split(restriction, '_')) {
    const auto words = equals_nocase(state, "PreOP")    ? std::string("PRE-OP")
                       : equals_nocase(state, "SafeOP") ? std::string("SAFE-OP")
                       : equals_nocase(state, "OP")     ? std::string("OP")
                                                        : shown(state);
    append(out, words, " and ");
  }
  return out;
}

void add_note(Entry& entry, std::string_view english, std::string_view chinese) {
  append(entry.note, english, "; ");
  append(entry.note_zh, chinese, "；");
}

void read_restrictions(XmlElement access, Entry& entry) {
  if (const auto write = access.attribute("WriteRestrictions"); !write.empty() && writable(entry.access)) {
    const auto states = states_of(write);
    add_note(entry, formatted("can be written in {} only", states),
             formatted("仅可在 {} 状态下写入", states));
  }
  if (const auto read = access.attribute("ReadRestrictions"); !read.empty() && readable(entry.access)) {
    const auto states = states_of(read);
    add_note(entry, formatted("can be read in {} only", states), formatted("仅可在 {} 状态下读取", states));
  }
}

Access esi_access_of(XmlElement element, EsiFindings& findings) {
  for (const auto& row : kEsiAccess)
    if (equals_nocase(row.word, element.text())) return row.access;
  findings.error(element, "unknown-access-type",
                 formatted("'{}' is not an access type; taken as ro", shown(element.text())),
                 "write ro, rw or wo");
  return Access::ro;
}

PdoMapping esi_mapping_of(XmlElement element, EsiFindings& findings) {
  bool rpdo = false;
  bool tpdo = false;
  for (const char c : lower(element.text())) {
    rpdo = rpdo || c == 'r';
    tpdo = tpdo || c == 't';
    if (c != 'r' && c != 't' && !findings.enough_of("unknown-mapping"))
      findings.warn(element, "unknown-mapping", formatted("'{}' is no mapping", shown(element.text())),
                    "write R for RxPDOs, T for TxPDOs, RT for both");
  }
  return rpdo && tpdo ? PdoMapping::both : rpdo ? PdoMapping::rpdo : tpdo ? PdoMapping::tpdo : PdoMapping::no;
}

}  // namespace

void read_esi_flags(XmlElement own, XmlElement of_object, Entry& entry, EsiFindings& findings) {
  const auto own_flags = own.child("Flags");
  const auto flags = own_flags.child("Access") ? own_flags : of_object.child("Flags");
  const auto access = flags.child("Access");
  if (access && !access.text().empty())
    entry.access = esi_access_of(access, findings);
  else {
    entry.access = Access::ro;
    findings.warn(own ? own : of_object, "missing-access-type",
                  formatted("{} has no Access; taken as ro", to_string(entry.address)),
                  "add Flags with Access ro, rw or wo");
  }
  read_restrictions(access, entry);
  const auto mapping =
      own_flags.child("PdoMapping") ? own_flags.child("PdoMapping") : flags.child("PdoMapping");
  entry.pdo = esi_mapping_of(mapping, findings);
}

void read_esi_remarks(XmlElement element, XmlElement info, Entry& entry) {
  if (auto unit = esi_unit(info.child("Unit").text())) {
    entry.unit = std::move(unit->unit);
    entry.scale = unit->scale;
  }
  const auto comment = esi_text(element, "Comment");
  if (!comment.english.empty()) add_note(entry, comment.english, comment.chinese);
}

}  // namespace servoctl::od
