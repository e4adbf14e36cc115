// What --dry-run shows is what the same line then sends, on every family, and it refuses what that refuses.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "can/trace.hpp"
#include "cli/shell.hpp"
#include "obeying.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;
using report::List;
using report::Record;
using report::Table;
using report::Value;

/// A frame that --dry-run names.
struct Planned {
  std::string frame;
  bool conditional = false;
};

void find_frames(const Value& value, std::vector<Planned>& out) {
  if (const auto* record = std::get_if<Record>(&value.data()))
    for (const auto& field : *record) find_frames(field.value, out);
  const auto* table = value.table();
  if (table == nullptr) return;
  std::optional<std::size_t> frame;
  std::optional<std::size_t> when;
  for (std::size_t i = 0; i < table->columns.size(); ++i) {
    if (table->columns[i].key == "frame") frame = i;
    if (table->columns[i].key == "when") when = i;
  }
  if (!frame) return;
  for (const auto& row : table->rows)
    out.push_back({std::get<std::string>(row[*frame].data()), when && !row[*when].is_null()});
}

/// Frames of servoctl that change something: NMT, and the first of each SDO download.
bool changes(const can::Frame& frame) {
  if (frame.extended || frame.error || frame.remote) return false;
  if (frame.id == 0) return true;
  if (frame.id <= 0x600 || frame.id > 0x67F) return false;
  const auto command = frame.data[0] >> 5U;  // CiA 301, 7.2.4.3: client command specifier.
  return command == 1 || (command == 6 && (frame.data[0] & 1U) == 0);
}

class DryRun : public testing::TestWithParam<std::string> {
 protected:
  DryRun() {
    fs::create_directories(dir_ / "state");
    fs::current_path(dir_);
  }
  ~DryRun() override {
    fs::current_path(source_dir());
    fs::remove_all(dir_);
  }

  /// Runs `before` and then the line on drives of its own; frames are those of the line that change
  /// something.
  Outcome perform(const std::string& before, const std::string& line, bool dry) {
    Shell::Options options;
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.state_folder = dir_ / "state";
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = "sim:" + GetParam() + "@1" + obeying(GetParam());
    if (!fault.empty()) options.defaults.bus += (obeying(GetParam()).empty() ? "?" : "&") + fault;
    options.defaults.drive = GetParam();
    options.defaults.yes = true;
    options.defaults.trace = dir_ / "trace.log";
    fs::remove(dir_ / "trace.log");
    Outcome out;
    std::size_t first = 0;
    {
      Shell shell(console, std::move(options));
      shell.stay_open(true);
      for (const auto& each : lines_of(before)) (void)shell.perform(words_of(each));
      first = frames_in_trace().size();
      auto words = words_of(line);
      if (dry) words.emplace_back("--dry-run");
      out = shell.perform(words);
      frames = frames_in_trace();
    }
    frames.erase(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(first));
    return out;
  }

  std::vector<std::string> frames_in_trace() const {
    std::vector<std::string> out;
    std::ifstream trace(dir_ / "trace.log");
    for (std::string text; std::getline(trace, text);)
      if (const auto logged = can::parse_log_line(text); logged && changes(logged->frame))
        out.push_back(can::to_string(logged->frame));
    return out;
  }

  static std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> out;
    std::istringstream in(line);
    for (std::string word; in >> word;) out.push_back(word);
    return out;
  }
  static std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> out;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line, ';');)
      if (!line.empty()) out.push_back(line);
    return out;
  }

  void expect_true(const std::string& line, const std::string& before = {}) {
    SCOPED_TRACE(line);
    const auto dry = perform(before, line, true);
    EXPECT_TRUE(frames.empty()) << "a dry run has sent " << frames.front();
    std::vector<Planned> planned;
    find_frames(dry.result, planned);
    const auto real = perform(before, line, false);
    const auto why = real.errors.empty() ? std::string() : real.errors.front().message.text();
    if (frames.empty()) {
      EXPECT_EQ(dry.code(), real.code()) << "the line itself says: " << why;
      EXPECT_TRUE(planned.empty()) << planned.front().frame << " would not be sent: " << why;
      return;
    }
    ++carried_out;
    std::size_t sent = 0;
    for (const auto& each : planned) {
      const auto frame = can::parse_frame(each.frame);
      ASSERT_TRUE(frame) << each.frame;
      if (!changes(*frame)) continue;
      if (sent < frames.size() && frames[sent] == each.frame)
        ++sent;
      else
        EXPECT_TRUE(each.conditional) << each.frame << " is shown and not sent; sent was "
                                      << (sent < frames.size() ? frames[sent] : "no more");
    }
    EXPECT_EQ(sent, frames.size()) << "sent and not shown: "
                                   << (sent < frames.size() ? frames[sent] : std::string());
  }

  fs::path dir_ =
      fs::temp_directory_path() / ("servoctl-dry-run-" + std::to_string(::getpid()) + "-" + GetParam());
  RecordingConsole console;
  std::string fault;
  std::vector<std::string> frames;
  int carried_out = 0;
};

