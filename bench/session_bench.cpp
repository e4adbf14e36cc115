// What the pump and the SDO machines cost without a bus in the way: the simulated bus answers at once, in
// virtual time.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "session/interleave.hpp"
#include "session/scan.hpp"
#include "sim/cell.hpp"

namespace servoctl {
namespace {

const std::filesystem::path kFolders[] = {std::filesystem::path(SERVOCTL_SOURCE_DIR) / "eds"};

session::Session open(const char* spec) {
  return {sim::open_sim(spec, kFolders, sim::SimBus::Clock::virtual_time).value(), "bench", {}};
}

void read_one_object(benchmark::State& state) {
  auto session = open("gsd600@1");
  for (auto _ : state) benchmark::DoNotOptimize(session.upload(1, {0x6041, 0}));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(read_one_object);

void read_all_parameters_of_nodes(benchmark::State& state) {
  auto session = open("gsd600@1,gsd600@2,gsd600@3,gsd600@4,gsd600@5,gsd600@6,gsd600@7,gsd600@8");
  std::vector<session::SdoRequest> requests;
  for (std::int64_t node = 1; node <= state.range(0); ++node)
    for (int sub = 1; sub <= 331; ++sub)
      requests.push_back({static_cast<std::uint8_t>(node), {0x6041, 0}, {}});
  for (auto _ : state) benchmark::DoNotOptimize(session.transfer(requests));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(requests.size()));
}
BENCHMARK(read_all_parameters_of_nodes)->Arg(1)->Arg(8)->Unit(benchmark::kMillisecond);

/// A job a node, each reading one object after the other: two changes of the stack an object.
void read_one_object_each_side_by_side(benchmark::State& state) {
  auto session = open("gsd600@1,gsd600@2,gsd600@3,gsd600@4,gsd600@5,gsd600@6,gsd600@7,gsd600@8");
  constexpr int kReads = 1000;
  std::vector<session::Job> jobs;
  for (std::int64_t node = 1; node <= state.range(0); ++node)
    jobs.emplace_back([&session, node] {
      for (int i = 0; i < kReads; ++i)
        benchmark::DoNotOptimize(session.upload(static_cast<std::uint8_t>(node), {0x6041, 0}));
    });
  for (auto _ : state) session::Interleave(session, jobs).run();
  state.SetItemsProcessed(state.iterations() * state.range(0) * kReads);
}
BENCHMARK(read_one_object_each_side_by_side)->Arg(1)->Arg(8)->Unit(benchmark::kMillisecond)->UseRealTime();

void scan_127_nodes(benchmark::State& state) {
  auto session = open("gsd600@1");
  std::vector<std::uint8_t> nodes;
  for (int node = 1; node <= 127; ++node) nodes.push_back(static_cast<std::uint8_t>(node));
  for (auto _ : state) benchmark::DoNotOptimize(session::scan(session, nodes));
}
BENCHMARK(scan_127_nodes)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace servoctl
