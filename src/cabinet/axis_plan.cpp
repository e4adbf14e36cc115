#include "cabinet/axis_plan.hpp"

#include <algorithm>
#include <set>

#include "base/format.hpp"
#include "base/pdo_index.hpp"
#include "cabinet/axis_identity.hpp"
#include "cabinet/axis_values.hpp"
#include "drive/bitrate.hpp"
#include "drive/naming.hpp"
#include "session/open_bus.hpp"
#include "session/pdo_setup.hpp"
#include "session/snapshot.hpp"
#include "session/state_pause.hpp"
#include "settings/comparison.hpp"
#include "settings/selection.hpp"
#include "show/owed_restart.hpp"

namespace servoctl::cabinet {
namespace {

using report::Record;
using report::Show;
using report::Table;
using report::Value;

/// The table of a comparison, its sides called as they are here.
Table table_of(const settings::Comparison& comparison, std::string_view a, std::string_view b) {
  for (const auto& field : comparison.record) {
    const auto* found = field.value.table();
    if (field.key != "differences" || found == nullptr) continue;
    auto table = *found;
    for (auto& column : table.columns) {
      const auto side = column.key == "a" || column.key == "a_text"   ? a
                        : column.key == "b" || column.key == "b_text" ? b
                                                                      : std::string_view();
      if (!side.empty()) column.key = std::string(side) + column.key.substr(1);
    }
    return table;
  }
  return {};
}

/// The objects that another one stands for: what a drive copies from one into the other at its start.
std::set<ObjectAddress> with_copies(const drive::Profile& profile, const session::Values& values) {
  std::set<ObjectAddress> out;
  for (const auto& value : values) out.insert(value.first);
  for (const auto& parameter : profile.parameters) {
    if (!parameter.mirror || !parameter.object) continue;
    if (values.count(*parameter.mirror) > 0) out.insert(*parameter.object);
    if (values.count(*parameter.object) > 0) out.insert(*parameter.mirror);
  }
  return out;
}

/// Without the entries of mappings behind their counts: whatever they hold means nothing.
void drop_unused_entries(std::map<ObjectAddress, Bytes>& values) {
  std::erase_if(values, [&](const auto& value) {
    const auto object = value.first;
    const auto count = values.find({object.index, 0});
    return is_pdo_mapping(object.index) && object.sub > 0 && count != values.end() &&
           load_le(count->second) < object.sub;
  });
}

/// PDO mappings (1600h to 1BFFh), and what the sync managers have of them (1C00h to 1C3Fh).
constexpr std::pair<std::uint16_t, std::uint16_t> kProcessData{0x1600, 0x1C3F};

/// A look at one axis.
class AxisPlanner {
 public:
  AxisPlanner(show::Desk& desk, const Cabinet& cabinet, const Axis& axis, const PlanChoice& choice)
      : desk_(&desk), cabinet_(&cabinet), axis_(&axis), choice_(&choice) {}

  Result<AxisPlan> plan(std::optional<settings::Backup> wanted) {
    auto identity = hold_axis_identity(*desk_, *axis_, choice_->families);
    if (!identity) return fail(identity.error());
    out_.identity = std::move(*identity);
    // A group of parameters that another family has is no part of this one's settings.
    part_ = settings::selection_of(*desk_->profile, choice_->only).value_or([](ObjectAddress /*object*/) {
      return false;
    });
    resumes_ = wanted.has_value();
    if (const auto chosen = choose(std::move(wanted)); !chosen) return fail(chosen.error());
    if (const auto compared = compare_wanted(); !compared) return fail(compared.error());
    if (choice_->unlisted)
      for (const auto look : {&AxisPlanner::read_unlisted, &AxisPlanner::note_bitrate})
        if (const auto read = (this->*look)(); !read) return fail(read.error());
    return std::move(out_);
  }

