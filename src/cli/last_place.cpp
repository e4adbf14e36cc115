#include "cli/last_place.hpp"

#include <algorithm>

#include "base/calendar.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
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

constexpr std::uint64_t kPlaceVersion = 2;
/// The same for all folders, and so for none.
constexpr std::uint64_t kWithoutFolders = 1;
constexpr std::size_t kMostPlaces = 50;
constexpr std::uintmax_t kMostPlaceBytes = 1U << 18U;

/// The cabinet file in use; null where there is none that can be read.
const cabinet::Cabinet* cabinet_in_use(Shell& shell) {
  const auto cabinet = shell.cabinet(shell.defaults());
  return cabinet ? *cabinet : nullptr;
}

std::string folder_now() {
  std::error_code error;
  return std::filesystem::current_path(error).string();
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
    if (!name.empty()) append(out, formatted("{} {}", chinese ? report::chinese_word(word) : word, name));
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

/// A cabinet file in use is stronger than what was remembered; another one may have the same names for other
/// drives.
Result<void> check_cabinet(Shell& shell, const LastPlace& place) {
  const auto known = shell.cabinet(shell.defaults());
  if (!known) return fail(known.error());
  const auto* cabinet = *known;
  const bool none_meant = place.cabinet.empty() && !names_axes(place.nodes);
  if (cabinet == nullptr)
    return none_meant ? Result<void>() : fail(Errc::usage, "no cabinet file is in use here");
  if (none_meant) return fail(Errc::usage, message("{} is in use here", as_it_is(cabinet->file.string())));
  if (file_of(*cabinet) == place.cabinet) return {};
  return fail(Errc::usage, "the cabinet file is another one");
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
  // An option and the environment come before what is remembered.
  settings.bus_from = settings.nodes_from = settings.drive_from = Source::folder;
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

Result<std::vector<LastPlace>> LastPlaceFile::read_all() const {
  const RegularFilesOnly regular;
  std::error_code error;
  std::vector<LastPlace> out;
  if (!std::filesystem::exists(std::filesystem::symlink_status(path_, error))) return out;
  const auto text = read_file(path_, kMostPlaceBytes);
  if (!text) return fail(text.error());
  const auto document = report::parse_json(*text, path_.string());
  if (!document) return fail(document.error());
  show::FieldReader fields(*document, as_it_is(path_.string()));
  const auto version = fields.number("servoctl_prompt", true).value_or(kPlaceVersion);
  if (version == kWithoutFolders) return out;
  const auto* places = report::find(*document, "places");
  const auto* list = places == nullptr ? nullptr : std::get_if<report::List>(&places->data());
  if (version != kPlaceVersion) fields.refuse("servoctl_prompt");
  if (list == nullptr) fields.refuse("places");
  auto wrong = fields.error();
  for (std::size_t i = 0; list != nullptr && !wrong && i < std::min(list->size(), kMostPlaces); ++i) {
    show::FieldReader place((*list)[i], as_it_is(path_.string()));
    out.push_back({.folder = place.text("folder", true),
                   .bus = place.text("bus"),
                   .nodes = place.text("nodes"),
                   .drive = place.text("drive"),
                   .cabinet = place.text("cabinet"),
                   .time = place.text("time", true)});
    wrong = place.error();
  }
  if (wrong) return fail(Errc::file, *wrong, "delete the file; it only remembers where the prompt was");
  return out;
}

Result<std::optional<LastPlace>> LastPlaceFile::read(const std::string& folder) const {
  auto all = read_all();
  if (!all) return fail(all.error());
  for (auto& place : *all)
    if (place.folder == folder) return std::optional(std::move(place));
  return std::optional<LastPlace>();
}

/// The last one first; one that is damaged is replaced.
Result<void> LastPlaceFile::write(const LastPlace& place) const {
  const RegularFilesOnly regular;
  auto all = read_all().value_or(std::vector<LastPlace>());
  std::erase_if(all, [&](const LastPlace& one) { return one.folder == place.folder; });
  all.insert(all.begin(), place);
  if (all.size() > kMostPlaces) all.resize(kMostPlaces);
  report::List places;
  for (const auto& one : all)
    places.emplace_back(report::Record{{"folder", one.folder},
                                       {"bus", report::text_or_null(one.bus)},
                                       {"nodes", report::text_or_null(one.nodes)},
                                       {"drive", report::text_or_null(one.drive)},
                                       {"cabinet", report::text_or_null(one.cabinet)},
                                       {"time", one.time}});
  const report::Record document{{"servoctl_prompt", kPlaceVersion}, {"places", std::move(places)}};
  return write_own_file(path_, report::to_json(document) + "\n");
}

bool take_last_place(Shell& shell, const std::filesystem::path& state_folder) {
  const RegularFilesOnly regular;
  const auto& now = shell.defaults();
  const bool told = !now.bus.empty() || !now.nodes.empty() || !now.drive.empty();
  if (told || state_folder.empty()) return false;
  const auto last = LastPlaceFile(state_folder).read(folder_now());
  if (!last) {
    auto text = last.error().message.text();
    if (!last.error().hint.empty()) append(text, last.error().hint.text(), "; ");
    tell(shell, text);
    return true;
  }
  if (!*last || ((*last)->bus.empty() && (*last)->nodes.empty())) return false;
  const auto& place = **last;
  // Who names a cabinet file wants to be there.
  if (!now.cabinet.empty() && place.cabinet.empty()) return false;
  const auto words = in_words(place, shell.console().chinese());
  if (const auto there = go_to(shell, place); !there) {
    tell(shell, formatted("not as last time ({}): {}; `bus` and `use` say where to go", words,
                          there.error().message.text()));
    return true;
  }
  const bool waits = place.bus.empty() || !opens_silently(shell, place.bus);
  tell(shell, formatted("as last time ({}): {}; `bus`, `use` and `drive` change it{}", place.time, words,
                        waits ? "; the first line that needs the bus opens it" : ""));
  return true;
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
      .write(
          {folder_now(), now.bus, nodes, drive, cabinet == nullptr ? "" : file_of(*cabinet), utc_now_text()});
}

}  // namespace servoctl::cli
