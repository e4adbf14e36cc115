#include <algorithm>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "cabinet/cabinet_text.hpp"
#include "cabinet/name_pattern.hpp"
#include "canopen/node_list.hpp"
#include "command/command.hpp"
#include "session/identify.hpp"
#include "session/scan.hpp"
#include "show/identity.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using cabinet::FoundAxis;
using report::Value;

namespace fs = std::filesystem;

constexpr Parameter kCabinetInitParameters[] = {
    {.name = "file",
     .help = "the file to make, or to add a bus to (default cabinet.toml)",
     .kind = Kind::file},
    {.name = "--family",
     .help = "families of nodes: 1=gsd600,2-4=da200; without it they are guessed",
     .kind = Kind::text},
    {.name = "--name", .help = "name of the bus in the file (default main)", .kind = Kind::text},
};

using Families = std::map<std::uint8_t, std::string>;

/// `1=gsd600,2-4=da200`; -d holds for the nodes that are not named.
Result<Families> families_of(const Arguments& arguments) {
  Families out;
  for (const auto part : split(arguments.text("--family"), ',')) {
    const auto equals = part.find('=');
    const auto nodes = canopen::parse_node_ids(trim(part.substr(0, equals)), "--family 1=gsd600,2-4=da200");
    if (!nodes) return fail(nodes.error());
    if (equals == std::string_view::npos || trim(part.substr(equals + 1)).empty())
      return fail(Errc::usage, message("--family: '{}' names no family", as_it_is(part)),
                  "--family 1=gsd600,2-4=da200");
    for (const auto node : *nodes) out[node] = std::string(trim(part.substr(equals + 1)));
  }
  return out;
}

class Init {
 public:
  Init(Context& context, fs::path file, std::string bus, Families families)
      : context_(&context), file_(std::move(file)), bus_(std::move(bus)), families_(std::move(families)) {}

  Result<Value> run() {
    for (const auto& [node, family] : families_)
      if (const auto known = context_->front_end->family(family); !known) return fail(known.error());
    const auto present = take_present();
    if (!present) return fail(present.error());
    auto found = look();
    if (!found) return fail(found.error());
    const auto text = *present + cabinet::cabinet_text(bus_, std::string(context_->front_end->bus_url()),
                                                       *found, present->empty(), context_->chinese);
    if (const auto good = cabinet::parse_cabinet(text, file_); !good && known(*found))
      return fail(good.error());
    if (const auto written = write(text); !written) return fail(written.error());
    return result(*found);
  }

 private:
  static bool known(const std::vector<FoundAxis>& axes) {
    return std::any_of(axes.begin(), axes.end(), [](const FoundAxis& axis) { return !axis.family.empty(); });
  }

  /// The file as it is, when it is there; it must not have this bus yet.
  Result<std::string> take_present() {
    std::error_code ignored;
    if (!fs::exists(file_, ignored)) return std::string();
    if (context_->read_only)
      return fail(Errc::refused,
                  message("{} exists, and --read-only replaces no file", as_it_is(file_.string())),
                  "name a file that does not exist yet");
    const auto present = cabinet::read_cabinet(file_);
    if (!present) return fail(present.error());
    for (const auto& bus : present->buses)
      if (bus.name == bus_ || bus.url == context_->front_end->bus_url())
        return fail(Errc::refused,
                    message("{} has bus {} ({}) already", as_it_is(file_.string()), as_it_is(bus.name),
                            as_it_is(bus.url)),
                    "name another file, or another bus with --bus and --name");
    names_ = present->names();
    auto text = read_file(file_);
    if (text && !text->empty() && text->back() != '\n') *text += '\n';
    return text;
  }

  Result<std::vector<FoundAxis>> look() {
    auto& session = *context_->session;
    auto nodes = context_->nodes;
    if (nodes.empty() || nodes.front() == 0) {
      auto there = session::nodes_present(session);
      if (!there) return fail(there.error());
      nodes = std::move(*there);
    }
    const auto all = drive::find_families(context_->drive_folders);
    auto identities = session::scan(session, nodes, nullptr, show::warn_of_details(*context_, all));
    if (!identities) return fail(identities.error());
    if (identities->empty())
      return fail(Errc::timeout, "no node answers", "`scan` looks again; is the bitrate right?");
    session::look_for_families(session, *identities, all);
    std::vector<FoundAxis> out;
    for (const auto& identity : *identities) out.push_back(axis_of(identity, all));
    for (auto& axis : out) read(axis);
    for (const auto& [node, family] : families_)
      if (std::none_of(out.begin(), out.end(), [n = node](const auto& axis) { return axis.node == n; }))
        context_->notices.push_back(
            message("--family {}={}: no drive answered there", node, as_it_is(family)));
    return out;
  }

  FoundAxis axis_of(const session::Identity& identity, std::span<const drive::Family> all) {
    FoundAxis out;
    out.node = identity.node;
    out.identity = identity;
    out.name = formatted("{}{}", context_->session->ethercat() != nullptr ? "slave" : "node", identity.node);
    if (std::find(names_.begin(), names_.end(), out.name) != names_.end()) out.name = bus_ + "_" + out.name;
    if (const auto said = families_.find(identity.node); said != families_.end()) {
      out.family = said->second;
    } else if (context_->profile != nullptr) {
      out.family = context_->profile->family;
    } else {
      const auto guesses = session::guess_families(identity, all);
      for (const auto& guess : guesses) {
        if (guess.generic && !out.family.empty()) continue;
        (out.family.empty() ? out.family : out.others.emplace_back()) = guess.family;
      }
      out.guessed = !out.family.empty();
    }
    return out;
  }

