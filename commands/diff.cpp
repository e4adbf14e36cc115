#include <algorithm>
#include <set>

#include "base/format.hpp"
#include "base/number.hpp"
#include "canopen/cob_id.hpp"
#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "session/no_register.hpp"
#include "settings/comparison.hpp"
#include "settings/dictionary_comparison.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr std::string_view kFactory = "factory";
constexpr std::string_view kNode = "node:";

constexpr Parameter kDiffParameters[] = {
    {.name = "a", .help = "a backup, data sheet, node:N or factory", .kind = Kind::file, .required = true},
    {.name = "b", .help = "a backup, data sheet, node:N or factory", .kind = Kind::file, .required = true},
    {.name = "--batch", .help = "the command lines that turn A into B", .kind = Kind::flag},
    kSkipInvalidOption,
};

/// One word of `diff`: a file, a drive on the bus, or the factory values.
struct Operand {
  std::string word;
  std::optional<settings::BackupSource> source;
  std::uint8_t node = 0;  ///< Of a drive.

  bool is_factory() const { return !source && node == 0; }
};

Result<Operand> parse_operand(std::string_view word, settings::LineReader* lines) {
  Operand out{std::string(word), {}, 0};
  if (word == kFactory) return out;
  if (word.starts_with(kNode)) {
    const auto number = parse_digits(word.substr(kNode.size()), 10);
    if (!number || *number < canopen::kFirstNode || *number > canopen::kLastNode)
      return fail(Errc::usage, message("'{}' is not a node", as_it_is(word)), "write node:1 to node:127");
    out.node = static_cast<std::uint8_t>(*number);
    return out;
  }
  auto source = settings::open_backup(word, lines);
  if (!source) {
    if (parse_digits(word, 10))
      source.error().hint = message("write a drive as {}{}", as_it_is(kNode), as_it_is(word));
    return fail(source.error());
  }
  out.source = std::move(*source);
  return out;
}

/// One comparison of two operands.
class Difference {
 public:
  Difference(Context& context, std::vector<Operand> operands, bool skip_invalid)
      : context_(&context), operands_(std::move(operands)), skip_invalid_(skip_invalid) {}

  Result<Value> run(bool batch) {
    if (const auto found = find_family(); !found) return fail(found.error());
    // The files first: what is wrong in them is told before a bus is opened.
    for (const bool files : {true, false})
      for (std::size_t i = 0; i < operands_.size(); ++i) {
        if (operands_[i].source.has_value() != files) continue;
        auto side = side_of_operand(i);
        if (!side) return fail(side.error());
        sides_[i] = std::move(*side);
      }
    for (const std::size_t i : {0U, 1U}) leave_unreached(i);
    const bool whole = std::none_of(operands_.begin(), operands_.end(),
                                    [](const Operand& operand) { return operand.is_factory(); });
    auto comparison = settings::compare(profile_, sides_[0], sides_[1], whole, context_->chinese);
    if (comparison.different > 0)
      context_->errors.push_back(settings::differences_error(comparison, sides_[0], sides_[1]));
    if (!batch) return Value(std::move(comparison.record));
    if (const auto added = add_cob_ids(); !added) return fail(added.error());
    report::List lines;
    for (auto& line : settings::lines_between(profile_, sides_[0], sides_[1], whole))
      lines.emplace_back(std::move(line));
    return Value(std::move(lines));
  }

 private:
  bool are_files() const { return operands_[0].source && operands_[1].source; }

  const drive::Profile* family(const std::string& name) const {
    if (name.empty() || context_->front_end == nullptr) return nullptr;
    const auto found = context_->front_end->family(name);
    return found ? *found : nullptr;
  }

  /// The family named on the line, else that of a file, where its data is at hand; else DCFs describe their
  /// own drives, each its own.
  Result<void> find_family() {
    profile_ = context_->profile;
    for (const auto& operand : operands_)
      if (profile_ == nullptr && operand.source) profile_ = family(settings::family_of(*operand.source));
    const bool dcfs = are_files() && operands_[0].source->format == settings::BackupFormat::dcf &&
                      operands_[1].source->format == settings::BackupFormat::dcf;
    if (profile_ == nullptr && dcfs)
      for (std::size_t i = 0; i < operands_.size(); ++i) {
        sides_own_[i] = family(operands_[i].source->file);
        if (profile_ == nullptr) profile_ = sides_own_[i];
      }
    const auto needy = std::find_if(operands_.begin(), operands_.end(),
                                    [](const Operand& operand) { return !operand.source; });
    if (profile_ != nullptr || needy == operands_.end()) return {};
    return fail(Errc::usage, message("{}: which family?", as_it_is(needy->word)),
                "add -d FAMILY; `drives` lists families");
  }

  Result<settings::Side> side_of_operand(std::size_t i) {
    const auto& operand = operands_[i];
    if (operand.source) return side_of_file(i);
    if (operand.node != 0) return side_of_node(i);
    return settings::factory_side(*profile_, other_node(i));
  }

  /// What the other side could not know, because it was read over Modbus, is no difference.
  void leave_unreached(std::size_t i) {
    if (!are_files()) return settings::leave_unreachable(*context_, profile_, sides_[i]);
    const auto left = std::erase_if(
        sides_[i].values, [&](const auto& value) { return unreached_[1 - i].count(value.first) != 0; });
    if (left > 0)
      context_->notices.push_back(message("{} values of {} are not compared: {} was read over Modbus", left,
                                          settings::title_in_message(operands_[i].word),
                                          settings::title_in_message(operands_[1 - i].word)));
  }

  /// The node that a side without one of its own stands for.
  std::uint8_t other_node(std::size_t i) const {
    return operands_[1 - i].node != 0 ? operands_[1 - i].node : sides_[1 - i].node;
  }

