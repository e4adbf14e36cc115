#include "settings/address_plan_frames.hpp"

#include <utility>

#include "settings/address_resume.hpp"

namespace servoctl::settings {
namespace {

/// As the drive of a row answers where it is now.
Result<AddressChange> look_at_row(show::Desk& desk, const AddressRow& row, const drive::Profile* profile,
                                  std::uint8_t place, const AddressWish& wish) {
  const FamilyScope family(desk, profile);
  auto change = plan_address(desk, place, wish);
  return change ? std::move(change) : fail(with_row(row, change.error()));
}

}  // namespace

Result<std::vector<AddressChange>> planned_bitrates(show::Desk& desk, std::span<const AddressRow> rows,
                                                    std::span<const drive::Profile* const> profiles,
                                                    const AddressJournal& journal) {
  std::vector<AddressChange> out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].bitrate) continue;
    auto change = look_at_row(desk, rows[i], profiles[i], place_of_row(rows[i], journal, i),
                              {.bitrate = rows[i].bitrate});
    if (!change) return fail(change.error());
    change->told_at = rows[i].to;
    out.push_back(std::move(*change));
  }
  return out;
}

Result<report::Value> planned_address_plan(show::Desk& desk, std::span<const AddressRow> rows,
                                           std::span<const drive::Profile* const> profiles,
                                           const AddressJournal& journal, bool unlock) {
  std::vector<AddressChange> sent;
  for (std::size_t i = journal.done; i < journal.steps.size(); ++i) {
    const auto& step = journal.steps[i];
    const auto& row = rows[step.row];
    auto change =
        look_at_row(desk, row, profiles[step.row], place_of_row(row, journal, step.row), {.node = step.to});
    if (!change) return fail(change.error());
    change->told_at = step.from;
    sent.push_back(std::move(*change));
  }
  auto bitrates = planned_bitrates(desk, rows, profiles, journal);
  if (!bitrates) return fail(bitrates.error());
  for (auto& change : *bitrates) sent.push_back(std::move(change));
  return planned_address(desk, sent, unlock);
}

}  // namespace servoctl::settings
