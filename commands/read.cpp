#include <span>
#include <string>
#include <vector>

#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "command/transfer_option.hpp"
#include "command/type_option.hpp"
#include "session/session.hpp"
#include "settings/file_transfer.hpp"
#include "show/alarm_question.hpp"
#include "show/reading.hpp"
#include "show/records.hpp"
#include "show/standard_names.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kReadParameters[] = {
    {.name = "object",
     .help = "0x6041, 6099h.1, statusword, Pn0202, 0x1018 (a record), '0x60*'",
     .kind = Kind::object,
     .required = true,
     .many = true},
    {.name = "--type",
     .help = "data type, if the dictionary does not have it",
     .kind = Kind::type,
     .choices = kTypeNames},
    {.name = "--to", .help = "write the bytes of one object to this file", .kind = Kind::file},
    kTransferOption,
};

Result<drive::Target> readable_target(const Context& context, std::uint8_t node, const std::string& word) {
  auto target = drive::resolve(context.profile, word, drive::Match::part);
  if (target && !od::readable(drive::meaning(*target, node).access))
    return fail(Errc::usage, message("'{}' is write-only", as_it_is(word)), "it can be written, not read");
  return target;
}

bool is_pattern(std::string_view word) { return word.find('*') != std::string_view::npos; }

/// The entries of the dictionary that can be read and fit.
template <class Fits>
std::vector<drive::Target> readable_entries(const Context& context, std::uint8_t node, const Fits& fits) {
  std::vector<drive::Target> out;
  for (const auto& object : context.profile->dictionary.objects())
    for (const auto& entry : object.entries) {
      if (!fits(object, entry)) continue;
      const auto target = drive::target_at(context.profile, entry.address);
      if (od::readable(drive::meaning(target, node).access)) out.push_back(target);
    }
  return out;
}

Result<std::vector<drive::Target>> fitting_targets(const Context& context, std::uint8_t node,
                                                   const std::string& pattern) {
  if (context.profile == nullptr)
    return fail(Errc::usage, message("a pattern needs the object dictionary: '{}'", as_it_is(pattern)),
                "add -d FAMILY");
  auto out = readable_entries(context, node, [&](const od::Object& object, const od::Entry& entry) {
    return show::fits(pattern, to_string(entry.address)) || show::fits(pattern, entry.name) ||
           show::fits(pattern, drive::entry_name(object, entry));
  });
  if (out.empty())
    return fail(Errc::usage, message("no object that can be read fits '{}'", as_it_is(pattern)),
                message("`objects '{}'` lists what fits", as_it_is(pattern)));
  return out;
}

/// The record or array that an index without sub-index stands for; null for everything else.
const od::Object* whole_record(const Context& context, std::string_view word) {
  const auto address = parse_object_address(word);
  const bool has_sub =
      word.find_first_of(".:") != std::string_view::npos || lower(word).find("sub") != std::string::npos;
  if (context.profile == nullptr || !address || has_sub) return nullptr;
  const auto* object = context.profile->dictionary.object(address->index);
  const bool several =
      object != nullptr && (object->code == od::ObjectCode::record || object->code == od::ObjectCode::array);
  return several ? object : nullptr;
}

/// What a word stands for: one object, the entries of a record, or what fits a pattern.
Result<std::vector<drive::Target>> targets_of(const Context& context, std::uint8_t node,
                                              const std::string& word) {
  if (is_pattern(word)) return fitting_targets(context, node, word);
  if (const auto* record = whole_record(context, word)) {
    auto out = readable_entries(
        context, node, [&](const od::Object& object, const od::Entry&) { return &object == record; });
    if (!out.empty()) return out;
  }
  auto target = readable_target(context, node, word);
  if (!target) return fail(target.error());
  return std::vector{std::move(*target)};
}

Result<void> check_read(Context& context, const Arguments& arguments) {
  if (const auto type = parse_type_option(arguments); !type) return fail(type.error());
  for (const auto node : context.nodes)
    for (const auto& word : arguments.all("object"))
      if (const auto targets = targets_of(context, node, word); !targets) return fail(targets.error());
  return {};
}

/// `--to` takes the bytes of one object of one node.
Result<report::Value> run_to_file(Context& context, const Arguments& arguments) {
  if (arguments.has("--type"))
    return fail(Errc::usage, "--type is for values that are shown; --to writes the raw bytes",
                "leave --type out");
  if (arguments.all("object").size() != 1 || context.nodes.size() != 1)
    return fail(Errc::usage, "--to takes one object of one node",
                "use a separate command and file for each object and node");
  const auto target = drive::resolve(context.profile, arguments.text("object"), drive::Match::part);
  if (!target) return fail(target.error());
  if (const auto agreed = show::confirm_unlisted(context, context.nodes.front(), std::span(&*target, 1));
      !agreed)
    return fail(agreed.error());
  return settings::read_to_file(context, context.nodes.front(), *target,
                                read_transfer(context, arguments, true), arguments.text("--to"));
}

Result<report::Value> run_read(Context& context, const Arguments& arguments) {
  if (arguments.has("--to")) return run_to_file(context, arguments);
  const auto type = parse_type_option(arguments);
  if (!type) return fail(type.error());
  std::vector<show::Reading> readings;
  std::vector<session::SdoRequest> requests;
  show::StandardNames names(context);
  for (const auto node : context.nodes) {
    for (const auto& word : arguments.all("object")) {
      const auto targets = targets_of(context, node, word);
      if (!targets) return fail(targets.error());
      if (const auto agreed = show::confirm_unlisted(context, node, *targets); !agreed)
        return fail(agreed.error());
      const bool many = is_pattern(word) || targets->size() > 1;
      for (const auto& found : *targets) {
        const auto target = names.named(node, found);
        readings.push_back({.node = node, .target = target, .type = *type, .one_of_many = many});
        const auto fixed_size = show::size_of(readings.back());
        const bool large = drive::meaning(target, node).type == od::DataType::domain;
        requests.push_back({node, target.address, {}, read_transfer(context, arguments, large), fixed_size});
      }
    }
  }
  if (const auto agreed = show::confirm_alarms(context, requests); !agreed) return fail(agreed.error());
  auto answers = context.session->transfer(requests);
  for (std::size_t i = 0; i < readings.size(); ++i) readings[i].bytes = std::move(answers[i]);
  return report::Value(show::reading_table(context, readings));
}

constexpr Example kReadExamples[] = {
    {"read 0x6041 0x6064 -n 1", "two objects by address"},
    {"read statusword Pn0202 -n 1 -d gsd600", "by name, and by the number on the panel"},
    {"read '0x60*' -n 1 -d sv2", "every object from 6000h to 60FFh that can be read"},
};

}  // namespace

extern const Command kRead;
const Command kRead{
    .path = "read",
    .summary = "Read objects of a node",
    .details =
        "Names and patterns need the family: --drive, or, with a notice, the one that the identity of the drive "
        "fits. An address needs none, and its value is then shown as an unsigned number of its length. Index and sub-index are hexadecimal. With a dictionary the index of a record or an array alone "
        "reads all of it, and a pattern ('0x60*', '*velocity*') every object that fits; what the drive refuses of "
        "them is shown with its abort, and what cannot be read is left out. With --to the bytes of one object of any size go to a "
        "file; block transfer is tried first where the drive may support it. If the family's data say that the drive raises an alarm "
        "when it is asked for an object that it does not have, such a read asks first.",
    .parameters = kReadParameters,
    .examples = kReadExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_read,
    .check = check_read,
    .brief = true,
    .one_file = "--to",
    .on_registers = true,
};

}  // namespace servoctl::commands
