#include "show/chinese_names.hpp"

#include <string>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/quantity.hpp"
#include "show/caution_text.hpp"

namespace servoctl::show {
namespace {

void put(const std::string& name, const std::string& name_zh, report::Names& out) {
  if (!name.empty() && !name_zh.empty() && name != name_zh) out.emplace(name, name_zh);
}

/// Each of them, and all of them as drive::labels_text() lists them.
void put(const std::vector<od::EnumLabel>& labels, report::Names& out) {
  std::string all_zh;
  for (const auto& label : labels) {
    put(label.label, label.label_zh, out);
    append(all_zh, formatted("{} {}", label.value, label.label_zh.empty() ? label.label : label.label_zh),
           "，");
  }
  if (!labels.empty()) put(drive::labels_text(labels), all_zh, out);
}

/// Names alone, and behind what a sentence puts before them (drive::Target::in_sentence()). One that stands
/// for several things with several names in Chinese (`Mapped object 1` of each PDO) is none of these alone.
class EntryNames {
 public:
  void add(const std::string& before, const std::string& name, const std::string& name_zh) {
    if (name.empty() || name_zh.empty()) return;
    const auto [known, is_new] = alone_.emplace(name, name_zh);
    if (!is_new && known->second != name_zh) known->second.clear();
    put(before + " " + name, before + " " + name_zh, behind_);
  }

  report::Names take() {
    for (const auto& [name, name_zh] : alone_) put(name, name_zh, behind_);
    return std::move(behind_);
  }

 private:
  report::Names alone_;
  report::Names behind_;
};

}  // namespace

report::Names chinese_names(const drive::Profile& profile) {
  EntryNames names;
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries) names.add(to_string(entry.address), entry.name, entry.name_zh);
  for (const auto& parameter : profile.parameters) names.add(parameter.id, parameter.name, parameter.name_zh);
  auto out = names.take();
  for (const auto& object : profile.dictionary.objects()) {
    for (const auto& entry : object.entries) {
      put(entry.labels, out);
      put(entry.note, entry.note_zh, out);
    }
  }
  for (const auto& parameter : profile.parameters) {
    put(parameter.labels, out);
    put(parameter.note, parameter.note_zh, out);
  }
  for (const auto& fault : profile.faults) {
    put(fault.name, fault.name_zh, out);
    put(fault.check, fault.check_zh, out);
  }
  for (const auto& caution : profile.rules.cautions)
    put(caution_text(profile, caution, false), caution_text(profile, caution, true), out);
  for (const auto& [code, abort] : profile.rules.abort_texts) put(abort.text, abort.text_zh, out);
  return out;
}

}  // namespace servoctl::show
