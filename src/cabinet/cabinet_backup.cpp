#include "cabinet/cabinet_backup.hpp"

#include <unistd.h>
#include <algorithm>
#include <system_error>

#include "base/calendar.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "cabinet/axis_identity.hpp"
#include "cabinet/cabinet_plan.hpp"
#include "report/told.hpp"
#include "session/snapshot.hpp"
#include "settings/backup_file.hpp"
#include "show/records.hpp"

namespace servoctl::cabinet {
namespace {

namespace fs = std::filesystem;
using report::Value;

/// The backup of one axis, on its way to its file.
struct SavedAxis {
  const Axis* axis = nullptr;
  Result<std::string> text;
  std::size_t values = 0;
  std::size_t left_out = 0;
  std::vector<Message> notices = {};
};

Result<settings::Backup> read_axis(show::Desk& desk, const Axis& axis,
                                   std::span<const drive::Family> families) {
  if (const auto held = hold_axis_identity(desk, axis, families); !held) return fail(held.error());
  auto snapshot =
      std::move(session::take_snapshots_patiently(*desk.session, *desk.profile, desk.nodes, {}).front());
  if (!snapshot) return fail(snapshot.error());
  auto backup = settings::make_backup(desk, *snapshot);
  settings::tell_left_out(desk, backup);
  return backup;
}

void save(show::Desk desk, SavedAxis& out, std::span<const drive::Family> families) {
  const auto backup = read_axis(desk, *out.axis, families);
  out.notices = std::move(desk.notices);
  if (!backup) {
    out.text = fail(backup.error());
    return;
  }
  for (const auto& entry : backup->entries) ++(entry.bytes ? out.values : out.left_out);
  out.text = settings::backup_text(desk, *backup);
}

/// A name that nobody has: two backups may be made in one second.
fs::path free_name(const fs::path& parent) {
  auto time = utc_now_text();
  std::replace(time.begin(), time.end(), ':', '-');
  std::error_code ignored;
  auto out = parent / ("backup-" + time);
  for (int i = 2; fs::exists(out, ignored); ++i) out = parent / formatted("backup-{}-{}", time, i);
  return out;
}

/// A folder that goes away unless it gets its name.
class FolderInTheMaking {
 public:
  explicit FolderInTheMaking(fs::path path) : path_(std::move(path)) {}
  FolderInTheMaking(const FolderInTheMaking&) = delete;
  FolderInTheMaking& operator=(const FolderInTheMaking&) = delete;
  ~FolderInTheMaking() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  Result<void> make() const {
    std::error_code error;
    fs::create_directories(path_, error);
    if (error) return fail(Errc::file, message("{}: {}", as_it_is(path_.string()), error.message()));
    return {};
  }
  Result<void> name(const fs::path& name) {
    std::error_code error;
    fs::rename(path_, name, error);
    if (error) return fail(Errc::file, message("{}: {}", as_it_is(name.string()), error.message()));
    path_.clear();
    return {};
  }

 private:
  fs::path path_;
};

Result<void> write_all(const fs::path& folder, const Cabinet& cabinet, std::span<const SavedAxis> axes) {
  for (const auto& saved : axes)
    if (saved.text)
      if (const auto done = write_file_atomically(folder / (saved.axis->name + ".json"), *saved.text); !done)
        return done;
  const auto file = read_file(cabinet.file);
  if (!file) return fail(file.error());
  return write_file_atomically(folder / "cabinet.toml", *file);
}

Value table_of(const show::Desk& desk, std::span<const SavedAxis> axes, const fs::path& folder) {
  report::Table out;
  out.columns = {{"axis"},
                 {"node"},
                 {"family"},
                 {"file"},
                 {"values", "values saved"},
                 {"left_out", "left out"},
                 {"error", "", report::Show::json}};
  for (const auto& saved : axes)
    out.rows.push_back({saved.axis->name, saved.axis->node, saved.axis->family,
                        saved.text ? (folder / (saved.axis->name + ".json")).string()
                                   : report::told(desk.speaks_chinese(), "not saved"),
                        saved.values, saved.left_out,
                        saved.text ? Value() : show::error_record(saved.text.error())});
  return Value(std::move(out));
}

}  // namespace

Result<Value> back_up_cabinet(show::Desk& desk, const Cabinet& cabinet, std::span<const Station> stations,
                              std::span<const drive::Family> families) {
  std::vector<SavedAxis> axes;
  for (const auto& station : stations)
    axes.push_back({station.axis, fail(station.away.value_or(make_error(Errc::interrupted, "not read")))});
  at_all(stations, [&](std::size_t i) { save(desk_at(desk, stations[i]), axes[i], families); });
  for (const auto& saved : axes) {
    for (const auto& notice : saved.notices) desk.notices.push_back(of_axis(*saved.axis, notice));
    if (!saved.text) desk.errors.push_back(of_axis(*saved.axis, saved.text.error()));
  }
  if (desk.errors.size() == axes.size()) {
    auto first = desk.errors.front();
    desk.errors.erase(desk.errors.begin());
    return fail(std::move(first));
  }
  const auto parent = cabinet.file.parent_path();
  FolderInTheMaking making(parent / formatted(".backup-{}.partial", ::getpid()));
  if (const auto made = making.make(); !made) return fail(made.error());
  const auto written = write_all(parent / formatted(".backup-{}.partial", ::getpid()), cabinet, axes);
  if (!written) return fail(written.error());
  const auto folder = free_name(parent);
  if (const auto named = making.name(folder); !named) return fail(named.error());
  return table_of(desk, axes, folder);
}

}  // namespace servoctl::cabinet
