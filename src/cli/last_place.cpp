#include "cli/last_place.hpp"

#include <fmt/format.h>

#include "base/calendar.hpp"
#include "base/file.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "can/socketcan.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "report/value.hpp"
#include "show/field_reader.hpp"

namespace servoctl::cli {
namespace {

constexpr std::uint64_t kPlaceVersion = 1;
constexpr std::uintmax_t kMostPlaceBytes = 1U << 16U;

/// Behind a serial port or an Ethernet port may be another device today, and to open it sends something; a
/// bus of the cabinet may be either.
bool opens_silently(Shell& shell, const std::string& bus) {
  if (bus.find(':') != std::string::npos)
    return bus.starts_with("socketcan:") || bus.starts_with("local:") || bus.starts_with("sim:");
  if (can::is_interface(bus)) return true;
  const auto cabinet = shell.cabinet(shell.defaults());
  return !cabinet || *cabinet == nullptr || (*cabinet)->bus(bus) == nullptr;
}

std::string in_words(const LastPlace& place) {
  std::string out;
  if (!place.bus.empty()) append(out, "bus " + place.bus);
  if (!place.nodes.empty()) append(out, (names_axes(place.nodes) ? "" : "node ") + place.nodes);
  if (!place.drive.empty()) append(out, "family " + place.drive);
  return printable(out);
}

void tell(Shell& shell, const std::string& text) { shell.console().note("notice: " + text + "\n"); }

/// Why the prompt cannot be there.
Result<void> go_to(Shell& shell, const LastPlace& place) {
  auto settings = shell.defaults();
  settings.bus = place.bus;
  for (const auto& [word, value] : {std::pair("use", place.nodes), std::pair("drive", place.drive)}) {
    if (value.empty()) continue;
    auto now = chosen(shell, settings, {word, value});
    if (!now) return fail(now.error());
    settings = std::move(*now);
  }
  if (opens_silently(shell, place.bus))
    if (const auto opened = shell.open(settings); !opened) return fail(opened.error());
  shell.defaults() = std::move(settings);
  return {};
}

}  // namespace

Result<std::optional<LastPlace>> LastPlaceFile::read() const {
  std::error_code error;
  if (!std::filesystem::exists(std::filesystem::symlink_status(path_, error)))
    return std::optional<LastPlace>();
  const auto text = read_file(path_, kMostPlaceBytes);
  if (!text) return fail(text.error());
  const auto document = report::parse_json(*text, path_.string());
  if (!document) return fail(document.error());
  show::FieldReader fields(*document, path_.string());
  if (fields.number("servoctl_prompt", true).value_or(kPlaceVersion) != kPlaceVersion)
    fields.refuse("servoctl_prompt");
  LastPlace out{.bus = fields.text("bus", true),
                .nodes = fields.text("nodes"),
                .drive = fields.text("drive"),
                .time = fields.text("time", true)};
  if (fields.error())
    return fail(Errc::file, *fields.error(), "delete the file; it only remembers where the prompt was");
  return std::optional(std::move(out));
}

Result<void> LastPlaceFile::write(const LastPlace& place) const {
  const report::Record document{{"servoctl_prompt", kPlaceVersion},
                                {"bus", place.bus},
                                {"nodes", report::text_or_null(place.nodes)},
                                {"drive", report::text_or_null(place.drive)},
                                {"time", place.time}};
  return write_file_atomically(path_, report::to_json(document) + "\n");
}

void take_last_place(Shell& shell, const std::filesystem::path& state_folder) {
  const auto& now = shell.defaults();
  const bool told = !now.bus.empty() || !now.nodes.empty() || !now.drive.empty() || !now.cabinet.empty();
  if (told || state_folder.empty()) return;
  const auto last = LastPlaceFile(state_folder).read();
  if (!last) return tell(shell, last.error().message + "; " + last.error().hint);
  if (!*last || (*last)->bus.empty()) return;
  const auto& place = **last;
  if (const auto there = go_to(shell, place); !there)
    return tell(shell, fmt::format("not as last time ({}): {}; `bus` and `use` say where to go",
                                   in_words(place), there.error().message));
  tell(shell,
       fmt::format("as last time ({}): {}; `bus`, `use` and `drive` change it{}", place.time, in_words(place),
                   opens_silently(shell, place.bus) ? "" : "; the first line that needs the bus opens it"));
}

void keep_last_place(const Settings& now, const std::filesystem::path& state_folder) {
  if (now.bus.empty() || now.bus.starts_with("replay:") || state_folder.empty()) return;
  // Another folder may have another cabinet file, with the same names for other drives; and all nodes are
  // none to begin with.
  const bool of_cabinet = now.bus.find(':') == std::string::npos && !can::is_interface(now.bus);
  if (of_cabinet || names_axes(now.nodes) || now.nodes == "all") return;
  std::error_code error;
  const bool file = std::filesystem::is_regular_file(now.drive, error);
  const auto drive = file ? std::filesystem::canonical(now.drive, error).string() : now.drive;
  // Where the prompt was is worth no word when it cannot be kept.
  (void)LastPlaceFile(state_folder).write({now.bus, now.nodes, drive, utc_now_text()});
}

}  // namespace servoctl::cli
