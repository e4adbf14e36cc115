
#include "base/format.hpp"
#include "command/command.hpp"
#include "show/alarm_question.hpp"
#include "show/reading.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kParamGetParameters[] = {
    {.name = "id",
     .help = "panel numbers: Pn0202, Pn02*, or a name",
     .kind = Kind::parameter,
     .required = true,
     .many = true},
};

Result<std::vector<drive::Target>> wanted_parameters(const drive::Profile& profile,
                                                     std::span<const std::string> words) {
  std::vector<drive::Target> out;
  for (const auto& word : words) {
    if (word.find('*') == std::string::npos) {
      const auto target = drive::resolve_panel(profile, word, drive::Match::part);
      if (!target) return fail(target.error());
      if (!od::readable(drive::meaning(*target, 0).access))
        return fail(Errc::usage, message("{} is write-only", target->in_sentence()), "`param set` writes it");
      out.push_back(*target);
      continue;
    }
    const auto before = out.size();
    for (const auto& parameter : profile.parameters)
      if (show::fits(word, parameter.id) && parameter.object && od::readable(parameter.access))
        out.push_back(drive::target_at(&profile, *parameter.object));
    if (out.size() == before)
      return fail(Errc::usage, message("no readable parameter matches '{}'", as_it_is(word)),
                  "`param list` shows all");
  }
  return out;
}

Result<void> check_param_get(Context& context, const Arguments& arguments) {
  if (const auto targets = wanted_parameters(*context.profile, arguments.all("id")); !targets)
    return fail(targets.error());
  return {};
}

Result<report::Value> run_param_get(Context& context, const Arguments& arguments) {
  const auto targets = wanted_parameters(*context.profile, arguments.all("id"));
  if (!targets) return fail(targets.error());
  std::vector<show::Reading> readings;
  std::vector<session::SdoRequest> requests;
  for (const auto node : context.nodes) {
    if (const auto agreed = show::confirm_unlisted(context, node, *targets); !agreed)
      return fail(agreed.error());
    for (const auto& target : *targets) {
      readings.push_back({node, target, {}, Bytes{}});
      requests.push_back({.node = node, .object = target.address, .size = show::size_of(readings.back())});
    }
  }
  auto answers = context.session->transfer(requests);
  for (std::size_t i = 0; i < readings.size(); ++i) readings[i].bytes = std::move(answers[i]);
  return report::Value(show::reading_table(context, readings));
}

constexpr Example kParamGetExamples[] = {
    {"param get Pn0202 Pn0214 -n 1 -d gsd600", "two parameters by their numbers in the manual"},
    {"param get 'Pn02*' -n 1,2 -d gsd600", "all that begin so, of two drives"},
};

}  // namespace

extern const Command kParamGet;
const Command kParamGet{
    .path = "param get",
    .summary = "Read panel parameters of a drive",
    .details =
        "`Pn02*` reads all that match. The value is the number the panel shows; where one step is not one "
        "unit, the value in units follows it. In JSON `raw` is the panel's number and `value` is in `unit`.",
    .parameters = kParamGetParameters,
    .examples = kParamGetExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .run = run_param_get,
    .check = check_param_get,
    .brief = true,
    .on_registers = true,
};

}  // namespace servoctl::commands
