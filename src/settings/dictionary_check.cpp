#include "settings/dictionary_check.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "drive/access_alarms.hpp"
#include "drive/standard_objects.hpp"
#include "session/object_survey.hpp"
#include "session/online_dictionary.hpp"
#include "session/option_scope.hpp"
#include "session/wary.hpp"
#include "settings/dictionary_probe.hpp"

namespace servoctl::settings {
namespace {

/// An entry of the file and its object.
struct Listed {
  const od::Object* object;
  const od::Entry* entry;
};

std::string alarm_of(session::Session& session, std::uint8_t node, ObjectAddress object) {
  const auto* known = session.wary_of(node);
  return known == nullptr ? std::string() : std::string(drive::possible_alarm(*known, object));
}

class DictionaryReader {
 public:
  DictionaryReader(show::Desk& desk, std::uint8_t node, const od::EdsFile& file, const CheckOptions& options)
      : desk_(&desk),
        session_(desk.session),
        node_(node),
        file_(&file),
        options_(options),
        survey_(*desk.session, node),
        judge_(out_, desk, node, options) {}

  Result<DictionaryCheck> run() {
    out_.node = node_;
    out_.entries = file_->dictionary.entry_count();
    if (const auto ready = consider(); !ready) return fail(ready.error());
    choose();
    if (const auto read = read_listed(); !read) return fail(read.error());
    if (const auto others = look_for_others(); !others) return fail(others.error());
    std::stable_sort(out_.findings.begin(), out_.findings.end(),
                     [](const auto& a, const auto& b) { return a.object < b.object; });
    return std::move(out_);
  }

 private:
  /// The numbers of the drive decide whether it may be asked for everything, and whether the file is of it.
  Result<void> consider() {
    const ObjectAddress numbers[] = {objects::kDeviceType, objects::kVendorId, objects::kProductCode};
    const auto answers = survey_.read(numbers);
    if (!answers) return fail(answers.error());
    session::consider_numbers(*session_, std::span(&node_, 1));
    const auto tell = [&](const char* what, std::uint32_t said, const Result<Bytes>& answer) {
      if (said == 0 || !answer || load_le(*answer) == said) return;
      desk_->notices.push_back(
          message("the file is of {} 0x{:08X}, node {} says 0x{:08X}: it may be of another drive", what, said,
                  node_name(node_), load_le(*answer)));
    };
    tell("vendor", file_->device.vendor_number, (*answers)[1]);
    tell("product code", file_->device.product_number, (*answers)[2]);
    return {};
  }

  /// A write-only entry is asked for because the drive may let it be read; not where a request may be an
  /// alarm, and no domain, which may be long.
  void choose() {
    const bool wary = session_->wary_of(node_) != nullptr;
    for (const auto& object : file_->dictionary.objects())
      for (const auto& entry : object.entries) {
        const bool reads = od::readable(entry.access);
        const auto alarm = alarm_of(*session_, node_, entry.address);
        if (!reads && (wary || entry.type == od::DataType::domain))
          judge_.leave(object, entry, "not asked for: it is write-only");
        else if (!alarm.empty())
          judge_.leave(object, entry, formatted("not asked for: it may raise the alarm {}", alarm));
        else
          listed_.push_back({&object, &entry});
      }
  }

  Result<void> read_listed() {
    constexpr std::size_t kPart = 16;
    const auto begin = session_->now();
    for (std::size_t at = 0; at < listed_.size(); at += kPart) {
      const auto part = std::span(listed_).subspan(at, std::min(kPart, listed_.size() - at));
      std::vector<ObjectAddress> wanted;
      for (const auto& each : part) wanted.push_back(each.entry->address);
      auto answers = survey_.read(wanted);
      if (!answers) return fail(answers.error());
      for (std::size_t i = 0; i < part.size(); ++i) answers_.push_back(std::move((*answers)[i]));
      if (begin != session_->now() && session_->options().list_progress)
        session_->options().list_progress(answers_.size(), listed_.size(), session_->now());
    }
    if (answers_without_size()) {
      judge_.doubt_sizes();
      desk_->notices.push_back(
          message("node {} answers every read with four bytes: sizes below that were not compared",
                  node_name(node_)));
    }
    for (std::size_t i = 0; i < listed_.size(); ++i)
      judge_.judge(*listed_[i].object, *listed_[i].entry, answers_[i]);
    return {};
  }