TEST_P(DryRun, ShowsWhatIsSentByCommandsThatStoreResetAndSwitch) {
  for (const auto* line : {"store -n 1",
                           "store communication -n 1",
                           "defaults -n 1",
                           "disable -n 1",
                           "quick-stop -n 1",
                           "stop -n 1",
                           "mode 1 -n 1",
                           "mode 3 -n 1",
                           "mode 99 -n 1",
                           "enable -n 1",
                           "fault reset -n 1",
                           "fault clear-history -n 1",
                           "nmt start -n 1",
                           "pdo map TPDO1 0x6041 -n 1",
                           "pdo map TPDO1 0x6041 --keep -n 1",
                           "pdo clear RPDO1 -n 1",
                           "write 0x6083 2000 -n 1",
                           "write 0x6083 2000 --keep -n 1",
                           "write 0x6040 6 -n 1",
                           "write 0x6083 2000 --unlock -n 1"})
    expect_true(line);
  EXPECT_GE(carried_out, 8);
}

TEST_P(DryRun, ShowsWhatIsSentByMotions) {
  for (const auto* line :
       {"jog 30rpm --for 2s --turn 10000 -n 1", "jog -30rpm --for 1s --turn 10000 -n 1",
        "jog 900rpm --for 1s --turn 10000 -n 1", "home 35 --speed 30rpm --search 6rpm --turn 10000 -n 1",
        "home 0 --turn 10000 -n 1", "move 90deg --speed 30rpm --turn 10000 -n 1",
        "torque 5% --for 1s --limit 30rpm --turn 10000 -n 1", "test jog 30rpm --turn 10000 -n 1"})
    expect_true(line);
  EXPECT_GE(carried_out, 2);
}

TEST_P(DryRun, ShowsWhatIsSentForPanelParameters) {
  const std::map<std::string, std::string> parameters{
      {"gsd600", "Pn0214=450"}, {"da200", "P0.03=2"}, {"sv2", "PA-05=2"}, {"ts", "Fn_33=2"}};
  const auto parameter = parameters.find(GetParam());
  if (parameter == parameters.end()) GTEST_SKIP() << "has none";
  for (const auto* option : {"", " --keep", " --unlock", " --keep --unlock"})
    expect_true("param set " + parameter->second + " -n 1" + option);
}

/// In the state the drive is in: energised, it refuses; in a fault, there is something to reset.
TEST_P(DryRun, GoesByTheStateOfTheDrive) {
  const std::string enabled = "write 0x6040 6 -n 1;write 0x6040 7 -n 1;write 0x6040 15 -n 1";
  for (const auto* line :
       {"mode 3 -n 1", "enable -n 1", "fault reset -n 1", "disable -n 1", "quick-stop -n 1",
        "pdo map TPDO1 0x6041 -n 1", "jog 30rpm --for 1s --turn 10000 -n 1", "home 35 --turn 10000 -n 1"})
    expect_true(line, enabled);
  fault = "fault=0x8250@1ms";
  for (const auto* line : {"fault reset -n 1", "enable -n 1", "jog 30rpm --for 1s --turn 10000 -n 1"})
    expect_true(line, "nmt watch -n 1 --guard 1s --for 50ms");
}

INSTANTIATE_TEST_SUITE_P(Families, DryRun, testing::Values("gsd600", "dm", "da200", "ts", "sv2", "cia402"),
                         [](const auto& family) { return family.param; });

}  // namespace
}  // namespace servoctl::cli
