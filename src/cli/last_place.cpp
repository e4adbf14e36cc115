#include "cli/last_place.hpp"

#include <fmt/format.h>

#include "base/calendar.hpp"
#include "base/file.hpp"
#include "base/found_file.hpp"
#include "base/printable.hpp"
#include "base/regular_files.hpp"
#include "base/text.hpp"
#include "can/socketcan.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "report/catalogue.hpp"
#include "report/value.hpp"
#include "show/field_reader.hpp"

namespace servoctl::cli {
namespace {

constexpr std::uint64_t kPlaceVersion = 1;
constexpr std::uintmax_t kMostPlaceBytes = 1U << 16U;

/// The cabinet file in use; null where there is none that can be read.
const cabinet::Cabinet* cabinet_in_use(Shell& shell) {
  const auto cabinet = shell.cabinet(shell.defaults());
  return cabinet ? *cabinet : nullptr;
}

std::string file_of(const cabinet::Cabinet& cabinet) {
  std::error_code error;
  return std::filesystem::canonical(cabinet.file, error).string();
}

bool is_url(const std::string& bus) { return bus.find(':') != std::string::npos || can::is_interface(bus); }

/// Behind a serial port or an Ethernet port may be another device today, and to open it sends something. What
/// is no URL is a bus of the cabinet, or an interface that is gone, as is told.
bool opens_silently(Shell& shell, std::string bus) {
  if (!is_url(bus))
    if (const auto* cabinet = cabinet_in_use(shell); cabinet != nullptr && cabinet->bus(bus) != nullptr)
      bus = cabinet->bus(bus)->url;
  return bus.find(':') == std::string::npos || bus.starts_with("socketcan:") || bus.starts_with("local:") ||
         bus.starts_with("sim:");
}

std::string in_words(const LastPlace& place, bool chinese) {
  std::string out;
  const auto add = [&](std::string_view word, const std::string& name) {
    if (!name.empty()) append(out, fmt::format("{} {}", chinese ? report::chinese_word(word) : word, name));
  };
  // Where an axis is, and what it is, the cabinet file says.
  if (names_axes(place.nodes)) {
    append(out, place.nodes);
  } else {
    add("bus", place.bus);
    add("node", place.nodes);
    add("family", place.drive);
  }
  add("cabinet", place.cabinet);
  return printable(out);
}

void tell(Shell& shell, const std::string& text) { shell.console().note("notice: " + text + "\n"); }

/// Another folder may have another cabinet file, with the same names for other drives.
Result<void> check_cabinet(Shell& shell, const LastPlace& place) {
  if (place.cabinet.empty() && !names_axes(place.nodes)) return {};
  const auto* cabinet = cabinet_in_use(shell);
  if (cabinet != nullptr && file_of(*cabinet) == place.cabinet) return {};
  return fail(Errc::usage,
              cabinet == nullptr ? "no cabinet file is in use here" : "the cabinet file is another one");
}

/// Why the prompt cannot be there.
Result<void> go_to(Shell& shell, const LastPlace& place) {
  if (const auto same = check_cabinet(shell, place); !same) return same;
  auto settings = shell.defaults();
  settings.bus = place.bus;
  for (const auto& [word, value] : {std::pair("use", place.nodes), std::pair("drive", place.drive)}) {
    if (value.empty()) continue;
    auto now = chosen(shell, settings, {word, value});
    if (!now) return fail(now.error());
    settings = std::move(*now);
  }
  // What was an interface is none of a cabinet's buses, though one may have its name.
  const bool was_interface = place.cabinet.empty() && !is_url(place.bus);
  if (!place.bus.empty() && (was_interface || opens_silently(shell, place.bus))) {
    const auto opened = was_interface ? shell.open(settings) : open_chosen_bus(shell, settings);
    if (!opened) return fail(opened.error());
  }
  shell.defaults() = std::move(settings);
  return {};
}

}  // namespace

Result<std::optional<LastPlace>> LastPlaceFile::read() const {
  const RegularFilesOnly regular;
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
  LastPlace out{.bus = fields.text("bus"),
                .nodes = fields.text("nodes"),
                .drive = fields.text("drive"),
                .cabinet = fields.text("cabinet"),
                .time = fields.text("time", true)};
  if (fields.error())
    return fail(Errc::file, *fields.error(), "delete the file; it only remembers where the prompt was");
  return std::optional(std::move(out));
}

Result<void> LastPlaceFile::write(const LastPlace& place) const {
  const RegularFilesOnly regular;
  const report::Record document{{"servoctl_prompt", kPlaceVersion},
                                {"bus", report::text_or_null(place.bus)},
                                {"nodes", report::text_or_null(place.nodes)},
                                {"drive", report::text_or_null(place.drive)},
                                {"cabinet", report::text_or_null(place.cabinet)},
                                {"time", place.time}};
  return write_own_file(path_, report::to_json(document) + "\n");
}

void take_last_place(Shell& shell, const std::filesystem::path& state_folder) {
  const RegularFilesOnly regular;
  const auto& now = shell.defaults();
  const bool told = !now.bus.empty() || !now.nodes.empty() || !now.drive.empty();
  if (told || state_folder.empty()) return;
  const auto last = LastPlaceFile(state_folder).read();
  if (!last) {
    auto text = last.error().message;
    if (!last.error().hint.empty()) append(text, last.error().hint, "; ");
    return tell(shell, text);
  }
  if (!*last || ((*last)->bus.empty() && (*last)->nodes.empty())) return;
  const auto& place = **last;
  // Who names a cabinet file wants to be there.
  if (!now.cabinet.empty() && place.cabinet.empty()) return;
  const auto words = in_words(place, shell.console().chinese());
  if (const auto there = go_to(shell, place); !there)
    return tell(shell, fmt::format("not as last time ({}): {}; `bus` and `use` say where to go", words,
                                   there.error().message));
  const bool waits = place.bus.empty() || !opens_silently(shell, place.bus);
  tell(shell, fmt::format("as last time ({}): {}; `bus`, `use` and `drive` change it{}", place.time, words,
                          waits ? "; the first line that needs the bus opens it" : ""));
}

void keep_last_place(Shell& shell, const std::filesystem::path& state_folder) {
  const auto& now = shell.defaults();
  if (state_folder.empty() || now.bus.starts_with("replay:") || (now.bus.empty() && now.nodes.empty()))
    return;
  const bool names_bus = !now.bus.empty() && !is_url(now.bus);
  const bool of_cabinet = names_bus || now.bus.empty() || names_axes(now.nodes);
  const auto* cabinet = of_cabinet ? cabinet_in_use(shell) : nullptr;
  if (of_cabinet && cabinet == nullptr) return;
  // All nodes of a bus are none to begin with.
  const auto nodes = equals_nocase(now.nodes, "all") ? std::string() : now.nodes;
  std::error_code error;
  const bool is_file = std::filesystem::is_regular_file(now.drive, error);
  const auto drive = is_file ? std::filesystem::canonical(now.drive, error).string() : now.drive;
  // Where the prompt was is worth no word when it cannot be kept.
  (void)LastPlaceFile(state_folder)
      .write({now.bus, nodes, drive, cabinet == nullptr ? "" : file_of(*cabinet), utc_now_text()});
}

}  // namespace servoctl::cli
