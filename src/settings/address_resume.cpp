#include "settings/address_resume.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "session/scan.hpp"
#include "show/identity.hpp"

namespace servoctl::settings {

Result<AddressJournal> begin_address_journal(const std::filesystem::path& plan, std::string checksum,
                                             std::size_t rows, bool resume) {
  const auto path = address_journal_of(plan);
  auto found = read_address_journal(path);
  if (!found) return fail(found.error());
  if (*found && !resume)
    return fail(Errc::refused, message("{} was interrupted", as_it_is(plan.string())),
                "--resume continues it; `scan` shows where the drives are");
  if (!*found && resume)
    return fail(Errc::usage,
                message("there is nothing to resume: {} does not exist", as_it_is(path.string())),
                "leave --resume out");
  if (!*found)
    return AddressJournal{.checksum = std::move(checksum), .steps = {}, .families = {}, .drives = {}};
  if ((*found)->checksum != checksum || (*found)->drives.size() != rows)
    return fail(Errc::refused, message("{} has changed since it was interrupted", as_it_is(plan.string())),
                "resuming needs the plan as it was");
  return std::move(**found);
}

Result<void> settle_address_step(session::Session& session, AddressJournal& journal) {
  if (!journal.begun || journal.done >= journal.steps.size()) return {};
  const auto& step = journal.steps[journal.done];
  const std::uint8_t both[] = {step.from, step.to};
  const auto found = session::scan(session, both);
  if (!found) return fail(found.error());
  const auto is_at = [&](std::uint8_t node) {
    return std::any_of(found->begin(), found->end(), [&](const session::Identity& identity) {
      return identity.node == node && show::change_of(journal.drives[step.row], identity).empty();
    });
  };
  if (is_at(step.from) && is_at(step.to))
    return fail(drive_error(Errc::refused, step.from,
                            message("it was on its way to node {}, and both answer now", step.to),
                            "`scan --long` shows both; make sure that only one of them is there"));
  if (!is_at(step.from) && !is_at(step.to))
    return fail(drive_error(Errc::timeout, step.from,
                            message("it was on its way to node {}, and is at neither", step.to),
                            "switch it off and on, and resume again"));
  if (is_at(step.to)) ++journal.done;
  journal.begun = false;
  return {};
}

std::uint8_t place_of_row(const AddressRow& row, const AddressJournal& journal, std::size_t number) {
  auto node = row.node;
  for (std::size_t i = 0; i < journal.done; ++i)
    if (journal.steps[i].row == number) node = journal.steps[i].to;
  return node;
}

bool has_steps_left(const AddressJournal& journal, std::size_t row) {
  for (std::size_t i = journal.done; i < journal.steps.size(); ++i)
    if (journal.steps[i].row == row) return true;
  return false;
}

Result<void> same_families(std::span<const AddressRow> rows, std::span<const drive::Profile* const> profiles,
                           const AddressJournal& journal) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& begun = journal.families[i];
    if (begun.empty() || begun == profiles[i]->family) continue;
    auto error = make_error(
        Errc::refused,
        message("it was begun as a {}, not as a {}", as_it_is(begun), as_it_is(profiles[i]->family)),
        "resuming needs the families as they were");
    return fail(with_row(rows[i], std::move(error)));
  }
  return {};
}

Error awaits_power(const AddressStep& step) {
  return drive_error(
      Errc::negative, step.from,
      message("it is to be switched off and on before the next one moves: then it is node {}", step.to),
      "switch it off and on, then add --resume; --wait 5min waits for it");
}

Error with_row(const AddressRow& row, Error error) {
  if (!error.node) error.node = row.node;
  error.message = message("line {}: {}", row.line, error.message);
  return error;
}

}  // namespace servoctl::settings
