#include "commands/restoring.hpp"

#include <fmt/format.h>
#include <map>

#include "base/file.hpp"
#include "commands/change.hpp"
#include "commands/comparison.hpp"
#include "drive/cia402.hpp"
#include "drive/drive_settings.hpp"
#include "session/restore.hpp"

namespace servoctl::commands {
namespace {

using report::Record;
using report::Show;
using report::Value;

/// What of the identity speaks against the backup being this drive's, or one of its kind.
std::string misfit(const session::Identity& file, const session::Identity& drive) {
  const auto other = [](const auto& a, const auto& b) { return a && b && *a != *b; };
  if (other(file.device_type, drive.device_type)) return "its device type (1000h)";
  if (other(file.vendor_id, drive.vendor_id)) return "its vendor (1018h:01)";
  if (other(file.product_code, drive.product_code)) return "its product code (1018h:02)";
  return {};
}

/// One restore, from file to outcome.
class Restoring {
 public:
  Restoring(Context& context, const Backup& backup, const std::string& title, std::uint8_t node,
            const std::filesystem::path& before, const RestoringOptions& options)
      : context_(&context),
        backup_(&backup),
        title_(title),
        node_(node),
        before_(before),
        options_(options) {}

  Result<Value> run() {
    if (const auto fits = check_identity(); !fits) return tl::unexpected<Error>(fits.error());
    if (const auto still = check_standstill(); !still) return tl::unexpected<Error>(still.error());
    if (const auto read = read_present(); !read) return tl::unexpected<Error>(read.error());
    if (const auto valid = check_values(); !valid) return tl::unexpected<Error>(valid.error());
    auto comparison = compare(context_->profile, {fmt::format("node {}", node_), node_, present_},
                              {title_, node_, wanted_}, true, context_->chinese);
    if (comparison.different == 0) return result(std::move(comparison.record), "nothing differs", {});
    if (context_->dry_run) return planned();
    const auto question =
        fmt::format("Write {} values of {} to node {}?", comparison.different, title_, node_);
    if (const auto answer = context_->confirm(question); !answer)
      return tl::unexpected<Error>(answer.error());
    if (const auto saved = save_present(); !saved) return tl::unexpected<Error>(saved.error());
    return carry_out(std::move(comparison.record));
  }

 private:
  Result<void> check_identity() {
    const bool force = options_.force;
    if (backup_->family != context_->profile->family && !force)
      return fail(Errc::refused,
                  fmt::format("{} is of {}, not of {}", title_, backup_->family, context_->profile->family),
                  "--force restores what fits all the same");
    const std::uint8_t nodes[] = {node_};
    const auto found = session::scan(*context_->session, nodes);
    if (!found) return tl::unexpected<Error>(found.error());
    if (found->empty())
      return fail(Errc::timeout, fmt::format("node {} does not answer", node_), "`scan` shows who does");
    identity_ = found->front();
    const auto& drive = identity_;
    if (const auto what = misfit(backup_->identity, drive); !what.empty() && !force)
      return fail(Errc::refused,
                  fmt::format("node {} is another drive than that of {}: {} differs", node_, title_, what),
                  "--force restores what fits all the same");
    if (backup_->identity.revision != drive.revision ||
        backup_->identity.software_version != drive.software_version)
      context_->notices.push_back(fmt::format(
          "node {}: the firmware differs from that of the backup: compare the values that matter", node_));
    return {};
  }

  /// Gains and limits are no things to change under a drive that holds a load.
  Result<void> check_standstill() {
    const auto word = context_->session->upload(node_, {0x6041, 0});
    if (!word && word.error().code != Errc::sdo_abort) return tl::unexpected<Error>(word.error());
    if (!word || !drive::is_energised(drive::decode_state(static_cast<std::uint16_t>(load_le(*word)))))
      return {};
    return fail(Errc::refused, fmt::format("node {} is energised, its settings are not changed now", node_),
                "`disable` takes its power away; make sure that the load is held");
  }

  bool is_address(ObjectAddress object) const {
    const auto& rules = context_->profile->rules.nmt;
    const auto* parameter = context_->profile->parameter(object);
    return parameter != nullptr && (parameter == context_->profile->parameter(rules.node_id) ||
                                    parameter == context_->profile->parameter(rules.bitrate));
  }

  /// A COB-ID that contains the node-ID of the drive it was read from contains that of this one here.
  Bytes for_this_node(ObjectAddress object, Bytes bytes) const {
    const auto* entry = context_->profile->dictionary.find(object);
    const bool with_node = entry != nullptr && entry->default_value && entry->default_value->plus_node_id;
    const auto number = load_le(bytes);
    if (!with_node || bytes.size() != 4 || (number & 0x7FU) != backup_->identity.node) return bytes;
    return store_le(number - backup_->identity.node + node_, 4);
  }

  /// Only what this drive's own data calls a setting is ever written, whatever the file says.
  Result<void> leave_out(const Backup::Entry& entry, std::string_view reason) {
    const auto what = fmt::format("{}:{}: {} is no setting of this drive: {}", title_, entry.line,
                                  to_string(entry.object), reason);
    if (!options_.force) return fail(Errc::refused, what, "nothing was written; --force restores the rest");
    context_->notices.push_back(what + "; it is left out");
    return {};
  }

