#include "traffic/sync_end.hpp"

#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "session/can_network.hpp"
#include "session/option_scope.hpp"
#include "traffic/rhythm_table.hpp"

namespace servoctl::traffic {
namespace {

/// Modes of operation that take their targets at SYNC: ip, csp, csv, cst (CiA 402-2, 6060h).
constexpr std::uint64_t kFirstCyclicMode = 7;
constexpr std::uint64_t kLastCyclicMode = 10;

/// Empty when its mode is known to be none that follows SYNC.
std::string warning(session::Session& session, std::uint8_t node) {
  const auto mode = session.upload(node, objects::kModeDisplay);
  const bool known = mode && mode->size() == 1;
  if (known && (mode->front() < kFirstCyclicMode || mode->front() > kLastCyclicMode)) return {};
  return formatted(
      "node {} is energised{}: without SYNC it gets no new targets and, depending on the drive, holds, runs "
      "on or faults; `disable -n {}`",
      node, known ? " in a mode that follows SYNC" : ", and its mode cannot be read", node);
}

}  // namespace

SyncEnd end_sync(session::Session& session) {
  SyncEnd out;
  const session::Deaf deaf(session);
  // While SYNC still goes on: reading takes a moment.
  for (const auto node : session.energised().nodes())
    if (auto text = warning(session, node); !text.empty()) out.warnings.push_back(std::move(text));
  const auto& production = *session.can()->sync();
  if (production.foreign > 0)
    out.warnings.push_back(formatted(
        "another producer sent {} SYNCs meanwhile: the period was irregular for drives", production.foreign));
  out.table.columns = rhythm_columns();
  out.table.columns.push_back({"missed"});
  auto row = rhythm_cells(production.rhythm);
  row.emplace_back(production.producer.missed());
  out.table.rows.push_back(std::move(row));
  session.can()->stop_sync();
  return out;
}

}  // namespace servoctl::traffic
