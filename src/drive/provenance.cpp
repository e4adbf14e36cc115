#include "drive/provenance.hpp"

#include <filesystem>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/family_files.hpp"
#include "drive/profile.hpp"
#include "drive/toml_depth.hpp"
#include "drive/toml_reader.hpp"

namespace servoctl::drive {
namespace {

bool read_drive(const toml::node& node, TriedDrive& out) {
  return has_only(node, {"model", "firmware", "date"}) && drive::get(at(node, "model"), out.model) &&
         drive::get(at(node, "firmware"), out.firmware) && drive::get(at(node, "date"), out.date) &&
         !out.model.empty() && !out.firmware.empty() && !out.date.empty();
}

}  // namespace

Result<Provenance> read_provenance(const TableReader& reader) {
  Provenance out;
  const auto drives = [&](const toml::node& node) {
    return get_list(node, out.drives, [](const toml::node& n, TriedDrive& o) { return read_drive(n, o); });
  };
  const auto done = reader.read({{"manual", into(out.manual)},
                                 {"manual_zh", into(out.manual_zh)},
                                 {"simulator", into(out.simulator)},
                                 {"drives", drives}});
  if (!done) return fail(done.error());
  return out;
}

Provenance provenance_of(const Profile& profile) {
  const auto file = std::filesystem::path(profile.data_sheet).replace_extension(".toml");
  std::error_code ignored;
  if (profile.data_sheet.empty() || !std::filesystem::exists(file, ignored) || !check_family_file(file))
    return {};
  const auto text = read_file(file);
  if (!text || !check_toml_depth(*text, file.string())) return {};
  const auto parsed = toml::parse(*text);
  if (!parsed || !equals_nocase(parsed.table()["family"].value_or(std::string()), profile.family)) return {};
  const auto* section = parsed.table()["provenance"].as_table();
  if (section == nullptr) return {};
  return read_provenance(TableReader(*section, "")).value_or(Provenance());
}

std::string provenance_text(const Profile& profile, bool chinese) {
  const auto known = provenance_of(profile);
  if (known.manual.empty() && known.drives.empty()) return "not stated";
  const auto& manual = chinese && !known.manual_zh.empty() ? known.manual_zh : known.manual;
  std::string tried;
  for (const auto& drive : known.drives)
    append(tried, formatted("{} with firmware {} ({})", drive.model, drive.firmware, drive.date));
  if (!tried.empty()) return formatted("{}; tried on {}", manual, tried);
  return known.simulator ? formatted("{} and the simulated drive; no real drive yet", manual)
                         : formatted("{}; no real drive yet", manual);
}

}  // namespace servoctl::drive
