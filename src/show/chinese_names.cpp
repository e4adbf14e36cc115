#include "show/chinese_names.hpp"

#include <string>
#include <vector>

namespace servoctl::show {
namespace {

void add(const std::string& name, const std::string& name_zh, report::Names& out) {
  if (!name.empty() && !name_zh.empty() && name != name_zh) out.emplace(name, name_zh);
}

void add(const std::vector<od::EnumLabel>& labels, report::Names& out) {
  for (const auto& label : labels) add(label.label, label.label_zh, out);
}

}  // namespace

report::Names chinese_names(const drive::Profile& profile) {
  report::Names out;
  for (const auto& object : profile.dictionary.objects()) {
    for (const auto& entry : object.entries) {
      add(entry.name, entry.name_zh, out);
      add(entry.labels, out);
      add(entry.note, entry.note_zh, out);
    }
  }
  for (const auto& parameter : profile.parameters) {
    add(parameter.name, parameter.name_zh, out);
    add(parameter.id + " " + parameter.name, parameter.id + " " + parameter.name_zh, out);
    add(parameter.labels, out);
    add(parameter.note, parameter.note_zh, out);
  }
  for (const auto& fault : profile.faults) {
    add(fault.name, fault.name_zh, out);
    add(fault.check, fault.check_zh, out);
  }
  for (const auto& caution : profile.rules.cautions) add(caution.text, caution.text_zh, out);
  for (const auto& [code, abort] : profile.rules.abort_texts) add(abort.text, abort.text_zh, out);
  return out;
}

}  // namespace servoctl::show
