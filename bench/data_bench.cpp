// Reading drive data: what a command that names a family pays before it can begin.
#include <benchmark/benchmark.h>

#include <fmt/format.h>
#include <filesystem>

#include "base/file.hpp"
#include "cli/terminal/completer.hpp"
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

/// An EDS with `count` objects of one entry each.
std::string large_eds(int count) {
  std::string list = "[ManufacturerObjects]\nSupportedObjects=" + std::to_string(count) + "\n";
  std::string sections;
  for (int i = 0; i < count; ++i) {
    const auto index = fmt::format("{:04X}", 0x2000 + i);
    list += fmt::format("{}=0x{}\n", i + 1, index);
    sections += fmt::format(
        "[{}]\nParameterName=Quantity number {}\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\n"
        "DefaultValue=0x{}\nPDOMapping=0\n",
        index, i, index);
  }
  return list + sections;
}

void read_eds_of_5000_objects(benchmark::State& state) {
  const auto text = large_eds(5000);
  for (auto _ : state) benchmark::DoNotOptimize(od::read_eds(text, "x.eds"));
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) * state.iterations());
}
BENCHMARK(read_eds_of_5000_objects)->Unit(benchmark::kMillisecond);

/// What the first Tab of a prompt costs: the file is read, then the names are searched.
void complete_a_name_among_5000(benchmark::State& state) {
  const auto file = std::filesystem::temp_directory_path() / "servoctl-bench.eds";
  (void)write_file_atomically(file, large_eds(5000));
  for (auto _ : state) {
    cli::StandardConsole console;
    cli::Shell shell(console, {});
    shell.defaults().drive = file.string();
    benchmark::DoNotOptimize(cli::complete("read quantity_number_49", shell));
  }
  std::filesystem::remove(file);
}
BENCHMARK(complete_a_name_among_5000)->Unit(benchmark::kMillisecond);

/// What each further Tab costs, where all names fit and are listed.
void offer_each_of_5000(benchmark::State& state) {
  const auto file = std::filesystem::temp_directory_path() / "servoctl-bench.eds";
  (void)write_file_atomically(file, large_eds(5000));
  cli::StandardConsole console;
  cli::Shell shell(console, {});
  shell.defaults().drive = file.string();
  for (auto _ : state) benchmark::DoNotOptimize(cli::complete("read quantity_number_", shell));
  std::filesystem::remove(file);
}
BENCHMARK(offer_each_of_5000)->Unit(benchmark::kMillisecond);

/// The same behind `explain`, which takes the names of topics as well.
void offer_what_is_explained(benchmark::State& state) {
  const auto file = std::filesystem::temp_directory_path() / "servoctl-bench.eds";
  (void)write_file_atomically(file, large_eds(5000));
  cli::StandardConsole console;
  cli::Shell::Options options;
  options.drive_folders = {std::filesystem::path(SERVOCTL_SOURCE_DIR) / "eds"};
  cli::Shell shell(console, options);
  shell.defaults().drive = file.string();
  for (auto _ : state) benchmark::DoNotOptimize(cli::complete("explain ", shell));
  std::filesystem::remove(file);
}
BENCHMARK(offer_what_is_explained)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace servoctl
