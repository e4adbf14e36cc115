// Backup and restore of the panel parameters of real-time drives beside the floor: as many bare pairs of
// request and answer. usage: servoctl_settings_bench INTERFACE FAMILY; drives of it are nodes 1 to 8.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "drive/quantity.hpp"
#include "raw_can.hpp"
#include "session/open_bus.hpp"
#include "session/restore.hpp"
#include "session/snapshot.hpp"

namespace servoctl::bench {
namespace {

const std::filesystem::path kFolders[] = {std::filesystem::path(SERVOCTL_SOURCE_DIR) / "eds"};
constexpr std::uint8_t kNodes[] = {1, 2, 3, 4, 5, 6, 7, 8};

void tell(const char* what, double seconds, int pairs, double floor) {
  std::printf("%-28s %6.0f ms, %4d pairs of frames in a row take %6.0f ms: %3.0f %%\n", what, seconds * 1e3,
              pairs, floor * 1e3, 100 * floor / seconds);
}

/// Another value each parameter takes: one more, or the least at its upper limit.
session::Values changed(const drive::Profile& profile, const session::Values& present) {
  session::Values out = present;
  for (auto& [object, data] : out) {
    const auto target = drive::target_at(&profile, object);
    const auto meaning = drive::meaning(target, 1);
    const auto value = od::decode(meaning.type, data);
    const auto one_more =
        value ? od::encode(meaning.type, od::Value(static_cast<std::int64_t>(od::to_double(*value)) + 1))
              : tl::unexpected<Error>(value.error());
    if (!one_more || data.size() > 4) continue;
    const auto next = od::decode(meaning.type, *one_more);
    if (next && drive::check_limits(meaning, *next)) data = *one_more;
  }
  return out;
}

/// Whether it is safe for this benchmark to change it: not the address.
bool may_change(const drive::Profile& profile, const session::SnapshotEntry& entry) {
  const auto* parameter = profile.parameter(entry.object);
  const auto& nmt = profile.rules.nmt;
  return entry.bytes && parameter != nullptr && parameter != profile.parameter(nmt.node_id) &&
         parameter != profile.parameter(nmt.bitrate);
}

int run(const char* interface, std::string_view family) {
  const auto profile = drive::load_profile(family, kFolders).value();
  auto bus = session::open_bus(interface, {});
  if (!bus) return 3;
  session::Session session(std::move(*bus), interface, {});
  const auto parameters = [](const drive::DriveSetting& setting) { return setting.parameter != nullptr; };

  const auto backup = [&](std::span<const std::uint8_t> nodes) {
    const auto begin = Clock::now();
    const auto taken = session::take_snapshots(session, profile, nodes, parameters);
    const auto seconds = seconds_since(begin);
    for (const auto& each : taken)
      if (!each) std::exit(4);
    return std::pair(seconds, taken.front()->entries);
  };
  const auto [one, entries] = backup(std::span(kNodes).first(1));
  const int pairs = static_cast<int>(std::count_if(
      entries.begin(), entries.end(), [](const session::SnapshotEntry& e) { return e.bytes.has_value(); }));
  tell("backup of one drive", one, pairs, raw_reads(interface, 1, pairs));
  const auto eight = backup(kNodes).first;
  std::printf("%-28s %6.0f ms: %.2f times as long as one\n", "backup of eight drives", eight * 1e3,
              eight / one);

  session::Values present;
  for (const auto& entry : entries)
    if (may_change(profile, entry)) present.emplace(entry.object, *entry.bytes);
  const auto wanted = changed(profile, present);
  const auto begin = Clock::now();
  const auto there = session::restore(session, &profile, 1, present, wanted, {});
  const auto seconds = seconds_since(begin);
  const auto back = session::restore(session, &profile, 1, wanted, present, {});
  if (there.failure || back.failure) {
    std::printf("%s\n", (there.failure ? there.failure : back.failure)->message.c_str());
    return 5;
  }
  // Each value is written, read back, and read once more at the end.
  const int three = 3 * static_cast<int>(there.writes);
  tell("restore of what all differs", seconds, three, raw_reads(interface, 1, three));
  return 0;
}

}  // namespace
}  // namespace servoctl::bench

int main(int argc, char** argv) { return argc == 3 ? servoctl::bench::run(argv[1], argv[2]) : 2; }
