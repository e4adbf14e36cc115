#include "cabinet/cabinet_diff.hpp"

#include <algorithm>
#include <set>

#include "base/format.hpp"
#include "cabinet/axis_identity.hpp"
#include "cabinet/axis_values.hpp"
#include "cabinet/cabinet_side.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "settings/comparison.hpp"
#include "show/reading.hpp"

namespace servoctl::cabinet {
namespace {

using report::Record;
using report::Show;
using report::Table;
using report::Value;
using settings::Side;

/// Two cabinets, one row of the answer a difference.
class CabinetDifference {
 public:
  CabinetDifference(show::Desk& desk, const CabinetSide& a, const CabinetSide& b, const LoadProfile& load)
      : desk_(&desk), a_(&a), b_(&b), load_(&load) {
    table_.columns = {{"axis"}, {"object"}, {"name"}, {"a", a.title}, {"b", b.title}};
  }

  Result<Value> run() {
    auto axes = a_->axes();
    const auto in_a = std::set<std::string>(axes.begin(), axes.end());
    for (const auto& axis : b_->axes())
      if (in_a.count(axis) == 0) axes.push_back(axis);
    for (const auto& axis : axes)
      if (const auto done = compare_axis(axis); !done) return fail(done.error());
    if (different_ > 0)
      tell(message("{} of {} values differ between {} and {}", different_, compared_, as_it_is(a_->title),
                   as_it_is(b_->title)));
    if (in_one_ > 0)
      tell(message("{} in one of {} and {} only",
                   in_one_ == 1 ? "1 axis stands" : message("{} axes stand", in_one_), as_it_is(a_->title),
                   as_it_is(b_->title)));
    return Value(
        Record{{"compared", compared_},
               {"different", different_},
               {"axes_in_one", in_one_, Show::json},
               {"differences", table_, Show::json},
               {"table", table_.rows.empty() ? Value() : Value(shown()), Show::text, "differences"}});
  }

 private:
  /// The table, with the names that the family of each axis has in the language of who reads.
  Table shown() const {
    constexpr std::size_t kName = 2;
    auto out = table_;
    for (auto& row : out.rows)
      if (const auto* name = std::get_if<std::string>(&row[kName].data()))
        if (const auto found = chinese_.find(*name); found != chinese_.end()) row[kName] = found->second;
    return out;
  }

  void tell(Message what) { desk_->errors.push_back(make_error(Errc::negative, std::move(what))); }

  Result<void> compare_axis(const std::string& name) {
    const auto has = [&](const CabinetSide& side) {
      return side.backups.count(name) > 0 || (side.file && side.file->axis(name) != nullptr);
    };
    if (!has(*a_) || !has(*b_)) {
      ++in_one_;
      table_.rows.push_back({name, Value(), "axis", has(*a_) ? "there" : "-", has(*b_) ? "there" : "-"});
      return {};
    }
    if (a_->file && b_->file) return compare_files(name);
    if (!a_->file && !b_->file) return compare_backups(name);
    return compare_with_backup(name);
  }

  void add(const std::string& axis, const std::string& name, const std::string& a, const std::string& b,
           const std::string& object = {}) {
    ++different_;
    table_.rows.push_back({axis, report::text_or_null(object), report::text_or_null(name), a, b});
  }

  Result<void> compare_files(const std::string& name) {
    const auto a = all_said(*a_->file->axis(name));
    const auto b = all_said(*b_->file->axis(name));
    std::set<std::string> names;
    for (const auto* side : {&a, &b})
      for (const auto& said : *side) names.insert(said.first);
    for (const auto& each : names) {
      ++compared_;
      const auto text = [&](const auto& side) {
        const auto found = side.find(each);
        return found == side.end() ? std::string("-") : found->second;
      };
      if (text(a) != text(b)) add(name, each, text(a), text(b));
    }
    return {};
  }

  /// Parameters by what they are called at the drive, however the file writes them, and with the number that
  /// is sent, as far as the data tells it.
  std::map<std::string, std::string> all_said(const Axis& axis) {
    auto out = said_of(axis);
    const auto profile = (*load_)(axis.family);
    for (const auto& setting : axis.parameters) {
      const auto target =
          profile ? drive::resolve(*profile, setting.name) : Result<drive::Target>(fail(profile.error()));
      const auto name = target ? target->in_sentence() : setting.name;
      out[name] = target ? plain(axis, *target, setting.value) : setting.value;
      if (desk_->chinese && target) chinese_[name] = target->in_sentence_zh();
    }
    return out;
  }