 private:
  Result<void> choose(std::optional<settings::Backup> wanted) {
    if (wanted) {
      out_.wanted = std::move(*wanted);
      listed_ = with_copies(*desk_->profile, values_of_backup());
      return {};
    }
    auto made = wanted_backup(*desk_, *cabinet_, *axis_, choice_->keep);
    if (!made) return fail(made.error());
    out_.wanted = std::move(*made);
    listed_ = with_copies(*desk_->profile, values_of_backup());
    if (part_) std::erase_if(out_.wanted.entries, [&](const auto& entry) { return !part_(entry.object); });
    return {};
  }

  session::Values values_of_backup() const {
    session::Values out;
    for (const auto& entry : out_.wanted.entries)
      if (entry.bytes) out.emplace(entry.object, *entry.bytes);
    return out;
  }

  Result<void> compare_wanted() {
    settings::RestoreTarget target(*desk_, out_.wanted, as_it_is(cabinet_->file.string()), axis_->node,
                                   {.with_address = true, .keep = choice_->keep, .only_looks = true});
    if (const auto fits = target.prepare(); !fits) return fail(fits.error());
    out_.present = target.present();
    const auto node = axis_->node;
    const auto comparison = settings::compare(
        desk_->profile, {"drive", node, target.present_and_left()},
        {resumes_ ? "interrupted apply" : cabinet_->file.filename().string(), node, target.wanted_and_left()},
        true, desk_->chinese);
    out_.different = comparison.different;
    out_.to_write = target.to_write();
    out_.left = target.left();
    out_.compared = comparison.compared;
    out_.differences = differences(table_of(comparison, "present", "wanted"));
    auto needs = needs_of(*desk_->session, *desk_->profile, node, target.present(), target.wanted());
    if (!needs) return fail(needs.error());
    out_.needs = std::move(*needs);
    note_owed();
    return note_pdos(target.present(), target.wanted());
  }

  /// What the drive has stored it goes by only after a restart.
  void note_owed() {
    const auto owed = show::owed_restart(*desk_->session, desk_->state_folder, axis_->node);
    if (auto notice = show::owed_notice(*desk_, axis_->node, owed); !notice.empty())
      desk_->notices.push_back(std::move(notice));
    out_.owed = show::owed_names(desk_->profile, owed.values);
    for (const auto& name : out_.owed) add_need(out_.needs, AxisNeed::Kind::restart, name);
  }

  /// With the line of the file that says it.
  Value differences(Table table) const {
    table.columns.push_back({"line", "", Show::json});
    for (auto& row : table.rows) {
      Value line;
      for (const auto& entry : out_.wanted.entries)
        if (std::get<std::string>(row.front().data()) == to_string(entry.object)) line = Value(entry.line);
      row.push_back(std::move(line));
    }
    return table.rows.empty() ? Value() : Value(std::move(table));
  }

  /// The PDOs as they are and will be, for those who share the bus.
  Result<void> note_pdos(const session::Values& present, const session::Values& wanted) {
    const bool changes = std::any_of(wanted.begin(), wanted.end(), [&](const auto& value) {
      return pdo_at(value.first.index) && present.at(value.first) != value.second;
    });
    if (!changes) return {};
    const std::uint8_t nodes[] = {axis_->node};
    auto values = std::move(session::read_pdo_values(*desk_->session, desk_->profile, nodes).front());
    if (!values) return fail(values.error());
    out_.pdos_before = session::pdos_of(*values);
    for (const auto& [object, data] : wanted)
      if (pdo_at(object.index)) values->insert_or_assign(object, data);
    out_.pdos_after = session::pdos_of(*values);
    return {};
  }

  /// Of a slave in OP: its PDOs and their assignment are those with which the process data began.
  Result<bool> has_process_data() {
    if (desk_->session->ethercat() == nullptr) return false;
    const auto state = session::ask_state(*desk_->session, axis_->node);
    if (!state) return fail(state.error());
    if (*state != session::NodeState::operational) return false;
    desk_->notices.push_back(message(
        "node {} is in OP: its PDOs are those of the process data, and not compared with the factory's",
        node_name(axis_->node)));
    return true;
  }

