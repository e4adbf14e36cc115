#include "settings/learning.hpp"

#include <algorithm>
#include <optional>
#include <system_error>

#include "base/calendar.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "drive/profile_sheet.hpp"
#include "drive/standard_objects.hpp"
#include "od/eds_writer.hpp"
#include "od/learned_mark.hpp"
#include "session/addressing.hpp"
#include "session/identify.hpp"
#include "session/online_dictionary.hpp"
#include "session/scan.hpp"
#include "session/wary.hpp"
#include "settings/learned_record.hpp"
#include "settings/learned_sheet.hpp"
#include "settings/resumed_scan.hpp"
#include "settings/scan_file.hpp"
#include "settings/scan_ranges.hpp"
#include "settings/stored_eds.hpp"

namespace servoctl::settings {
namespace {

/// Before the first read: a scan takes minutes.
Result<void> check_target(const std::filesystem::path& file) {
  const auto word = file.string();
  if (word.empty() || word == "-")
    return fail(Errc::usage, message("'{}' names no file", as_it_is(word)), "name the file: -o drive.eds");
  std::error_code ignored;
  if (const auto status = std::filesystem::status(file, ignored);
      std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    return fail(Errc::usage, message("{} is no regular file", as_it_is(word)), "name the file: -o drive.eds");
  if (const auto may = check_writable(file); !may) return may;
  return check_writable(scan_file(file));
}

class Learning {
 public:
  Learning(show::Desk& desk, std::uint8_t node, const std::filesystem::path& file,
           const LearnOptions& options)
      : desk_(&desk), session_(desk.session), node_(node), file_(file), options_(options) {}

  Result<report::Record> run() {
    if (const auto may = check_target(file_); !may) return fail(may.error());
    if (const auto ready = get_ready(); !ready) return fail(ready.error());
    auto learned = take();
    if (!learned) return fail(learned.error());
    const auto read = od::read_eds(learned->text, file_.string());
    if (!read) return fail(read.error());
    if (const auto same = check_same_drive(); !same) return fail(same.error());
    if (const auto written = write_file_atomically(file_, learned->text); !written)
      return fail(written.error());
    if (learned->source == "scan") remove_kept();
    if (auto findings = drive::findings_text(*read, file_.string()); !findings.empty())
      desk_->notices.push_back(std::move(findings));
    return learned_record(*learned, *read, node_, file_);
  }

 private:
  /// Who it is, and that no axis is energised. Nothing else is asked for before.
  Result<void> get_ready() {
    const auto identities = session::scan(*session_, std::span(&node_, 1));
    if (!identities) return fail(identities.error());
    if (identities->empty())
      return fail(drive_error(Errc::timeout, node_, "no answer", session_->network().silence_hint(node_)));
    identity_ = identities->front();
    session::consider_numbers(*session_, std::span(&node_, 1));
    boots_ = session_->watch().boots(node_);
    alarms_ = session_->watch().alarms(node_);
    survey_.emplace(*session_, node_);
    const auto energised = session::is_any_axis_energised(*session_, node_);
    if (!energised) return fail(better_reason(energised.error()));
    if (*energised)
      return fail(drive_error(Errc::refused, node_,
                              "an axis is enabled, or still reacts to a fault: nothing is read",
                              "`disable` it first; `status` shows the state"));
    if (const auto may = allow_alarms(); !may) return may;
    return find_axes();
  }

  /// 1000h was answered before further axes are asked for.
  Error better_reason(const Error& error) const {
    const bool is_of_further_axis = error.object && error.object->index > objects::kStatusword.index;
    return error.code == Errc::timeout && is_of_further_axis
               ? session::silent_about_absence(node_, *error.object)
               : error;
  }

  Result<void> find_axes() {
    const auto first = survey_->read(std::span(&objects::kStatusword, 1));
    if (!first) return fail(first.error());
    if (first->front()) statuswords_.push_back(objects::kStatusword);
    const auto further = session::further_axes(*session_, node_);
    if (further.failure) return fail(*further.failure);
    for (const auto& axis : further.axes)
      statuswords_.push_back(drive::of_axis(objects::kStatusword, axis.number));
    return {};
  }

  Result<void> allow_alarms() {
    if (!options_.despite_alarms) return {};
    survey_->go_on_despite_alarms();
    const auto* known = session_->wary_of(node_);
    return desk_->confirm(
        known != nullptr
            ? formatted(
                  "Scan node {}? It raises the alarm {} for each object that it does not have, and is in "
                  "fault afterwards.",
                  node_, known->rules.fault.object_alarm)
            : formatted("Scan node {} even if it raises alarms? It may be in fault afterwards.", node_));
  }

  void remove_kept() const {
    std::error_code ignored;
    std::filesystem::remove(scan_file(file_), ignored);
  }

  Result<void> check_same_drive() {
    const auto now = session::read_identity(*session_, node_);
    if (!now) return fail(now.error());
    auto difference = session::different_number(identity_, *now);
    if (difference.empty() && session_->watch().boots(node_) != boots_) difference = "it restarted";
    if (difference.empty()) return {};
    return fail(drive_error(
        Errc::refused, node_,
        message("it may be another drive than the one that was read: {}; no file is written", difference)));
  }

  Result<Learned> take() {
    if (!options_.scans) {
      auto stored = stored_eds(*desk_, *survey_, identity_);
      if (!stored) return fail(stored.error());
      if (*stored) return Learned{"stored", std::move(**stored)};
      auto described = description();
      if (!described) return fail(described.error());
      if (*described) return std::move(**described);
    }
    return scan();
  }

  /// What a drive on EtherCAT describes; empty where it describes nothing.
  Result<std::optional<Learned>> description() {
    if (session_->ethercat() == nullptr) return std::optional<Learned>();
    auto online = session::read_online_dictionary(*session_, node_);
    if (!online) {
      const bool refused = online.error().code == Errc::sdo_abort || online.error().code == Errc::protocol;
      return refused ? Result<std::optional<Learned>>(std::nullopt) : fail(online.error());
    }
    for (const auto& left : online->left_out)
      desk_->notices.push_back(message("node {} does not describe {}", node_name(node_), left));
    return std::optional(Learned{
        "description",
        written(online->sheet, {"Made by servoctl as the drive describes its objects (SDO information)."})});
  }

  Result<Learned> scan() {
    if (const auto may = may_scan(); !may) return fail(may.error());
    session::ScanState state{.ranges =
                                 options_.ranges.empty() ? ranges_of_axes(statuswords_) : options_.ranges};
    const auto begun = resume_scan(*desk_, scan_file(file_), identity_, state);
    if (!begun) return fail(begun.error());
    session::ObjectScan scan(*session_, node_, *survey_, statuswords_, state);
    Result<void> kept;
    const auto done = scan.run([&] {
      if (state.done == 0) return kept;
      kept = write_file_atomically(scan_file(file_),
                                   scan_text(identity_text(session_->url(), identity_), state));
      return kept;
    });
    if (!done) {
      if (kept && state.done > 0)
        desk_->notices.push_back(message("{} keeps {} of {} indexes: the same command goes on from there",
                                         as_it_is(scan_file(file_).string()), state.done, state.indexes()));
      return fail(done.error());
    }
    if (const auto code = scan.lacking_code())
      desk_->notices.push_back(
          message("node {} answers reads of objects that it does not have with abort {:08X}h",
                  node_name(node_), *code));
    const auto unread = unread_text(state);
    if (state.entries.empty()) {
      remove_kept();
      return fail(drive_error(Errc::negative, node_,
                              unread.empty()
                                  ? Message("no object was found in these ranges")
                                  : message("no object was found; indexes {} were not read", unread),
                              "--range names other indexes; `status` shows whether the drive is in a fault"));
    }
    desk_->notices.push_back(
        "objects that can be read are `ro` unless a standard says more: a read does not show write access, sign "
        "or limits. A backup saves them as well; nothing writes them until the file says `rw`");
    auto text = text_of(state, unread);
    tell_alarms();
    return Learned{"scan", std::move(text), ranges_text(state.ranges), *begun, state.refusals};
  }

  std::string text_of(const session::ScanState& state, const std::string& unread) {
    const auto* standard = desk_->standard != nullptr ? &desk_->standard->dictionary : nullptr;
    const auto left_out = unread.empty() ? std::string() : formatted(" Indexes not read: {}.", unread);
    return written(
        learned_sheet(state, identity_, standard),
        {std::string(od::kLearnedMark),
         formatted("Made by servoctl by reading indexes {} of a drive.{}", ranges_text(state.ranges),
                   left_out),
         "Reading shows neither write access nor sign, limits or defaults: what can be read is ro where no "
         "standard says more. Where the manual says that an object can be written, change AccessType to rw."});
  }

  void tell_alarms() {
    if (session_->watch().alarms(node_) != alarms_)
      desk_->notices.push_back(
          message("node {} sent EMCYs during the scan: it may be in fault now (`status`, `fault reset`)",
                  node_name(node_)));
  }

  Result<void> may_scan() {
    const auto* known = session_->wary_of(node_);
    if (known == nullptr || options_.despite_alarms) return {};
    return fail(drive_error(
        Errc::refused, node_,
        message("a drive of the family {} raises an alarm for each object that it does not have",
                as_it_is(known->family)),
        message("the objects are in the data of the family: `objects -d {}`; --despite-alarms scans "
                "nevertheless",
                as_it_is(known->family))));
  }

  std::string written(const od::EdsFile& sheet, std::vector<std::string> comments) const {
    auto device = sheet.device;
    if (device.product_name.empty()) device.product_name = identity_.device_name;
    const auto now = utc_now_text();
    const auto time = od::eds_time(now);
    const od::EdsHead head{.file_name = file_.filename().string(),
                           .description = device.product_name,
                           .date = time.date,
                           .time = time.time,
                           .comments = std::move(comments)};
    return od::write_eds(head, device, sheet.dictionary);
  }

  show::Desk* desk_;
  session::Session* session_;
  std::uint8_t node_;
  std::filesystem::path file_;
  LearnOptions options_;
  session::Identity identity_;
  std::uint32_t boots_ = 0;
  std::uint32_t alarms_ = 0;
  std::optional<session::ObjectSurvey> survey_;
  std::vector<ObjectAddress> statuswords_;
};

}  // namespace

Result<report::Record> learn_sheet(show::Desk& desk, std::uint8_t node, const std::filesystem::path& file,
                                   const LearnOptions& options) {
  return Learning(desk, node, file, options).run();
}

}  // namespace servoctl::settings
