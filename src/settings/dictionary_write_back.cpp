#include "settings/dictionary_write_back.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/cia402.hpp"
#include "drive/drive_settings.hpp"
#include "drive/enabling_write.hpp"
#include "drive/standard_objects.hpp"
#include "session/fitting_size.hpp"
#include "session/write.hpp"
#include "settings/comparison.hpp"
#include "show/records.hpp"

namespace servoctl::settings {
namespace {

constexpr std::uint16_t kFirstSetting = 0x2000;  // Below is communication (CiA 301, table 38).

/// Whether the name says that a write does more than set a value, or cannot be judged. Where no data describe
/// the drive, nothing else tells.
bool sounds_like_action(std::string_view name) {
  constexpr std::string_view kWords[] = {"reset",   "clear",    "save",    "store",   "restore", "command",
                                         "control", "start",    "init",    "trigger", "enable",  "execute",
                                         "unlock",  "password", "jog",     "test",    "tuning",  "identif",
                                         "calibr",  "homing",   "target",  "baud",    "bitrate", "node",
                                         "station", "address",  "factory", "output"};
  const bool is_ascii =
      std::all_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  return !is_ascii || std::any_of(std::begin(kWords), std::end(kWords),
                                  [&](std::string_view word) { return show::contains_nocase(name, word); });
}

/// Objects that are settings by the data of this profile.
std::set<ObjectAddress> settings_by(const drive::Profile& profile) {
  std::set<ObjectAddress> out;
  for (const auto& setting : drive::settings_of(profile))
    if (setting.left_out.empty() && !drive::is_of_pdos(profile, setting.entry->address) &&
        !is_address(&profile, setting.entry->address))
      out.insert(setting.entry->address);
  return out;
}

/// Whether the family's data know the object, and say that it is something else than a setting.
class Denials {
 public:
  explicit Denials(const drive::Profile* profile) : profile_(profile) {
    if (profile != nullptr) settings_ = settings_by(*profile);
  }
  bool deny(ObjectAddress object, const Bytes& bytes) const {
    return profile_ != nullptr && profile_->dictionary.find(object) != nullptr &&
           (!settings_.contains(object) || drive::power_parameter(profile_, object, bytes) != nullptr);
  }

 private:
  const drive::Profile* profile_;
  std::set<ObjectAddress> settings_;
};

Result<void> refuse_enabled(show::Desk& desk, std::uint8_t node) {
  const auto word = desk.session->upload(node, objects::kStatusword);
  if (!word) {
    auto error = word.error();
    error.hint = "--write needs the statusword: it shows that the power stage is off";
    return fail(std::move(error));
  }
  const auto state = drive::decode_state(static_cast<std::uint16_t>(load_le(*word)));
  if (!drive::is_energised(state)) return {};
  return fail(drive_error(
      Errc::refused, node,
      formatted("it is in the state '{}': nothing is written back to an enabled drive", drive::name(state)),
      "`disable` it first"));
}

/// What the refusal of its own value shows; empty: nothing about the file.
std::optional<Difference> disproved(const Error& refusal) {
  namespace abort_of = canopen::sdo_abort;
  if (session::is_refused_length(refusal)) return Difference::size;
  switch (refusal.abort_code.value_or(0)) {
    case abort_of::kReadOnly:
    case abort_of::kUnsupportedAccess: return Difference::access;
    case abort_of::kRange:
    case abort_of::kTooHigh:
    case abort_of::kTooLow: return Difference::limits;
    default: return std::nullopt;
  }
}

class WriterBack {
 public:
  WriterBack(show::Desk& desk, const od::EdsFile& file, DictionaryCheck& check)
      : desk_(&desk), file_(&file), check_(&check) {}

