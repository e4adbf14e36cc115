#include "trial/witness.hpp"

#include <algorithm>

#include "base/calendar.hpp"
#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/cia402.hpp"
#include "drive/provenance.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "show/identity.hpp"
#include "show/provenance_record.hpp"

namespace servoctl::trial {
namespace {

/// How many objects are read between two looks at the state of the drive.
constexpr std::size_t kBetweenLooks = 16;

constexpr ObjectAddress kHardwareVersion{0x1009, 0};
constexpr ObjectAddress kSoftwareVersion{0x100A, 0};

/// Objects that tell what a drive is; not its serial number.
constexpr ObjectAddress kIdentity[] = {objects::kDeviceType, objects::kDeviceName,    kHardwareVersion,
                                       kSoftwareVersion,     objects::kVendorId,      objects::kProductCode,
                                       objects::kRevision,   objects::kSupportedModes};

/// Whether the drive takes a wrong access for a fault.
bool alarms_at_access(const drive::FaultRules& rules) {
  return !rules.access_alarm.empty() || !rules.length_alarm.empty() || !rules.range_alarm.empty();
}

std::string text_of(const Bytes& bytes) { return printable(std::string(bytes.begin(), bytes.end())); }

class Tour {
 public:
  Tour(show::Desk& desk, std::uint8_t node) : desk_(&desk), profile_(desk.profile), node_(node) { collect(); }

  Result<Witness> run(std::span<const drive::Family> families) {
    out_.identity.node = node_;
    const bool faulty = in_fault();
    for (std::size_t at = 0; at < objects_.size() && !out_.ended; at += kBetweenLooks) {
      const auto count = std::min(kBetweenLooks, objects_.size() - at);
      ask(std::span(objects_).subspan(at, count));
      if (!out_.ended && !faulty && in_fault())
        out_.ended = drive_error(Errc::negative, node_,
                                 message("the drive went into fault after {} objects were read", at + count),
                                 "`fault show` says why; the file says what was read until then");
    }
    if (out_.answers.empty() && out_.ended) return fail(*out_.ended);
    out_.verdict = session::judge_family(out_.identity, *profile_, families);
    return std::move(out_);
  }

 private:
  /// What the drive is comes first: a tour that ends early is of a known drive.
  void collect() {
    const bool only_listed = alarms_at_access(profile_->rules.fault);
    for (const auto object : kIdentity)
      if (!only_listed || profile_->dictionary.find(object) != nullptr) objects_.push_back(object);
    const auto first = objects_.size();
    for (const auto& object : profile_->dictionary.objects())
      for (const auto& entry : object.entries) {
        if (!od::readable(entry.access)) {
          ++out_.write_only;
        } else if (entry.type == od::DataType::domain) {
          ++out_.domains;
        } else if (std::find(objects_.begin(), objects_.begin() + static_cast<std::ptrdiff_t>(first),
                             entry.address) == objects_.begin() + static_cast<std::ptrdiff_t>(first)) {
          objects_.push_back(entry.address);
        }
      }
  }

  bool in_fault() const {
    if (profile_->dictionary.find(objects::kStatusword) == nullptr) return false;
    const auto word = desk_->session->upload(node_, objects::kStatusword);
    if (!word) return false;
    const auto state = drive::decode_state(static_cast<std::uint16_t>(load_le(*word)));
    return state == drive::DriveState::fault || state == drive::DriveState::fault_reaction_active;
  }

  void ask(std::span<const ObjectAddress> objects) {
    std::vector<session::SdoRequest> requests;
    for (const auto object : objects) requests.push_back({node_, object, {}, {}, size_of(object)});
    const auto answers = desk_->session->transfer(requests);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const bool refused = !answers[i] && answers[i].error().code == Errc::sdo_abort;
      if (!answers[i] && !refused) {
        out_.ended = answers[i].error();
        return;
      }
      if (refused)
        take_refusal(objects[i], answers[i].error());
      else
        take(objects[i], *answers[i]);
    }
  }

  std::size_t size_of(ObjectAddress object) const {
    const auto* entry = profile_->dictionary.find(object);
    return entry == nullptr ? 0 : od::size_of(entry->type).value_or(0);
  }

