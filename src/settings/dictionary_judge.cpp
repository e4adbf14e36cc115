#include <algorithm>

#include "base/format.hpp"
#include "base/pdo_index.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/standard_objects.hpp"
#include "settings/dictionary_check.hpp"

namespace servoctl::settings {
namespace {

namespace abort_of = canopen::sdo_abort;

bool is_plausible(const od::Entry& entry, const Bytes& bytes) {
  if (entry.type == od::DataType::boolean) return bytes.empty() || bytes.front() <= 1;
  if (entry.type != od::DataType::string) return true;
  const auto end = std::find(bytes.begin(), bytes.end(), std::uint8_t{0});
  return std::all_of(bytes.begin(), end,
                     [](std::uint8_t c) { return c >= 0x20 || c == '\t' || c == '\r' || c == '\n'; });
}

/// What is the same in every drive of a type, so that another value contradicts the file. The serial number
/// is not, and lists that are filled at run time or by the user are not.
bool is_constant(const od::Object& object, const od::Entry& entry) {
  const auto address = entry.address;
  if (address == objects::kSerialNumber) return false;
  if (address == objects::kDeviceType || address.index == objects::kVendorId.index) return true;
  if (entry.access == od::Access::constant) return true;
  const bool counts = object.code == od::ObjectCode::array || object.code == od::ObjectCode::record;
  return counts && address.sub == 0 && !od::writable(entry.access) &&
         address.index != objects::kErrorHistory.index && !pdo_at(address.index);
}

/// Numbers of communication are read in hexadecimal: device type, identity, COB-IDs.
std::string value_text(const od::Entry& entry, const od::Value& value) {
  const auto* number = std::get_if<std::uint64_t>(&value);
  constexpr std::size_t kLong = 4;
  return number != nullptr && entry.address.index < 0x2000 && od::size_of(entry.type) == kLong
             ? formatted("0x{:08X}", *number)
             : od::to_string(value);
}

/// What the file says, as the drive would hold it: a real of 32 bits has fewer digits than its text.
od::Value as_held(od::DataType type, const od::NodeValue& said, std::uint8_t node) {
  auto value = said.for_node(node);
  const auto bytes = od::encode(type, value);
  return bytes ? od::decode(type, *bytes).value_or(value) : value;
}

bool is_beyond(const od::Entry& entry, const std::optional<od::NodeValue>& limit, std::uint8_t node,
               const od::Value& value, int wrong) {
  return limit && od::compare_numbers(value, as_held(entry.type, *limit, node)) == wrong;
}

/// The names of an object and of one of its entries.
struct Chinese {
  std::string object;
  std::string entry;
};

/// As the family that was named calls them, or the standard, where the English names are the same.
Chinese chinese_of(const show::Desk& desk, const od::Object& object, const od::Entry& entry) {
  Chinese out;
  for (const auto* profile : {desk.profile, desk.standard}) {
    const auto* there = profile == nullptr ? nullptr : profile->dictionary.object(object.index);
    if (there != nullptr && out.object.empty() && there->name == object.name) out.object = there->name_zh;
    const auto* same = there == nullptr ? nullptr : profile->dictionary.find(entry.address);
    if (same != nullptr && out.entry.empty() && same->name == entry.name) out.entry = same->name_zh;
  }
  return out;
}

std::string limits_text(const od::Entry& entry, std::uint8_t node) {
  const auto text = [&](const std::optional<od::NodeValue>& limit) {
    return limit ? od::to_string(limit->for_node(node)) : std::string();
  };
  return formatted("{} … {}", text(entry.low), text(entry.high));
}

}  // namespace

std::string_view name(Difference difference) {
  switch (difference) {
    case Difference::missing: return "missing";
    case Difference::unlisted: return "unlisted";
    case Difference::type: return "type";
    case Difference::size: return "size";
    case Difference::access: return "access";
    case Difference::default_value: return "default";
    case Difference::limits: return "limits";
    case Difference::no_answer: break;
  }
  return "no-answer";
}

std::string full_name(const show::Desk& desk, const od::Object& object, const od::Entry& entry) {
  auto whole = object.name;
  auto part = entry.name;
  if (desk.chinese) {
    const Chinese own{object.name_zh, entry.name_zh};
    const auto known = own.entry.empty() ? chinese_of(desk, object, entry) : own;
    if (!known.object.empty()) whole = known.object;
    if (!known.entry.empty()) part = known.entry;
  }
  if (part.empty() || entry.name == object.name) return entry.name == object.name ? part : whole;
  return whole.empty() ? part : formatted("{}{}{}", whole, desk.chinese ? "，" : ", ", part);
}

std::string size_text(std::size_t size) { return size == 1 ? "1 byte" : formatted("{} bytes", size); }

void EntryJudge::add(const od::Object& object, const od::Entry& entry, Difference difference,
                     std::string file, std::string drive) {
  out_->findings.push_back(
      {entry.address, full_name(*desk_, object, entry), difference, std::move(file), std::move(drive)});
}

void EntryJudge::judge(const od::Object& object, const od::Entry& entry, const Result<Bytes>& answer) {
  if (!answer) return judge_refusal(object, entry, answer.error());
  if (!od::readable(entry.access))
    return add(object, entry, Difference::access, std::string(od::name(entry.access)), "readable");
  ++out_->answered;
  out_->values[entry.address] = *answer;
  judge_bytes(object, entry, *answer);
}

void EntryJudge::judge_refusal(const od::Object& object, const od::Entry& entry, const Error& refusal) {
  if (refusal.code != Errc::sdo_abort)
    return add(object, entry, Difference::no_answer, std::string(od::name(entry.access)),
               refusal.code == Errc::timeout ? "no answer" : "malformed answer");
  const auto code = refusal.abort_code.value_or(0);
  if (code == abort_of::kNoSubIndex && is_unfilled(entry.address))
    return leave(object, entry, canopen::sdo_abort_text(code), true);
  if (code == abort_of::kNoObject || code == abort_of::kNoSubIndex)
    return add(object, entry, Difference::missing,
               formatted("{} {}", od::name(entry.type), od::name(entry.access)), formatted("{:08X}h", code));
  const bool readable = od::readable(entry.access);
  if (!readable && (code == abort_of::kWriteOnly || code == abort_of::kUnsupportedAccess)) return;
  if (code == abort_of::kWriteOnly)
    return add(object, entry, Difference::access, std::string(od::name(entry.access)), "write-only");
  leave(object, entry, canopen::sdo_abort_text(code), code == abort_of::kNoData);
}

/// A place of the error history, or of a PDO mapping, that holds nothing now.
bool EntryJudge::is_unfilled(ObjectAddress address) const {
  if (address.sub == 0 || (address.index != objects::kErrorHistory.index && !pdo_at(address.index)))
    return false;
  const auto count = out_->values.find({address.index, 0});
  return count != out_->values.end() && load_le(count->second) < address.sub;
}

void EntryJudge::leave(const od::Object& object, const od::Entry& entry, std::string reason, bool is_empty) {
  out_->unchecked.push_back({entry.address, full_name(*desk_, object, entry), std::move(reason), is_empty});
}

void EntryJudge::judge_bytes(const od::Object& object, const od::Entry& entry, Bytes bytes) {
  const auto size = od::size_of(entry.type);
  if (size && doubts_sizes_ && bytes.size() == 4 && *size < 4 &&
      std::all_of(bytes.begin() + static_cast<std::ptrdiff_t>(*size), bytes.end(),
                  [](std::uint8_t c) { return c == 0; }))
    bytes.resize(*size);
  if (size && bytes.size() != *size)
    return add(object, entry, Difference::size, formatted("{} ({})", od::name(entry.type), size_text(*size)),
               size_text(bytes.size()));
  if (!is_plausible(entry, bytes))
    return add(object, entry, Difference::type, std::string(od::name(entry.type)), to_hex(bytes));
  judge_value(object, entry, bytes);
}

void EntryJudge::judge_value(const od::Object& object, const od::Entry& entry, const Bytes& bytes) {
  const auto value = od::decode(entry.type, bytes);
  if (!value) return;
  const auto is_default = entry.default_value && as_held(entry.type, *entry.default_value, node_) == *value;
  if (!is_default &&
      (is_beyond(entry, entry.low, node_, *value, -1) || is_beyond(entry, entry.high, node_, *value, 1)))
    add(object, entry, Difference::limits, limits_text(entry, node_), od::to_string(*value));
  judge_default(object, entry, *value);
}

void EntryJudge::judge_default(const od::Object& object, const od::Entry& entry, const od::Value& value) {
  if (!entry.default_value) return;
  const auto expected = as_held(entry.type, *entry.default_value, node_);
  if (expected == value) return;
  const bool constant = is_constant(object, entry);
  const bool setting = od::writable(entry.access) && !entry.is_volatile;
  if (constant || (setting && options_.factory))
    return add(object, entry, Difference::default_value, value_text(entry, expected),
               value_text(entry, value));
  if (setting) ++out_->not_default;
}

}  // namespace servoctl::settings
