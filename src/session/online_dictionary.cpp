#include "session/online_dictionary.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "base/format.hpp"
#include "base/text.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/standard_objects.hpp"
#include "od/esi_types.hpp"
#include "session/ethercat_network.hpp"

namespace servoctl::session {
namespace {

using ethercat::CoeEntry;
using ethercat::CoeInfo;
using ethercat::CoeObject;

constexpr std::uint16_t kReads =
    ethercat::kEntryReadPreop | ethercat::kEntryReadSafeop | ethercat::kEntryReadOp;
constexpr std::uint16_t kWrites =
    ethercat::kEntryWritePreop | ethercat::kEntryWriteSafeop | ethercat::kEntryWriteOp;

struct Kind {
  od::DataType type;
  std::string note;  ///< What is not certain of it.
};

od::DataType type_of_bits(std::uint16_t bits) {
  switch (bits) {
    case 1: return od::DataType::boolean;
    case 8: return od::DataType::u8;
    case 16: return od::DataType::u16;
    case 32: return od::DataType::u32;
    case 64: return od::DataType::u64;
    default: return od::DataType::bytes;
  }
}

/// The numbers of EtherCAT go before those of CiA 301, which has records at some of them.
Kind kind_of(const CoeEntry& described) {
  if (const auto own = od::esi_base_type(described.data_type)) return {own->type, {}};
  const auto type = od::data_type_from_cia(described.data_type);
  if (type && *type != od::DataType::domain) return {*type, {}};
  if (described.data_type == od::cia_code(od::DataType::domain)) return {od::DataType::domain, {}};
  const auto taken = type_of_bits(described.bits);
  return {taken, formatted("type {:04X}h of the drive, taken as {}", described.data_type, name(taken))};
}

/// `PRE-OP` where the bits of the three states, PRE-OP first, are not all there.
std::string states_of(unsigned bits) {
  constexpr unsigned kAll = 0x7;
  if (bits == kAll) return {};
  std::string out;
  constexpr std::array<std::string_view, 3> kStates{"PRE-OP", "SAFE-OP", "OP"};
  for (std::size_t i = 0; i < kStates.size(); ++i)
    if ((bits >> i & 1U) != 0) append(out, kStates[i], " and ");
  return out;
}

void note_states(const CoeEntry& described, od::Entry& entry) {
  const auto reads = states_of(described.access & kReads);
  const auto writes = states_of((described.access & kWrites) >> 3U);
  if (od::writable(entry.access) && !writes.empty()) {
    append(entry.note, formatted("can be written in {} only", writes), "; ");
    append(entry.note_zh, formatted("仅可在 {} 状态下写入", writes), "；");
  }
  if (od::readable(entry.access) && !reads.empty()) {
    append(entry.note, formatted("can be read in {} only", reads), "; ");
    append(entry.note_zh, formatted("仅可在 {} 状态下读取", reads), "；");
  }
}

od::PdoMapping mapping_of(std::uint16_t access) {
  const bool rpdo = (access & ethercat::kEntryRxPdo) != 0;
  const bool tpdo = (access & ethercat::kEntryTxPdo) != 0;
  return rpdo && tpdo ? od::PdoMapping::both
         : rpdo       ? od::PdoMapping::rpdo
         : tpdo       ? od::PdoMapping::tpdo
                      : od::PdoMapping::no;
}

class OnlineReader {
 public:
  OnlineReader(Session& session, EtherCatNetwork& network, std::uint8_t node)
      : session_(&session), network_(&network), node_(node) {}

  Result<OnlineDictionary> read() {
    const auto list = ask<std::vector<std::uint16_t>>(
        [](CoeInfo& info, TimePoint now) { info.start_list(ethercat::ObjectList::all, now); });
    if (!list) return fail(without_list(list.error()));
    for (std::size_t i = 0; i < list->size(); ++i) {
      if (const auto read = read_object((*list)[i]); !read) return fail(read.error());
      if (session_->options().list_progress)
        session_->options().list_progress(i + 1, list->size(), session_->now());
    }
    if (out_.sheet.dictionary.empty())
      return fail(drive_error(Errc::negative, node_, "it lists no objects that it describes",
                              "name a family with -d, or the ESI file of the drive, -d FILE.xml"));
    return std::move(out_);
  }

 private:
  template <class Answer>
  Result<Answer> ask(const EtherCatNetwork::Question& question) {
    auto told = network_->describe(node_, question);
    if (!told) return fail(told.error());
    if (auto* answer = std::get_if<Answer>(&*told)) return std::move(*answer);
    return fail(drive_error(Errc::bug, node_, "it was asked one thing, and another was answered"));
  }

