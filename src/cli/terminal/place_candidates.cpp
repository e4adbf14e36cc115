// Where a line goes: buses, nodes, axes and families.
#include <algorithm>
#include <array>

#include "base/format.hpp"
#include "base/text.hpp"
#include "can/serial_port.hpp"
#include "can/socketcan.hpp"
#include "cli/terminal/candidates.hpp"
#include "session/open_port.hpp"
#include "session/open_register_line.hpp"
#include "sim/cell_spec.hpp"

namespace servoctl::cli {
namespace {

/// What a URL begins with, and how it goes on.
struct UrlForm {
  std::string_view begin;
  std::string_view hint;
};
constexpr std::array kUrlForms{
    UrlForm{"sim:", "simulated drives: sim:gsd600@1"},
    UrlForm{"local:", "a bus between programs of this machine: local:NAME"},
    UrlForm{"slcan:/dev/", "serial CAN adapter: slcan:/dev/ttyACM0@500k"},
    UrlForm{"socketcand://", "CAN of another machine: socketcand://HOST:29536/can0"},
    UrlForm{"gateway://", "gateway of CiA 309-3: gateway://HOST:60000"},
    UrlForm{"replay:", "a recording: replay:FILE"},
    UrlForm{"coe:local:", "EtherCAT between programs of this machine: coe:local:NAME"},
    UrlForm{"coe:sim:", "simulated EtherCAT drives: coe:sim:sv2@1"},
    UrlForm{"modbus://", "Modbus TCP: modbus://HOST:502"},
    UrlForm{"modbus:sim:", "simulated Modbus drives: modbus:sim:ts@1"}};

/// What all wires with simulated drives understand behind a `?`.
constexpr std::array kCellOptions{UrlForm{"state=", "file that keeps their memory"},
                                  UrlForm{"fault=", "a fault of all after a time: fault=0xFF00@2s"},
                                  UrlForm{"delay=", "time until an answer: delay=20ms"}};

std::string_view hint_of(std::string_view url) {
  for (const auto& form : kUrlForms)
    if (url == form.begin) return form.hint;
  return url.starts_with("coe:") ? "EtherCAT at this port" : "Modbus RTU at this port";
}

constexpr std::string_view kSheets[] = {".eds", ".dcf", ".xml"};

}  // namespace

void Candidates::add_families() {
  for (const auto& family : drive::find_families(shell_->drive_folders())) add(family.name, "drive family");
  add("online", "the dictionary that the drive itself tells");
  add_files(kSheets);
}

void Candidates::add_buses() {
  const auto cabinet = shell_->cabinet(place_.settings);
  if (cabinet && *cabinet != nullptr)
    for (const auto& bus : (*cabinet)->buses) add(bus.name, "bus of the cabinet: " + bus.url);
  if (const auto cells = cell_begin(begun_)) return add_cells(*cells);
  constexpr std::string_view kReplay = "replay:";
  if (begun_.starts_with(kReplay)) {
    auto files = behind(kReplay.size());
    files.add_files();
    return take_behind(kReplay.size(), std::move(files));
  }
  for (const auto& interface : can::can_interfaces()) add(interface, "CAN interface");
  for (const auto& port : can::serial_adapters()) add("slcan:" + port, "serial CAN adapter");
  for (const auto& url : session::ethercat_urls()) add(url, hint_of(url));
  for (const auto& url : session::modbus_urls()) add(url, hint_of(url));
  for (const auto& form : kUrlForms) add(form.begin, form.hint);
}

/// Simulated drives, whose text begins at `begin`: families up to an `@`, options behind a `?`.
void Candidates::add_cells(std::size_t begin) {
  const auto options = begun_.find('?', begin);
  if (options == std::string::npos) {
    const auto comma = begun_.find_last_of(',');
    const auto piece = comma == std::string::npos || comma < begin ? begin : comma + 1;
    if (begun_.find('@', piece) != std::string::npos) {
      note_ = "node-ID, then `,FAMILY@NODE` or `?state=FILE`";
      // A shell puts its own quotes around the sign; who types it has to know of them.
      if (begun_.back() >= '0' && begun_.back() <= '9')
        for (const auto& option : kCellOptions) add(formatted("{}?{}", begun_, option.begin), option.hint);
      return;
    }
    const auto before = begun_.substr(0, piece);
    for (const auto& family : drive::find_families(shell_->drive_folders()))
      add(before + family.name + "@", "drive family");
    return;
  }
  const auto piece = begun_.find_last_of("?&") + 1;
  constexpr std::string_view kState = "state=";
  if (std::string_view(begun_).substr(piece).starts_with(kState)) {
    auto files = behind(piece + kState.size());
    files.add_files();
    return take_behind(piece + kState.size(), std::move(files));
  }
  for (const auto& option : kCellOptions)
    add(begun_.substr(0, piece) + std::string(option.begin), option.hint);
}

std::string Candidates::heard_of(std::uint8_t node) {
  auto* session = shell_->session();
  std::string out;
  if (session == nullptr) return out;
  if (const auto state = session->watch().state(node)) out = session->network().state_word(*state);
  const auto* identity = session->identities().find(node, session->watch().boots(node));
  if (identity != nullptr && !identity->device_name.empty()) append(out, identity->device_name);
  if (session->watch().boots(node) > 0 && out.empty()) out = "booted";
  return out;
}

/// What is known of the nodes without asking: of the cabinet's bus, of simulated drives, of what was heard.
std::map<std::uint8_t, std::string> Candidates::known_nodes() {
  std::map<std::uint8_t, std::string> out;
  const auto used = parse_nodes(place_.settings.nodes);
  for (std::uint8_t node = 1; node <= 127; ++node) {
    const auto heard = heard_of(node);
    const bool is_used = used && std::find(used->begin(), used->end(), node) != used->end();
    if (!heard.empty() || is_used) out[node] = heard.empty() ? "in use" : heard;
  }
  if (!place_.in_shell) return out;
  const std::string_view bus = place_.settings.bus;
  if (const auto begin = cell_begin(bus))
    if (const auto cell = sim::parse_cell_spec(bus.substr(*begin), {}))
      for (const auto& place : cell->places) out[place.node] = "simulated " + place.family;
  if (const auto cabinet = shell_->cabinet(place_.settings); cabinet && *cabinet != nullptr)
    for (const auto& axis : (*cabinet)->axes)
      if (axis.bus == bus) out[axis.node] = formatted("{}, {}", axis.name, axis.family);
  return out;
}

/// Of a list the last part is completed: those before it, with their comma.
std::string Candidates::list_before() const {
  const auto comma = begun_.rfind(',');
  return comma == std::string::npos ? std::string() : begun_.substr(0, comma + 1);
}

void Candidates::add_nodes() {
  const auto group = begin_group(Candidate::Group::places);
  if (begun_.find(',') == std::string::npos) add("all", "every node that answers");
  add_axes();
  add_node_numbers();
  begin_group(group);
}

void Candidates::add_node_numbers() {
  const auto before = list_before();
  for (const auto& one : known_nodes()) add(before + std::to_string(one.first), one.second);
}

void Candidates::add_axes() {
  const auto cabinet = shell_->cabinet(place_.settings);
  if (!cabinet || *cabinet == nullptr) return;
  const auto before = list_before();
  const auto group = begin_group(Candidate::Group::places);
  for (const auto& axis : (*cabinet)->axes)
    add(before + axis.name, formatted("axis: {} node {}, {}", axis.bus, axis.node, axis.family));
  for (const auto& name : (*cabinet)->names()) add(before + name, "group of axes");
  begin_group(group);
}

}  // namespace servoctl::cli
