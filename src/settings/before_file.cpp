#include "settings/before_file.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "session/open_bus.hpp"
#include "settings/restore_journal.hpp"
#include "show/identity.hpp"

namespace servoctl::settings {
namespace {

namespace fs = std::filesystem;

constexpr int kMostDrives = 99;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

fs::path lock_of(const fs::path& before) { return journal_of(before).string() + ".lock"; }

tl::unexpected<Error> refuse_second(const Message& title, std::uint8_t node) {
  return fail(Errc::refused, message("another servoctl is restoring {} into node {}", title, node_name(node)),
              "wait until it ends, or find it with `ps`");
}

}  // namespace

Origin origin_of(const show::Desk& desk, const Backup& backup, const session::Identity& drive) {
  auto what = show::other_kind(backup.identity, drive);
  const bool same_serial = drive.serial.value_or(0) != 0 && backup.identity.serial == drive.serial;
  if (what.empty() && !same_serial) what = show::change_of(backup.identity, drive);
  if (!what.empty()) return {Origin::Kind::other, message("{} differs", what), backup.bus};
  const bool same_bus = session::canonical_url(backup.bus) == session::canonical_url(desk.session->url());
  if (same_serial || same_bus) return {};
  return {Origin::Kind::elsewhere, message("it is of the drive on {}", as_it_is(backup.bus)), backup.bus};
}

std::vector<fs::path> before_names(const fs::path& usual) {
  std::vector<fs::path> out{usual};
  for (int drive = 2; drive <= kMostDrives; ++drive)
    out.push_back(usual.parent_path() /
                  formatted("{}-drive-{}{}", usual.stem().string(), drive, usual.extension().string()));
  return out;
}

/// One look through the names.
class BeforeFileSearch {
 public:
  BeforeFileSearch(const show::Desk& desk, const fs::path& usual, const Message& title,
                   const session::Identity& drive, bool holds)
      : desk_(&desk), names_(before_names(usual)), title_(title), drive_(drive), holds_(holds) {}

  Result<BeforeFile> run() {
    for (const auto& name : names_)
      if (const auto known = note(name); !known) return fail(known.error());
    if (const auto own = choose(own_); !own || *own) return finish(own);
    if (const auto clear = refuse_doubt(); !clear) return fail(clear.error());
    if (const auto free = choose(free_); !free || *free) return finish(free);
    return fail(Errc::file, message("{} has a file of old values of {} drives already", title_, kMostDrives),
                "move those that are not needed any more into another folder");
  }

 private:
  /// Empty when there is none under this name.
  Result<std::optional<Origin>> look(const fs::path& name) const {
    const bool has_journal = is_file(journal_of(name));
    if (!has_journal && !is_file(name)) return std::optional<Origin>();
    const auto before = read_backup(name);
    if (before) return std::optional(origin_of(*desk_, *before, drive_));
    if (!has_journal) return std::optional(Origin{Origin::Kind::unknown, "it cannot be read"});
    // What is wrong with it as well is told first.
    if (const auto journal = read_journal(*desk_, journal_of(name)); !journal) return fail(journal.error());
    return fail(Errc::file,
                message("{} cannot be read: nothing tells of which drive {} is", as_it_is(name.string()),
                        as_it_is(journal_of(name).string())),
                "put the file of the old values back, or delete the journal if it is not to be resumed");
  }

  Result<void> note(const fs::path& name) {
    const auto found = look(name);
    if (!found) return fail(found.error());
    if (!*found)
      free_.push_back(name);
    else if ((*found)->kind == Origin::Kind::same)
      own_.push_back(name);
    else
      out_.passed_over_.push_back({name, **found, is_file(journal_of(name))});
    return {};
  }

  /// Takes the first that nobody holds for another drive, and that is still what it was: false when there is
  /// none.
  Result<bool> choose(const std::vector<fs::path>& names) {
    for (const auto& name : names) {
      out_.path_ = name;
      if (!holds_) return true;
      auto lock = FileLock::take(lock_of(name), tag());
      if (!lock) return fail(lock.error());
      if (!*lock) {
        const auto holder = FileLock::holder(lock_of(name));
        const bool elsewhere = !is_file(name) && !holder.empty() && holder != tag();
        if (!elsewhere) return refuse_second(title_, drive_.node);
        continue;
      }
      const auto now = look(name);
      if (!now) return fail(now.error());
      if (*now && (*now)->kind != Origin::Kind::same) continue;
      out_.lock_.emplace(std::move(**lock));
      return true;
    }
    return false;
  }

  /// A restore that was cut off is not begun anew because its adapter has another name now. One that runs is
  /// on another bus.
  Result<void> refuse_doubt() const {
    for (const auto& other : out_.passed_over_) {
      if (other.origin.kind != Origin::Kind::elsewhere || !other.has_journal) continue;
      const auto lock = FileLock::take(lock_of(other.path));
      if (!lock) return fail(lock.error());
      if (!*lock) continue;
      return fail(drive_error(
          Errc::refused, drive_.node,
          message("a restore of {} was interrupted on {}, and nothing tells whether this is that drive",
                  title_, as_it_is(other.origin.bus)),
          message("where it is, `restore {} -n {} --force` restores the old values; where it is not, move "
                  "that file and its journal into another folder",
                  as_it_is(other.path.string()), node_name(drive_.node))));
    }
    return {};
  }

  Result<BeforeFile> finish(const Result<bool>& chosen) {
    if (!chosen) return fail(chosen.error());
    return std::move(out_);
  }

  std::string tag() const { return session::canonical_url(desk_->session->url()); }

  const show::Desk* desk_;
  std::vector<fs::path> names_;
  Message title_;
  session::Identity drive_;
  bool holds_;
  std::vector<fs::path> own_;
  std::vector<fs::path> free_;
  BeforeFile out_;
};

Result<BeforeFile> BeforeFile::take(const show::Desk& desk, const fs::path& usual, const Message& title,
                                    const session::Identity& drive) {
  return BeforeFileSearch(desk, usual, title, drive, !desk.dry_run).run();
}

Result<BeforeFile> BeforeFile::find(const show::Desk& desk, const fs::path& usual, const Message& title,
                                    const session::Identity& drive) {
  return BeforeFileSearch(desk, usual, title, drive, false).run();
}

fs::path BeforeFile::journal() const { return journal_of(path_); }

}  // namespace servoctl::settings