  /// A drive that refuses the list has no dictionary to give.
  Error without_list(Error error) const {
    if (error.code != Errc::sdo_abort && error.code != Errc::protocol) return error;
    error.message = message("node {} does not describe its objects (no SDO information): {}",
                            node_name(node_), what_happened(error));
    return error;
  }

  /// What the drive refuses to describe is left out; whatever else goes wrong ends it all.
  static bool is_refusal(const Error& error) { return error.code == Errc::sdo_abort; }

  Result<void> read_object(std::uint16_t index) {
    const auto object = ask<CoeObject>([&](CoeInfo& info, TimePoint now) { info.start_object(index, now); });
    if (!object)
      return is_refusal(object.error()) ? leave_out({index, 0}, object.error()) : fail(object.error());
    od::Object out;
    out.index = index;
    out.name = object->name;
    out.code = static_cast<od::ObjectCode>(object->code);
    const bool one = out.code != od::ObjectCode::array && out.code != od::ObjectCode::record;
    const unsigned last = one ? 0 : object->max_sub;
    for (unsigned sub = 0; sub <= last; ++sub)
      if (const auto read = read_entry({index, static_cast<std::uint8_t>(sub)}, *object, out); !read)
        return read;
    if (!out.entries.empty()) out_.sheet.dictionary.add(std::move(out));
    return {};
  }

  Result<void> read_entry(ObjectAddress address, const CoeObject& object, od::Object& out) {
    const auto described =
        ask<CoeEntry>([&](CoeInfo& info, TimePoint now) { info.start_entry(address, now); });
    if (!described) {
      if (!is_refusal(described.error())) return fail(described.error());
      // Sub-indices may have gaps.
      const bool gap = described.error().abort_code == canopen::sdo_abort::kNoSubIndex;
      return gap ? Result<void>() : leave_out(address, described.error());
    }
    auto entry = online_entry(*described);
    if (!entry) return {};
    if (entry->name.empty())
      entry->name = out.code == od::ObjectCode::array || out.code == od::ObjectCode::record
                        ? formatted("{} {}", object.name, address.sub)
                        : object.name;
    out.entries.push_back(std::move(*entry));
    return {};
  }

  Result<void> leave_out(ObjectAddress address, const Error& why) {
    out_.left_out.push_back(message("{}: {}", as_it_is(to_string(address)), why.message));
    return {};
  }

  Session* session_;
  EtherCatNetwork* network_;
  std::uint8_t node_;
  OnlineDictionary out_;
};

/// Vendor, product and revision, as far as the drive tells them.
void read_identity(Session& session, std::uint8_t node, od::EdsFile& sheet) {
  const auto number = [&](ObjectAddress object) -> std::uint32_t {
    if (sheet.dictionary.find(object) == nullptr) return 0;
    const auto bytes = session.upload(node, object);
    return bytes && bytes->size() <= 4 ? static_cast<std::uint32_t>(load_le(*bytes)) : 0;
  };
  sheet.ethercat = true;
  sheet.device.vendor_number = number(objects::kVendorId);
  sheet.device.product_number = number(objects::kProductCode);
  sheet.device.revision_number = number(objects::kRevision);
  if (sheet.dictionary.find(objects::kDeviceName) == nullptr) return;
  if (const auto name = session.upload(node, objects::kDeviceName))
    sheet.device.product_name =
        std::string(trim(std::string(name->begin(), std::find(name->begin(), name->end(), 0))));
}

}  // namespace

std::optional<od::Entry> online_entry(const CoeEntry& described) {
  const bool reads = (described.access & kReads) != 0;
  const bool writes = (described.access & kWrites) != 0;
  if (!reads && !writes) return std::nullopt;
  auto kind = kind_of(described);
  od::Entry out;
  out.address = described.object;
  out.name = described.name;
  out.type = kind.type;
  out.note = std::move(kind.note);
  out.access = !writes ? od::Access::ro : reads ? od::Access::rw : od::Access::wo;
  out.pdo = mapping_of(described.access);
  note_states(described, out);
  return out;
}

Result<OnlineDictionary> read_online_dictionary(Session& session, std::uint8_t node) {
  auto* network = session.ethercat();
  if (network == nullptr)
    return fail(
        Errc::usage,
        message("{} has no drives that describe their objects: that is of EtherCAT", as_it_is(session.url())),
        "name a family with -d, or the data sheet of the drive, -d FILE.eds");
  auto out = OnlineReader(session, *network, node).read();
  if (!out) return out;
  read_identity(session, node, out->sheet);
  return out;
}

}  // namespace servoctl::session
