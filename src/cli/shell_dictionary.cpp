// Where the dictionary of a line comes from: a family, a file, or the drive itself.
#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "canopen/node_list.hpp"
#include "cli/shell.hpp"
#include "drive/shared_profile.hpp"
#include "od/data_sheet.hpp"
#include "session/online_dictionary.hpp"
#include "session/open_port.hpp"

namespace servoctl::cli {
namespace {

using command::Needs;

/// The drive itself, in place of a family.
constexpr std::string_view kOnline = "online";

/// The one node that a line names; 0 when it names none, several or all.
std::uint8_t one_node(const Settings& settings) {
  const auto nodes =
      settings.nodes.empty() ? Result<std::vector<std::uint8_t>>() : parse_nodes(settings.nodes);
  return nodes && nodes->size() == 1 ? nodes->front() : std::uint8_t{0};
}

/// A list of objects where nothing is named but the drive: it may know them.
bool asks_a_drive(const Settings& settings, const command::Command& command) {
  return settings.drive.empty() && !includes(command.needs, Needs::bus) &&
         session::is_ethercat(settings.bus) && one_node(settings) != 0;
}

/// Whether `-d` names nodes and their families, `3=gsd600,4=da200`, and no family or file.
bool names_nodes(std::string_view drive) {
  const auto sign = drive.find('=');
  return sign != std::string_view::npos && canopen::parse_node_ids(drive.substr(0, sign), "").has_value();
}

}  // namespace

/// The families of single nodes.
Result<void> Shell::prepare_families(Run& run) {
  for (const auto part : split(std::string_view(run.settings.drive), ',')) {
    const auto sign = std::min(part.find('='), part.size());
    const auto nodes = canopen::parse_node_ids(trim(part.substr(0, sign)), "write -d 3=gsd600,4-6=da200");
    if (!nodes) return fail(nodes.error());
    const auto loaded = profile(std::string(trim(part.substr(std::min(sign + 1, part.size())))));
    if (!loaded) return fail(loaded.error());
    for (const auto node : *nodes)
      if (const auto [known, is_new] = run.context.families.try_emplace(node, *loaded);
          !is_new && known->second != *loaded)
        return fail(Errc::usage, message("-d names two families for node {}", node_name(node)),
                    "say each node once");
  }
  return {};
}

/// Where nothing says which family it is, some commands are about the objects of the standards.
Result<void> Shell::take_standard(Run& run, const Error& without) {
  if (!run.command->standard_without || without.code != Errc::usage) return fail(without);
  run.settings.drive = drive::kGenericFamily;
  run.family_found = run.family_guessed = true;
  run.context.notices.emplace_back(
      "no -d: these are the objects of the standards (CiA 301, CiA 402), of which a drive has some");
  return {};
}

Result<void> Shell::prepare_profile(Run& run, bool changes) {
  if (names_nodes(run.settings.drive)) {
    if (run.command->family_by_node) return prepare_families(run);
    return fail(Errc::usage, message("{} takes one family for all nodes", as_it_is(run.command->path)),
                "the cabinet file names the family of each axis; `decode` takes -d 3=gsd600,4=da200");
  }
  if (equals_nocase(run.settings.drive, kOnline) || asks_a_drive(run.settings, *run.command)) {
    const auto asked = ask_drive(run);
    if (asked && console_->is_verbose()) tell_family(run);
    return asked;
  }
  if (run.settings.drive.empty())
    if (const auto found = find_family(run, changes); !found)
      if (const auto standard = take_standard(run, found.error()); !standard) return standard;
  auto loaded = profile(run.settings.drive);
  if (!loaded) loaded = device_of_node(run, loaded.error());
  if (!loaded) return fail(loaded.error());
  run.context.profile = *loaded;
  if (console_->is_verbose()) tell_family(run);
  for (const auto& warning : (*loaded)->warnings)
    if (shown_warnings_.insert(warning).second || run.settings.json) run.context.notices.push_back(warning);
  return {};
}

/// The dictionary that the drive itself describes; asked for once, and again after a restart of the drive.
Result<void> Shell::ask_drive(Run& run) {
  const auto node = one_node(run.settings);
  if (node == 0)
    return fail(Errc::usage, "the dictionary of which drive?",
                "name one with --node; each describes its own objects");
  const auto opened = open(run.settings);
  if (!opened) return fail(opened.error());
  run.context.session = *opened;
  const auto key = formatted("{} {} {} {}", kOnline, (*opened)->url(), node, (*opened)->watch().boots(node));
  if (const auto known = profiles_.find(key); known != profiles_.end()) {
    run.context.profile = known->second.get();
    return {};
  }
  auto asked = session::read_online_dictionary(**opened, node);
  if (!asked) return fail(asked.error());
  auto& place = profiles_[key];
  place = std::make_shared<const drive::Profile>(drive::profile_of_sheet(
      std::move(asked->sheet), formatted("{}, node {}", kOnline, node), options_.drive_folders));
  run.context.profile = place.get();
  if (!asked->left_out.empty())
    run.context.notices.push_back(
        message("node {} lists {} objects or entries that it does not describe; the first: {}",
                node_name(node), asked->left_out.size(), asked->left_out.front()));
  return {};
}

/// Of a file that describes several devices the one that the node is; else what was wrong.
Result<const drive::Profile*> Shell::device_of_node(Run& run, const Error& why) {
  const auto sheet = od::sheet_name(run.settings.drive);
  const auto node = one_node(run.settings);
  const bool of_several =
      why.code == Errc::usage && lower(sheet.path).ends_with(".xml") && sheet.device.empty();
  if (!of_several || node == 0 || !includes(run.command->needs, Needs::bus)) return fail(why);
  const auto opened = open(run.settings);
  if (!opened) return fail(opened.error());
  const auto number = [&](std::uint8_t sub) -> std::optional<std::uint64_t> {
    const auto bytes = (*opened)->upload(node, {0x1018, sub});
    return bytes ? std::optional(load_le(*bytes)) : std::nullopt;
  };
  const auto product = number(2);
  if (!product) return fail(why);
  const auto revision = number(3);
  for (const auto& device :
       {formatted("0x{:08X}:0x{:08X}", *product, revision.value_or(0)), formatted("0x{:08X}", *product)}) {
    auto found = profile(formatted("{}#{}", sheet.path, device));
    if (!found) continue;
    run.context.notices.push_back(
        message("node {} is {}#{} by its identity", node_name(node), as_it_is(sheet.path), as_it_is(device)));
    return found;
  }
  return fail(why);
}

Result<const drive::Profile*> Shell::profile(const std::string& family) {
  const auto known = profiles_.find(family);
  if (known != profiles_.end()) return known->second.get();
  if (equals_nocase(family, kOnline))
    return fail(Errc::usage, "the dictionary of a drive is not known before it was asked",
                "name the drive in the line itself: -d online --bus coe:… --node 1");
  auto loaded = drive::shared_profile(family, options_.drive_folders);
  if (!loaded) return fail(loaded.error());
  return profiles_.emplace(family, std::move(*loaded)).first->second.get();
}

}  // namespace servoctl::cli
