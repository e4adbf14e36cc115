#include "cabinet/cabinet_side.hpp"
#include "base/format.hpp"
#include "base/number.hpp"

#include <fmt/format.h>
#include <system_error>

namespace servoctl::cabinet {
namespace {

namespace fs = std::filesystem;

Result<CabinetSide> open_folder(const fs::path& folder) {
  CabinetSide out{folder.string(), std::nullopt, {}};
  std::error_code error;
  for (const auto& file : fs::directory_iterator(folder, error)) {
    if (file.path().extension() != ".json") continue;
    auto backup = settings::read_backup(file.path());
    if (!backup) return fail(backup.error());
    out.backups.emplace(file.path().stem().string(), std::move(*backup));
  }
  if (error) return fail(Errc::file, message("{}: {}", as_it_is(folder.string()), error.message()));
  if (out.backups.empty())
    return fail(Errc::file, message("{} contains no backup", as_it_is(folder.string())),
                "name a folder of `cabinet backup`, or a cabinet file");
  return out;
}

void say(std::map<std::string, std::string>& out, const std::string& name, const std::string& value) {
  if (!value.empty()) out.emplace(name, value);
}

template <class T>
void say(std::map<std::string, std::string>& out, const std::string& name, const std::optional<T>& value) {
  if (value) out.emplace(name, formatted("{}", *value));
}

void say_recipe(std::map<std::string, std::string>& out, const drive::PdoRecipe& recipe) {
  if (recipe.map) say(out, recipe.pdo + " map", formatted("{}", fmt::join(*recipe.map, ", ")));
  say(out, recipe.pdo + " cob_id", recipe.cob_id);
  say(out, recipe.pdo + " valid", recipe.valid);
  say(out, recipe.pdo + " type", recipe.type);
  say(out, recipe.pdo + " inhibit_us", recipe.inhibit_us);
  say(out, recipe.pdo + " event_ms", recipe.event_ms);
  say(out, recipe.pdo + " sync_start", recipe.sync_start);
}

}  // namespace

std::vector<std::string> CabinetSide::axes() const {
  std::vector<std::string> out;
  if (file)
    for (const auto& axis : file->axes) out.push_back(axis.name);
  for (const auto& backup : backups) out.push_back(backup.first);
  return out;
}

Result<CabinetSide> open_cabinet_side(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return open_folder(path);
  auto file = read_cabinet(path);
  if (!file) return fail(file.error());
  return CabinetSide{path.string(), std::move(*file), {}};
}

std::map<std::string, std::string> said_of(const Axis& axis) {
  std::map<std::string, std::string> out;
  say(out, "bus", axis.bus);
  say(out, "node", formatted("{}", axis.node));
  say(out, "family", axis.family);
  say(out, "groups", formatted("{}", fmt::join(axis.groups, ", ")));
  say(out, "serial", axis.serial);
  say(out, "turn", axis.turn);
  say(out, "encoder", axis.encoder);
  if (axis.load)
    say(out, "load", formatted("{} {}/rev", plain_number(axis.load->per_rev, 9), axis.load->unit));
  say(out, "limits speed", axis.limits.speed);
  say(out, "limits torque", axis.limits.torque);
  say(out, "limits window", axis.limits.window);
  say(out, "limits following_error", axis.limits.following_error);
  if (axis.heartbeat)
    say(out, "heartbeat",
        formatted("{} ms", std::chrono::duration_cast<std::chrono::milliseconds>(*axis.heartbeat).count()));
  say(out, "pdos", axis.pdos.preset);
  say(out, "pdos file", axis.pdos.file.string());
  for (const auto& recipe : axis.pdos.recipes) say_recipe(out, recipe);
  return out;
}

}  // namespace servoctl::cabinet
