#include "pdo/pdo_recipes.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/toml_text.hpp"
#include "session/pdo_setup.hpp"
#include "settings/backup_formats.hpp"
#include "show/pdo_report.hpp"

namespace servoctl::pdo {
namespace {

using canopen::Pdo;
using drive::PdoRecipe;

/// The error of one recipe, with its PDO in front.
tl::unexpected<Error> of(const PdoRecipe& recipe, Error error) {
  if (!error.message.names(recipe.pdo))
    error.message = message("{}: {}", Verbatim{recipe.pdo}, error.message);
  if (recipe.line != 0) error.line = recipe.line;
  return fail(std::move(error));
}

Result<void> set_times(const PdoRecipe& recipe, Pdo& pdo) {
  if (recipe.inhibit_us) {
    if (*recipe.inhibit_us % 100 != 0 || *recipe.inhibit_us / 100 > 0xFFFF)
      return fail(Errc::usage, message("inhibit time {} us is not possible", *recipe.inhibit_us),
                  "in steps of 100 us, at most 6553500");
    pdo.inhibit = static_cast<std::uint16_t>(*recipe.inhibit_us / 100);
  }
  if (recipe.event_ms) pdo.event = recipe.event_ms;
  if (recipe.sync_start) pdo.sync_start = recipe.sync_start;
  return {};
}

Result<void> set_mapping(const drive::Profile& profile, const PdoRecipe& recipe, Pdo& pdo) {
  if (!recipe.map) return {};
  pdo.entries.clear();
  for (const auto& word : *recipe.map) {
    const auto entry = parse_mapped(profile, word);
    if (!entry) return fail(entry.error());
    pdo.entries.push_back(*entry);
  }
  return {};
}

Result<void> set_cob_id(const PdoRecipe& recipe, const PresentPdos& present, Pdo& pdo) {
  if (!recipe.cob_id.empty()) {
    const auto can_id = recipe.valid.value_or(false) ? parse_pdo_can_id(recipe.cob_id, present.node)
                                                     : parse_can_id(recipe.cob_id, present.node);
    if (!can_id) return fail(can_id.error());
    pdo.set_can_id(*can_id);
  }
  if (!recipe.valid) return {};
  if (*recipe.valid) return switch_on(pdo, present.node);
  pdo.cob_id |= canopen::kPdoInvalid;
  return {};
}

/// What the recipes say of valid PDOs is the whole assignment.
Result<void> assign_all(const drive::Profile& profile, const PresentPdos& present,
                        const std::vector<PdoRecipe>& recipes, WantedPdos& out) {
  const bool says = std::any_of(recipes.begin(), recipes.end(), [](const PdoRecipe& r) { return r.valid; });
  for (const auto direction : {canopen::PdoDirection::receive, canopen::PdoDirection::transmit})
    if (const auto list = session::assignment_of(&profile, direction); list && says)
      out.assignments.emplace(*list, Bytes{0});
  for (std::size_t i = 0; i < recipes.size(); ++i)
    if (recipes[i].valid.value_or(false))
      if (const auto done = assign_pdo(profile, present, out.pdos[i], true, out.assignments); !done)
        return of(recipes[i], done.error());
  return {};
}

std::string fields(const PdoRecipe& recipe, std::string_view begin, std::string_view separator,
                   std::string_view end) {
  std::string out;
  const auto add = [&](std::string_view key, const std::string& value) {
    out += formatted("{}{}{}{}{}", begin, key, separator, value, end);
  };
  if (!recipe.cob_id.empty()) add("cob_id", toml_text(recipe.cob_id));
  if (recipe.valid) add("valid", *recipe.valid ? "true" : "false");
  if (recipe.type) add("type", formatted("{}", *recipe.type));
  if (recipe.inhibit_us) add("inhibit_us", formatted("{}", *recipe.inhibit_us));
  if (recipe.event_ms) add("event_ms", formatted("{}", *recipe.event_ms));
  if (recipe.sync_start) add("sync_start", formatted("{}", *recipe.sync_start));
  return out;
}

}  // namespace

Result<WantedPdos> follow(const drive::Profile& profile, const PresentPdos& present,
                          const std::vector<PdoRecipe>& recipes) {
  WantedPdos out;
  bool fixed = false;
  for (const auto& recipe : recipes) {
    auto pdo = find_pdo(present, recipe.pdo);
    if (!pdo) return of(recipe, pdo.error());
    if (std::any_of(out.pdos.begin(), out.pdos.end(), [&](const Pdo& other) {
          return other.direction == pdo->direction && other.number == pdo->number;
        }))
      return of(recipe, make_error(Errc::usage, "it appears twice"));
    const bool linked = present.values.count({pdo->communication_index(), 1}) > 0;
    fixed = fixed || !linked;
    if (const auto done = set_mapping(profile, recipe, *pdo); !done) return of(recipe, done.error());
    if (const auto done = set_times(recipe, *pdo); !done) return of(recipe, done.error());
    if (recipe.type) pdo->type = *recipe.type;
    if (linked)
      if (const auto done = set_cob_id(recipe, present, *pdo); !done) return of(recipe, done.error());
    out.pdos.push_back(std::move(*pdo));
  }
  if (fixed)
    if (const auto done = assign_all(profile, present, recipes, out); !done) return fail(done.error());
  return out;
}

PdoRecipe recipe_of(const drive::Profile* profile, const PresentPdos& present, const Pdo& pdo) {
  const auto holds = [&](std::uint16_t index, std::uint8_t sub) {
    return present.values.count({index, sub}) > 0;
  };
  const auto communication = pdo.communication_index();
  PdoRecipe out;
  out.pdo = canopen::name(pdo.direction, pdo.number);
  const bool whole = holds(pdo.mapping_index(), 0) &&
                     load_le(present.values.at({pdo.mapping_index(), 0})) == pdo.entries.size();
  if (whole) out.map.emplace();
  for (const auto& entry : pdo.entries)
    if (whole) out.map->push_back(formatted("{}/{}", to_string(entry.object), entry.bits));
  if (!holds(communication, 1)) {
    const auto assigned = session::assigned_pdos(profile, present.values);
    // Nothing is known of an assignment that is not told: it stays as it is.
    const auto list = session::assignment_of(profile, pdo.direction);
    if (list && present.values.count(*list) > 0)
      out.valid = std::count(assigned.begin(), assigned.end(), pdo.mapping_index()) > 0;
    return out;
  }
  const auto can_id = pdo.can_id();
  if (can_id > 0x7F && can_id <= 0x7FF && (can_id & 0x7FU) == present.node)
    out.cob_id = formatted("$NODEID+0x{:X}", can_id - present.node);
  else
    out.cob_id = show::can_id_text(can_id);
  out.valid = pdo.is_valid();
  if (holds(communication, 2)) out.type = pdo.type;
  if (pdo.inhibit) out.inhibit_us = *pdo.inhibit * 100U;
  out.event_ms = pdo.event;
  out.sync_start = pdo.sync_start;
  return out;
}

std::string pdo_toml(const drive::PdoFile& file, const std::vector<std::vector<std::string>>& names) {
  auto out = formatted("format = 1\nfamily = {}\n", toml_text(file.family));
  for (std::size_t i = 0; i < file.pdos.size(); ++i) {
    const auto& recipe = file.pdos[i];
    out += formatted("\n[[pdo]]\npdo = \"{}\"\n{}", recipe.pdo, fields(recipe, "", " = ", "\n"));
    if (!recipe.map) continue;
    out += "map = [\n";
    const auto& map = *recipe.map;
    for (std::size_t k = 0; k < map.size(); ++k)
      out += formatted("  {}, # {}\n", toml_text(map[k]), settings::comment_text(names[i][k]));
    out += "]\n";
  }
  return out;
}

std::string pdo_json(const drive::PdoFile& file) {
  auto out = formatted("{{\"format\":1,\"family\":{},\"pdo\":[", toml_text(file.family));
  for (std::size_t i = 0; i < file.pdos.size(); ++i) {
    const auto& recipe = file.pdos[i];
    std::string map;
    for (const auto& word : recipe.map.value_or(std::vector<std::string>()))
      map += (map.empty() ? "" : ",") + toml_text(word);
    const auto mapping = recipe.map ? formatted(",\"map\":[{}]", map) : std::string();
    out += formatted("{}\n{{\"pdo\":\"{}\"{}{}}}", i == 0 ? "" : ",", recipe.pdo,
                     fields(recipe, ",\"", "\":", ""), mapping);
  }
  return out + "\n]}\n";
}

SavedPdos saved_pdos(const show::Desk& desk, const PresentPdos& present) {
  SavedPdos out;
  if (desk.profile != nullptr) out.file.family = desk.profile->family;
  for (const auto& pdo : present.pdos) {
    out.file.pdos.push_back(recipe_of(desk.profile, present, pdo));
    auto& names = out.names.emplace_back();
    for (const auto& entry : pdo.entries)
      names.push_back(show::mapped_name(desk.profile, entry, desk.chinese));
  }
  return out;
}

}  // namespace servoctl::pdo
