// Reading drive data: what a command that names a family pays before it can begin.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "base/file.hpp"
#include "drive/naming.hpp"
#include "od/eds.hpp"

namespace servoctl {
namespace {

const std::filesystem::path kFolders[] = {std::filesystem::path(SERVOCTL_SOURCE_DIR) / "eds"};
const std::string kStem = SERVOCTL_SOURCE_DIR "/eds/vmmore/gsd600";

void read_eds_text(benchmark::State& state) {
  const auto text = read_file(kStem + ".eds").value();
  for (auto _ : state) benchmark::DoNotOptimize(od::read_eds(text, "x.eds"));
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) * state.iterations());
}
BENCHMARK(read_eds_text)->Unit(benchmark::kMicrosecond);

void read_parameters(benchmark::State& state) {
  const auto text = read_file(kStem + ".params.csv").value();
  for (auto _ : state) benchmark::DoNotOptimize(od::parse_parameters(text, "x.csv"));
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) * state.iterations());
}
BENCHMARK(read_parameters)->Unit(benchmark::kMicrosecond);

void load_whole_family(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(drive::load_profile("gsd600", kFolders));
}
BENCHMARK(load_whole_family)->Unit(benchmark::kMicrosecond);

void resolve_a_name(benchmark::State& state) {
  const auto profile = drive::load_profile("gsd600", kFolders).value();
  for (auto _ : state) benchmark::DoNotOptimize(drive::resolve(&profile, "statusword"));
}
BENCHMARK(resolve_a_name)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace servoctl