  /// Whether each of several objects of one or two bytes came with four.
  bool answers_without_size() const {
    constexpr std::size_t kSeveral = 3;
    std::size_t four = 0;
    for (std::size_t i = 0; i < listed_.size(); ++i) {
      const auto size = od::size_of(listed_[i].entry->type);
      if (!answers_[i] || !size || *size > 2) continue;
      if (answers_[i]->size() != 4) return false;
      ++four;
    }
    return four >= kSeveral;
  }

  Result<void> look_for_others() {
    if (options_.listed_only) return {};
    if (session_->ethercat() != nullptr) {
      const auto described = session::read_online_dictionary(*session_, node_);
      if (described) {
        compare_description(described->sheet.dictionary, file_->dictionary, judge_, out_);
        return {};
      }
      if (described.error().code == Errc::interrupted || described.error().code == Errc::bus)
        return fail(described.error());
      desk_->notices.push_back(message(
          "node {} does not describe its objects: types and access were not compared", node_name(node_)));
    }
    if (session_->wary_of(node_) != nullptr) {
      desk_->notices.push_back(message(
          "node {} raises an alarm if it is asked for an object that it does not have: it was asked only for "
          "those of the file",
          node_name(node_)));
      return {};
    }
    if (const auto may = may_be_probed(); !may || !*may) return may.map([](bool) {});
    const auto* standard = desk_->standard != nullptr ? &desk_->standard->dictionary : nullptr;
    const auto probed = probe_unlisted(survey_, file_->dictionary, standard, judge_, out_);
    if (!probed) return fail(probed.error());
    if (!*probed) tell_enabled();
    return {};
  }

  void tell_enabled() {
    desk_->notices.push_back(
        out_.probed == 0
            ? message("node {} is enabled: it was not asked for objects that the file does not list",
                      node_name(node_))
            : message("node {} is enabled now: it was asked for no more objects that the file does not list",
                      node_name(node_)));
  }

  /// Not a drive that is enabled, nor one that answers reads of any object: then nothing tells which it has.
  Result<bool> may_be_probed() {
    const auto enabled = survey_.is_enabled();
    if (!enabled) return enabled;
    if (*enabled) tell_enabled();
    if (*enabled) return false;
    std::vector<ObjectAddress> unlikely;
    for (const ObjectAddress object : {ObjectAddress{0x5E3B, 0}, ObjectAddress{0x4D71, 0}})
      if (file_->dictionary.object(object.index) == nullptr) unlikely.push_back(object);
    const auto answers = survey_.read(unlikely);
    if (!answers) return fail(answers.error());
    const bool all = !answers->empty() && std::all_of(answers->begin(), answers->end(),
                                                      [](const auto& answer) { return answer.has_value(); });
    if (all)
      desk_->notices.push_back(message(
          "node {} answers reads of any object: it was asked only for those of the file", node_name(node_)));
    return !all;
  }

  show::Desk* desk_;
  session::Session* session_;
  std::uint8_t node_;
  const od::EdsFile* file_;
  CheckOptions options_;
  DictionaryCheck out_;
  session::ObjectSurvey survey_;
  EntryJudge judge_;
  std::vector<Listed> listed_;
  std::vector<Result<Bytes>> answers_;
};

}  // namespace

Result<DictionaryCheck> check_dictionary(show::Desk& desk, std::uint8_t node, const od::EdsFile& file,
                                         const CheckOptions& options) {
  return DictionaryReader(desk, node, file, options).run();
}

}  // namespace servoctl::settings