  Result<void> read_unlisted() {
    const auto& profile = *desk_->profile;
    const auto process_data = has_process_data();
    if (!process_data) return fail(process_data.error());
    const auto wanted = [&](const drive::DriveSetting& setting) {
      const auto object = setting.entry->address;
      const bool mapped = is_pdo_mapping(object.index) && listed_.count({object.index, 0}) > 0;
      const bool of_process_data =
          *process_data && object.index >= kProcessData.first && object.index <= kProcessData.second;
      return listed_.count(object) == 0 && !mapped && !of_process_data &&
             !settings::is_address(&profile, object) && (!part_ || part_(object));
    };
    const std::uint8_t nodes[] = {axis_->node};
    const auto snapshot = session::take_snapshots(*desk_->session, profile, nodes, wanted).front();
    if (!snapshot) return fail(snapshot.error());
    settings::Side drive{"drive", axis_->node, {}};
    for (const auto& entry : snapshot->entries)
      if (entry.bytes) drive.values.emplace(entry.object, *entry.bytes);
    drop_unused_entries(drive.values);
    auto factory = settings::factory_side(profile, axis_->node);
    const auto comparison = settings::compare(&profile, drive, factory, false, desk_->chinese);
    out_.unlisted_count = comparison.different;
    if (comparison.different > 0) out_.unlisted = table_of(comparison, "present", "factory");
    return {};
  }

  /// A bitrate that is stored and not that of the file, where nothing tells that the bus runs at that of the
  /// file: no apply writes it.
  Result<void> note_bitrate() {
    const auto& profile = *desk_->profile;
    const auto* bus = cabinet_->bus(axis_->bus);
    const auto object = drive::place_of(profile, profile.rules.nmt.bitrate);
    if (bus == nullptr || bus->bitrate.empty() || !object || desk_->session->network().is_ring()) return {};
    const auto rate = drive::parse_bitrate(bus->bitrate);
    const auto code = rate ? drive::bitrate_code(profile, *rate) : Result<std::int64_t>(fail(rate.error()));
    if (!code || session::runs_at(desk_->session->url(), *rate)) return {};
    const auto held = desk_->session->upload(axis_->node, *object);
    if (!held) return fail(held.error());
    if (static_cast<std::int64_t>(load_le(*held)) == *code) return {};
    const auto runs = session::bitrate_of(desk_->session->url());
    const auto stored = stored_bitrate(profile, load_le(*held));
    const auto said = drive::bitrate_text(*rate);
    desk_->notices.push_back(
        runs
            ? message(
                  "axis {}: {} is {}, the file says {}, and bus {} runs at {}: no bitrate is written; correct "
                  "the file, or the bus (`bus status`)",
                  as_it_is(axis_->name), profile.rules.nmt.bitrate, stored, said, as_it_is(bus->name),
                  drive::bitrate_text(*runs))
            : message(
                  "axis {}: {} is {}, the file says {}, and nothing tells at which bitrate bus {} runs: none is "
                  "written; where it is that of the file, `address --bitrate {} -n {}` sets it",
                  as_it_is(axis_->name), profile.rules.nmt.bitrate, stored, said, as_it_is(bus->name),
                  as_it_is(bus->bitrate), as_it_is(axis_->name)));
    return {};
  }

  static std::string stored_bitrate(const drive::Profile& profile, std::uint64_t code) {
    for (const auto rate : drive::bitrates_of(profile))
      if (drive::bitrate_code(profile, rate).value_or(-1) == static_cast<std::int64_t>(code))
        return drive::bitrate_text(rate);
    return formatted("{}, which is no bitrate", code);
  }

  show::Desk* desk_;
  const Cabinet* cabinet_;
  const Axis* axis_;
  const PlanChoice* choice_;
  settings::Selection part_;
  bool resumes_ = false;  ///< An apply that was interrupted: what it was to write goes before the file.
  std::set<ObjectAddress> listed_;
  AxisPlan out_;
};

}  // namespace

Result<AxisPlan> plan_axis(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                           const PlanChoice& choice) {
  return AxisPlanner(desk, cabinet, axis, choice).plan(std::nullopt);
}

Result<AxisPlan> plan_axis(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                           settings::Backup wanted, const PlanChoice& choice) {
  return AxisPlanner(desk, cabinet, axis, choice).plan(std::move(wanted));
}

}  // namespace servoctl::cabinet