  Result<settings::Side> side_of_file(std::size_t i) {
    const auto* own = sides_own_[i];
    const auto backup = settings::read_backup(*context_, *operands_[i].source,
                                              own != nullptr ? own : profile_, other_node(i), skip_invalid_);
    if (!backup) return fail(backup.error());
    for (const auto& entry : backup->entries)
      if (entry.left_out == session::kNoRegister) unreached_[i].insert(entry.object);
    if (own != nullptr) {
      auto out = settings::side_of(*backup, operands_[i].word);
      out.profile = own;
      return out;
    }
    if (!family_.empty() && family_ != backup->family)
      return fail(Errc::negative,
                  message("{} is for {}, {} for {}: they cannot be compared",
                          settings::title_in_message(operands_[1 - i].word), as_it_is(family_),
                          as_it_is(operands_[i].word), as_it_is(backup->family)));
    family_ = backup->family;
    return settings::side_of(*backup, operands_[i].word);
  }

  /// What a file holds is read from the drive; all settings are where there is no file.
  Result<settings::Side> side_of_node(std::size_t i) {
    const auto& operand = operands_[i];
    if (!family_.empty() && family_ != profile_->family)
      return fail(Errc::refused,
                  message("{} is for {}, not for {}", settings::title_in_message(operands_[1 - i].word),
                          as_it_is(family_), as_it_is(profile_->family)),
                  "give the backup's family with -d if the drive really is one");
    if (context_->front_end == nullptr)
      return fail(Errc::usage, message("{}: there is no bus to open here", as_it_is(operand.word)));
    const auto session = context_->front_end->open_bus();
    if (!session) return fail(session.error());
    if (const auto right = context_->hold_family(std::span(&operand.node, 1), profile_, false); !right)
      return fail(right.error());
    std::vector<ObjectAddress> objects;
    if (operands_[1 - i].source)
      for (const auto& value : sides_[1 - i].values) objects.push_back(value.first);
    else
      for (const auto& setting : drive::settings_of(*profile_))
        if (setting.left_out.empty()) objects.push_back(setting.entry->address);
    const auto read = session::read_objects(**session, operand.node, objects);
    if (!read) return fail(read.error());
    settings::Side out{operand.word, operand.node, {}};
    for (const auto& entry : *read)
      if (entry.bytes) out.values.emplace(entry.object, *entry.bytes);
    return out;
  }

  /// The lines make PDOs invalid for a while, and valid again: what their COB-IDs are, a file may not say.
  Result<void> add_cob_ids() {
    const auto lacking = operands_[0].node != 0 ? settings::cob_ids_lacking(*profile_, sides_[0])
                                                : std::vector<ObjectAddress>();
    if (lacking.empty()) return {};
    const auto session = context_->front_end->open_bus();
    if (!session) return fail(session.error());
    const auto read = session::read_objects(**session, operands_[0].node, lacking);
    if (!read) return fail(read.error());
    for (const auto& entry : *read)
      if (entry.bytes) sides_[0].values.emplace(entry.object, *entry.bytes);
    return {};
  }

  Context* context_;
  std::vector<Operand> operands_;
  bool skip_invalid_ = false;
  const drive::Profile* profile_ = nullptr;
  const drive::Profile* sides_own_[2] = {};  ///< Of DCFs that no family describes.
  std::string family_;                       ///< Of the files read so far.
  settings::Side sides_[2];
  std::set<ObjectAddress> unreached_[2];  ///< What the file could not hold: it was read over Modbus.
};

Result<Value> run_diff(Context& context, const Arguments& arguments) {
  std::vector<Operand> operands;
  for (const auto word : {arguments.text("a"), arguments.text("b")}) {
    auto operand = parse_operand(word, context.front_end);
    if (!operand) return fail(operand.error());
    operands.push_back(std::move(*operand));
  }
  const bool batch = arguments.has("--batch");
  if (operands[0].source && operands[1].source && are_data_sheets(*operands[0].source, *operands[1].source))
    return batch ? fail(Errc::usage, "two data sheets (EDS) contain no settings to write",
                        "leave --batch out to compare their dictionaries")
                 : settings::compare_data_sheets(context, *operands[0].source, *operands[1].source);
  return Difference(context, std::move(operands), arguments.has("--skip-invalid")).run(batch);
}

constexpr Example kDiffExamples[] = {
    {"diff factory node:1 -d gsd600", "everything that somebody has set on a drive"},
    {"diff good.json node:1 -d gsd600", "what has changed since the backup"},
    {"diff node:1 node:2 --batch -d gsd600", "the command lines that make node 1 like node 2"},
};

}  // namespace

extern const Command kDiff;
const Command kDiff{
    .path = "diff",
    .summary = "Compare backups, drives, factory values and data sheets",
    .details =
        "Two of: a file (any format `restore` takes), node:N for a drive on the bus, `factory` for the "
        "defaults of the family's data. Shows every value that differs, with unit and label; exit code 1 if "
        "any does. COB-IDs and the node-ID are compared relative to each node. Values whose default the "
        "manual does not state are not compared with `factory`. --batch prints the command lines that turn A "
        "into B instead: `diff factory node:1 --batch` lists everything set on a drive. Two data sheets "
        "(EDS; or an EDS and a DCF) are compared entry by entry: name, type, access, mapping, default and "
        "limits. A file in another format is refused if it has an unusable entry; --skip-invalid compares "
        "the rest.",
    .parameters = kDiffParameters,
    .examples = kDiffExamples,
    .needs = Needs::nothing,
    .effect = Effect::reads,
    .run = run_diff,
    .on_registers = true,
};

}  // namespace servoctl::commands