  Result<void> read_present() {
    std::map<ObjectAddress, std::string_view> settings;
    for (const auto& setting : drive::settings_of(*context_->profile))
      settings.emplace(setting.entry->address, setting.left_out);
    std::vector<ObjectAddress> objects;
    for (const auto& entry : backup_->entries) {
      if (!entry.bytes || (is_address(entry.object) && !options_.with_address)) continue;
      const auto setting = settings.find(entry.object);
      const auto reason =
          setting == settings.end() ? std::string_view("not in its data, or read-only") : setting->second;
      if (!reason.empty()) {
        if (const auto left_out = leave_out(entry, reason); !left_out) return left_out;
        continue;
      }
      wanted_.emplace(entry.object, for_this_node(entry.object, *entry.bytes));
      objects.push_back(entry.object);
    }
    const auto read = session::read_objects(*context_->session, node_, objects);
    if (!read) return tl::unexpected<Error>(read.error());
    for (const auto& entry : *read) {
      if (entry.bytes && entry.bytes->size() == wanted_.at(entry.object).size()) {
        present_.emplace(entry.object, *entry.bytes);
        continue;
      }
      if (!options_.force)
        return fail(
            Errc::negative,
            fmt::format("{}:{}: {} of the backup: {}", title_, line_of(entry.object), to_string(entry.object),
                        entry.bytes ? "the drive's has another length" : entry.left_out),
            "nothing was written; --force restores the rest");
      wanted_.erase(entry.object);
    }
    return {};
  }

  std::uint32_t line_of(ObjectAddress object) const {
    for (const auto& entry : backup_->entries)
      if (entry.object == object) return entry.line;
    return 0;
  }

  /// Nothing is written unless everything can be.
  Result<void> check_values() const {
    for (const auto& [object, data] : wanted_) {
      if (present_.at(object) == data) continue;
      const auto target = drive::target_at(context_->profile, object);
      auto meaning = drive::fitted(drive::meaning(target, node_), data.size());
      const auto value = meaning.type_known ? od::decode(meaning.type, data)
                                            : Result<od::Value>(od::Value(std::uint64_t{0}));
      const bool writable = od::writable(meaning.access);
      const auto limits = value && meaning.type_known ? drive::check_limits(meaning, *value) : Result<void>{};
      if (writable && value && limits) continue;
      return fail(Errc::negative,
                  fmt::format("{}:{}: {}: {}", title_, line_of(object), name_of(target),
                              !writable ? "is read-only"
                              : !value  ? value.error().message
                                        : limits.error().message),
                  "nothing was written");
    }
    return {};
  }

  Value planned() const {
    std::vector<Change> changes;
    for (const auto& step : session::plan_writes(context_->profile, present_, wanted_))
      changes.push_back({node_, drive::target_at(context_->profile, step.object), {}, step.data});
    return planned_frames(changes);
  }

  /// What the drive holds now, beside the backup: the way back when everything else fails.
  Result<void> save_present() {
    session::Snapshot snapshot;
    snapshot.identity = identity_;
    for (const auto& [object, data] : present_) snapshot.entries.push_back({object, data, {}});
    return write_file_atomically(before_, backup_text(*context_, make_backup(*context_, snapshot)));
  }

  Result<Value> carry_out(Record record) {
    const auto outcome =
        session::restore(*context_->session, context_->profile, node_, present_, wanted_,
                         {.roll_back = options_.roll_back, .keep = options_.keep, .unlock = options_.unlock});
    for (const auto& notice : outcome.notices) context_->notices.push_back(notice);
    context_->notices.push_back(fmt::format("what node {} held before is in {}", node_, before_.string()));
    if (!outcome.failure) return result(std::move(record), "restored", outcome);
    context_->errors.push_back(*outcome.failure);
    if (outcome.rolled_back)
      return result(std::move(record), "failed; every value is as it was before", outcome);
    for (const auto object : outcome.astray) {
      Error error;
      error.code = Errc::negative;
      error.node = node_;
      error.object = object;
      error.message = fmt::format(
          "node {}, object {}: neither the value of the backup nor the one from before is certain", node_,
          to_string(object));
      context_->errors.push_back(std::move(error));
    }
    return result(std::move(record), failed_state(outcome), outcome);
  }

  static std::string_view failed_state(const session::RestoreOutcome& outcome) {
    if (outcome.all_written) return "written and read back; see the error";
    return outcome.astray.empty() ? "failed; what was written stays written" : "failed; see the errors";
  }

  static Value kept_value(const std::optional<session::RestoreOutcome>& outcome) {
    if (!outcome || outcome->kept == session::Kept::unknown) return {};
    return outcome->kept == session::Kept::yes;
  }

  Value result(Record record, std::string_view state,
               const std::optional<session::RestoreOutcome>& outcome) const {
    Record out{{"node", node_}, {"result", state}, {"kept", kept_value(outcome)}};
    for (auto& field : record) out.push_back(std::move(field));
    return out;
  }

  Context* context_;
  const Backup* backup_;
  std::string title_;
  std::uint8_t node_;
  std::filesystem::path before_;
  RestoringOptions options_;
  session::Identity identity_;
  session::Values wanted_;
  session::Values present_;
};

}  // namespace

Result<Value> put_into(Context& context, const Backup& backup, const std::string& title, std::uint8_t node,
                       const std::filesystem::path& before, const RestoringOptions& options) {
  return Restoring(context, backup, title, node, before, options).run();
}

}  // namespace servoctl::commands