  static std::string plain(const Axis& axis, const drive::Target& target, const std::string& value) {
    const auto meaning = drive::meaning(target, axis.node);
    if (!meaning.type_known) return value;
    const auto number = drive::parse_quantity(meaning, in_units_of_motor(axis, value));
    const auto bytes = number ? od::encode(meaning.type, *number) : Result<Bytes>(fail(number.error()));
    if (!bytes) return value;
    return show::decode_value({axis.node, target, {}, *bytes}, *bytes).text;
  }

  Result<void> compare_backups(const std::string& name) {
    const auto& a = a_->backups.at(name);
    const auto& b = b_->backups.at(name);
    if (a.family != b.family) {
      ++compared_;
      add(name, "family", a.family, b.family);
      return {};
    }
    if (a.identity.serial && b.identity.serial && a.identity.serial != b.identity.serial)
      desk_->notices.push_back(message("axis {}: another drive: serial number {} in {}, {} in {}",
                                       as_it_is(name), serial_text(*a.identity.serial), as_it_is(a_->title),
                                       serial_text(*b.identity.serial), as_it_is(b_->title)));
    const auto profile = (*load_)(a.family);
    if (!profile) return fail(profile.error());
    compare_sides(name, **profile, settings::side_of(a, a_->title), settings::side_of(b, b_->title));
    return {};
  }

  Result<void> compare_with_backup(const std::string& name) {
    const auto& files = a_->file ? *a_ : *b_;
    const auto& folder = a_->file ? *b_ : *a_;
    const auto& axis = *files.file->axis(name);
    const auto& backup = folder.backups.at(name);
    if (axis.family != backup.family) {
      ++compared_;
      add(name, "family", a_->file ? axis.family : backup.family, a_->file ? backup.family : axis.family);
      return {};
    }
    const auto profile = (*load_)(axis.family);
    if (!profile) return fail(profile.error());
    auto held = settings::side_of(backup, folder.title);
    show::Desk desk;
    desk.profile = *profile;
    const auto wanted = wanted_of_held(desk, *files.file, axis, held.values);
    for (const auto& notice : desk.notices) desk_->notices.push_back(notice);
    if (!wanted) return fail(wanted.error());
    const auto said = settings::side_of(*wanted, files.title);
    std::erase_if(held.values, [&](const auto& value) { return said.values.count(value.first) == 0; });
    compare_sides(name, **profile, a_->file ? said : held, a_->file ? held : said);
    return {};
  }

  void compare_sides(const std::string& name, const drive::Profile& profile, const Side& a, const Side& b) {
    const auto comparison = settings::compare(&profile, a, b, true, desk_->chinese);
    compared_ += comparison.compared;
    for (const auto& field : comparison.record) {
      const auto* rows = field.value.table();
      if (field.key != "differences" || rows == nullptr) continue;
      for (const auto& row : rows->rows) {
        // Object, name, and the two values as text: see settings::compare().
        const auto* label = std::get_if<std::string>(&row.at(4).data());
        add(name, label != nullptr ? *label : std::string(), std::get<std::string>(row.at(5).data()),
            std::get<std::string>(row.at(7).data()), std::get<std::string>(row.at(0).data()));
      }
    }
  }

  show::Desk* desk_;
  const CabinetSide* a_;
  const CabinetSide* b_;
  const LoadProfile* load_;
  Table table_;
  std::map<std::string, std::string> chinese_;  ///< What a label is in Chinese.
  std::size_t compared_ = 0;
  std::size_t different_ = 0;
  std::size_t in_one_ = 0;  ///< Axes that the other side does not have.
};

}  // namespace

Result<Value> compare_cabinets(show::Desk& desk, const std::filesystem::path& a,
                               const std::filesystem::path& b, const LoadProfile& load) {
  const auto left = open_cabinet_side(a);
  if (!left) return fail(left.error());
  const auto right = open_cabinet_side(b);
  if (!right) return fail(right.error());
  return CabinetDifference(desk, *left, *right, load).run();
}

}  // namespace servoctl::cabinet