  void take_refusal(ObjectAddress object, const Error& error) {
    const auto code = error.abort_code.value_or(0);
    out_.answers.push_back({object, {}, code});
    if (profile_->dictionary.find(object) != nullptr)
      out_.differences.push_back({object, "refused", "readable", std::string(canopen::sdo_abort_text(code))});
  }

  void take(ObjectAddress object, const Bytes& bytes) {
    out_.answers.push_back({object, bytes.size(), {}});
    note_identity(object, bytes);
    const auto size = size_of(object);
    if (size != 0 && size != bytes.size()) {
      out_.differences.push_back({object, "size", std::to_string(size), std::to_string(bytes.size())});
      return;
    }
    const auto meaning = drive::meaning(drive::target_at(profile_, object), node_);
    const auto value = od::decode(meaning.type, bytes);
    if (value && !drive::check_limits(meaning, *value))
      out_.differences.push_back({object, "range", "within its limits", "outside"});
  }

  void note_identity(ObjectAddress object, const Bytes& bytes) {
    auto& identity = out_.identity;
    const auto number =
        bytes.size() <= 4 ? std::optional(static_cast<std::uint32_t>(load_le(bytes))) : std::nullopt;
    if (object == objects::kDeviceType) identity.device_type = number;
    if (object == objects::kVendorId) identity.vendor_id = number;
    if (object == objects::kProductCode) identity.product_code = number;
    if (object == objects::kRevision) identity.revision = number;
    if (object == objects::kSupportedModes) out_.modes = number;
    if (object == objects::kDeviceName) identity.device_name = text_of(bytes);
    if (object == kHardwareVersion) identity.hardware_version = text_of(bytes);
    if (object == kSoftwareVersion) identity.software_version = text_of(bytes);
  }

  show::Desk* desk_;
  const drive::Profile* profile_;
  std::uint8_t node_;
  std::vector<ObjectAddress> objects_;
  Witness out_;
};

report::List answers_of(const Witness& witness) {
  report::List out;
  for (const auto& answer : witness.answers)
    out.emplace_back(
        report::Record{{"object", to_string(answer.object)},
                       {"size", answer.size ? report::Value(*answer.size) : report::Value()},
                       {"abort", answer.abort_code ? report::Value(formatted("0x{:08X}", *answer.abort_code))
                                                   : report::Value()}});
  return out;
}

report::List differences_of(const Witness& witness) {
  report::List out;
  for (const auto& one : witness.differences)
    out.emplace_back(report::Record{
        {"object", to_string(one.object)}, {"kind", one.kind}, {"data", one.data}, {"drive", one.drive}});
  return out;
}

std::string_view name(session::FamilyVerdict::Kind kind) {
  switch (kind) {
    case session::FamilyVerdict::Kind::proven: return "proven";
    case session::FamilyVerdict::Kind::contradicted: return "contradicted";
    case session::FamilyVerdict::Kind::unproven: break;
  }
  return "unproven";
}

}  // namespace

std::size_t Witness::refused() const {
  return static_cast<std::size_t>(std::count_if(
      answers.begin(), answers.end(), [](const Answer& answer) { return answer.abort_code.has_value(); }));
}

Result<Witness> witness(show::Desk& desk, std::uint8_t node, std::span<const drive::Family> families) {
  return Tour(desk, node).run(families);
}

report::Record witness_document(const show::Desk& desk, const Witness& witness) {
  const bool ring = desk.session->ethercat() != nullptr;
  auto identity = show::identity_record(witness.identity);
  std::erase_if(identity, [](const auto& field) { return field.key == "serial"; });
  const auto& profile = *desk.profile;
  return {{"servoctl_witness", 1},
          {"time", utc_now_text()},
          {"tool", formatted("servoctl {}", version())},
          {"family", profile.of_file ? std::string("a file") : profile.family},
          {"provenance", show::provenance_record(drive::provenance_of(profile))},
          {"network", ring ? "EtherCAT" : "CAN"},
          {"identity", std::move(identity)},
          {"modes", witness.modes ? report::Value(formatted("0x{:08X}", *witness.modes)) : report::Value()},
          {"verdict", name(witness.verdict.kind)},
          {"why", witness.verdict.why},
          {"write_only", witness.write_only},
          {"domains", witness.domains},
          {"ended", witness.ended ? report::Value(witness.ended->message.text()) : report::Value()},
          {"differences", differences_of(witness)},
          {"answers", answers_of(witness)}};
}

}  // namespace servoctl::trial