  /// What is not as from the factory; a drive that does not tell it stands in the file without.
  void read(FoundAxis& axis) {
    if (axis.family.empty()) return;
    const auto profile = context_->front_end->family(axis.family);
    if (!profile) return context_->errors.push_back(profile.error());
    const auto* before = std::exchange(context_->profile, *profile);
    auto settings = cabinet::find_settings(*context_, axis.node);
    context_->profile = before;
    if (!settings) return context_->errors.push_back(settings.error());
    axis.parameters = std::move(settings->parameters);
    axis.heartbeat_ms = settings->heartbeat_ms;
    axis.increments = settings->increments;
    if (settings->unstated > 0)
      context_->notices.push_back(message(
          "node {}: {} settings are not compared with the factory's, which the data of {} do not state: "
          "`backup` saves them all",
          node_name(axis.node), settings->unstated, as_it_is(axis.family)));
    if (settings->pdos.empty()) return;
    axis.pdo_file = axis.name + ".pdos.toml";
    pdos_.emplace_back(file_.parent_path() / axis.pdo_file, std::move(settings->pdos));
  }

  /// The cabinet file last: it names the others.
  Result<void> write(const std::string& text) {
    if (context_->dry_run) return {};
    std::error_code ignored;
    for (const auto& [path, content] : pdos_) {
      if (fs::exists(path, ignored))
        return fail(Errc::refused, message("{} is there already", as_it_is(path.string())),
                    "move it away; nothing was written");
    }
    for (const auto& [path, content] : pdos_)
      if (const auto written = write_file_atomically(path, content); !written) return written;
    return write_file_atomically(file_, text);
  }

  Value result(const std::vector<FoundAxis>& axes) {
    report::Table table;
    table.columns = {{"axis"}, {"node"}, {"family"}, {"guessed"}, {"parameters"}, {"pdos", "PDOs"}};
    for (const auto& axis : axes) {
      table.rows.push_back({axis.name, axis.node, report::text_or_null(axis.family), axis.guessed,
                            axis.parameters.size(), report::text_or_null(axis.pdo_file)});
      if (axis.guessed)
        context_->notices.push_back(
            message("node {}: its identity fits {} (a guess, not proof); hold it against the nameplate",
                    node_name(axis.node), as_it_is(axis.family)));
      if (axis.family.empty())
        context_->notices.push_back(
            message("node {}: no family fits; it stands in comments", node_name(axis.node)));
    }
    report::Record out{{"file", file_.string()}, {"bus", bus_}, {"axes", std::move(table)}};
    if (!context_->dry_run)
      context_->tell(
          formatted("{} is written: give the axes their names, then `cabinet check`\n", file_.string()));
    return out;
  }

  Context* context_;
  fs::path file_;
  std::string bus_;
  Families families_;
  std::vector<std::string> names_;
  std::vector<std::pair<fs::path, std::string>> pdos_;
};

Result<Value> run_cabinet_init(Context& context, const Arguments& arguments) {
  auto families = families_of(arguments);
  if (!families) return fail(families.error());
  const auto name = arguments.has("--name") ? std::string(arguments.text("--name")) : std::string("main");
  if (!cabinet::is_name(name))
    return fail(Errc::usage, message("'{}' cannot be the name of a bus", as_it_is(name)),
                "a letter first, then letters, digits, `_` and `-`; `all` is no name");
  const auto file = arguments.has("file") ? fs::path(arguments.text("file")) : fs::path("cabinet.toml");
  return Init(context, file, name, std::move(*families)).run();
}

constexpr Example kCabinetInitExamples[] = {
    {"cabinet init -b can0", "cabinet.toml from the drives on this bus; they are only read"},
    {"cabinet init -b can0 --family 1=gsd600,2=da200", "with the families as the nameplates say"},
    {"cabinet init --name ring -b coe:eth0", "add a second bus to it"},
};

}  // namespace

extern const Command kCabinetInit;
const Command kCabinetInit{
    .path = "cabinet init",
    .summary = "Make a cabinet file from what is on the bus",
    .details =
        "Looks who is on the bus and writes cabinet.toml: an axis for each drive, with its family as --family "
        "or --drive says, else as its identity suggests (marked as guessed), its serial number where it has "
        "one, and what is not as from the factory: parameters, heartbeat, and the PDOs in a file beside it. "
        "Comments say what to fill in. Drives are only read; a slave in INIT is taken to PRE-OP for it. A file that is there is added to where it does "
        "not have this bus yet: `cabinet init --bus coe:eth0 --name ring`.",
    .parameters = kCabinetInitParameters,
    .examples = kCabinetInitExamples,
    .needs = Needs::bus,
    .effect = Effect::reads,
    .family = FamilyCheck::never,
    .run = run_cabinet_init,
};

}  // namespace servoctl::commands