  Result<void> run(const std::vector<ObjectAddress>& objects) {
    constexpr std::size_t kStates = 16;  // So many writes between two looks at the state.
    auto& session = *desk_->session;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (i % kStates == 0)
        if (const auto off = refuse_enabled(*desk_, check_->node); !off) return off;
      if (const auto written = write(objects[i]); !written) return written;
      if (session.options().list_progress)
        session.options().list_progress(i + 1, objects.size(), session.now());
    }
    return {};
  }

 private:
  Result<void> write(ObjectAddress object) {
    const session::SdoRequest request{check_->node, object, check_->values.at(object)};
    const auto written = session::write_all(*desk_->session, std::span(&request, 1), true).front();
    if (written) {
      ++*check_->written;
      return {};
    }
    const auto& error = written.error();
    if (error.code != Errc::sdo_abort) return fail(error);
    const auto* owner = file_->dictionary.object(object.index);
    const auto* entry = file_->dictionary.find(object);
    const auto name = full_name(*desk_, *owner, *entry);
    if (const auto kind = disproved(error))
      check_->findings.push_back({object, name, *kind,
                                  formatted("{} {}", od::name(entry->type), od::name(entry->access)),
                                  formatted("refuses its own value: {:08X}h", *error.abort_code)});
    else
      check_->unchecked.push_back({object, name,
                                   formatted("its value was not taken back: {}",
                                             canopen::sdo_abort_text(error.abort_code.value_or(0)))});
    return {};
  }

  show::Desk* desk_;
  const od::EdsFile* file_;
  DictionaryCheck* check_;
};

bool is_described(const drive::Profile* profile) {
  return profile != nullptr && !profile->is_generic() && !profile->of_file;
}

std::string write_question(const show::Desk& desk, const DictionaryCheck& check, std::size_t count) {
  auto out =
      formatted("Write {} values of node {} back to the objects they were read from?", count, check.node);
  if (!is_described(desk.profile))
    out += " No data describe this drive: an object of its maker may do more than its name says.";
  if (desk.profile != nullptr && desk.profile->rules.store.wears)
    out += " Each write wears the flash of the drive.";
  return out;
}

}  // namespace

std::vector<ObjectAddress> writable_back(const show::Desk& desk, const od::EdsFile& file,
                                         const DictionaryCheck& check) {
  drive::Profile of_file;
  of_file.dictionary = file.dictionary;
  const auto settings = settings_by(of_file);
  const Denials family(desk.profile);
  const Denials standard(desk.standard);
  const show::Desk english;
  const auto is_found = [&](ObjectAddress object) {
    return std::any_of(check.findings.begin(), check.findings.end(),
                       [&](const DictionaryFinding& found) { return found.object == object; });
  };
  std::vector<ObjectAddress> out;
  for (const auto& [object, bytes] : check.values) {
    const auto* entry = file.dictionary.find(object);
    if (object.index < kFirstSetting || !settings.contains(object) || is_found(object) ||
        family.deny(object, bytes) || standard.deny(object, bytes))
      continue;
    const auto* owner = file.dictionary.object(object.index);
    const bool is_known = is_described(desk.profile) && desk.profile->dictionary.find(object) != nullptr;
    if (is_known || !sounds_like_action(full_name(english, *owner, *entry))) out.push_back(object);
  }
  return out;
}

Result<void> write_back(show::Desk& desk, const od::EdsFile& file, DictionaryCheck& check) {
  const auto objects = writable_back(desk, file, check);
  check.written = 0;
  if (objects.empty()) return {};
  if (const auto off = refuse_enabled(desk, check.node); !off) return off;
  if (desk.dry_run) {
    desk.notices.push_back(
        formatted("--dry-run: {} values of node {} would be written back to the objects they were read from",
                  objects.size(), check.node));
    return {};
  }
  if (const auto agreed = desk.confirm(write_question(desk, check, objects.size())); !agreed) return agreed;
  const auto written = WriterBack(desk, file, check).run(objects);
  std::stable_sort(check.findings.begin(), check.findings.end(),
                   [](const auto& a, const auto& b) { return a.object < b.object; });
  return written;
}

}  // namespace servoctl::settings
