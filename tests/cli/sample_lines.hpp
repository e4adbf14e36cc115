#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "can/frame.hpp"
#include "can/trace.hpp"
#include "cli/batch/batch_command.hpp"
#include "cli/shell.hpp"
#include "obeying.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {

namespace fs = std::filesystem;

/// One line of every command; PARAM, FAULTS … stand for what differs from family to family.
inline const std::map<std::string, std::string> kSampleLines{
    {"scan", "scan"},
    {"bus status", "bus status"},
    {"bus up", "bus up no-such-can --bitrate 500k -y"},
    {"bus down", "bus down no-such-can -y"},
    {"bus detect", "bus detect no-such-can -y"},
    {"doctor", "doctor no-such-can --active"},
    {"info", "info -n 1"},
    {"status", "status -n 1,2"},
    {"read", "read 0x6041 0x1018:1 -n 1"},
    {"write", "write 0x6040 15 -n 1 -y"},
    {"explain", "explain statusword"},
    {"objects", "objects"},
    {"param list", "param list"},
    {"param get", "param get PARAM -n 1"},
    {"param set", "param set PARAM=2 --keep -n 1 -y"},
    {"param search", "param search speed"},
    {"param explain", "param explain PARAM"},
    {"backup", "backup DIR/new.json -n 1"},
    {"diff", "diff DIR/backup.json node:2"},
    {"verify", "verify DIR/backup.json -n 1"},
    {"restore", "restore DIR/backup.json -n 1 -y"},
    {"clone", "clone --from 1 --to 2 -y"},
    {"address", "address 9 -n 1 -y"},
    {"lss scan", "lss scan --assign 9 -y"},
    {"lss inquire", "lss inquire --only"},
    {"lss select", "lss select --only"},
    {"lss set-node", "lss set-node 9 --only -y"},
    {"lss set-bitrate", "lss set-bitrate 500k --only --activate 1s -y"},
    {"lss store", "lss store --only -y"},
    {"store", "store -n 1 -y"},
    {"defaults", "defaults -n 1 -y"},
    {"fault show", "fault show -n 1"},
    {"fault list", "fault list"},
    {"fault reset", "fault reset -n 1 -y"},
    {"fault clear-history", "fault clear-history -n 1 -y"},
    {"enable", "enable -n 1 -y"},
    {"disable", "disable -n 1,2"},
    {"quick-stop", "quick-stop -n 1,2"},
    {"stop", "stop"},
    {"mode", "mode 1 -n 1"},
    {"jog", "jog 30rpm --for 1s --turn 10000 -n 1 -y"},
    {"move", "move 90deg --relative --speed 30rpm --turn 10000 -n 1 -y"},
    {"home", "home 35 --turn 10000 -n 1 -y"},
    {"units show", "units show -n 1"},
    {"units learn", "units learn -n 1 -y"},
    {"units forget", "units forget -n 1"},
    {"torque", "torque 5% --for 1s --limit 30rpm --turn 10000 -n 1 -y"},
    {"heartbeat set", "heartbeat set 100ms -n 1 --keep -y"},
    {"heartbeat consume", "heartbeat consume 2=300ms -n 1 -y"},
    {"heartbeat show", "heartbeat show -n 1,2"},
    {"watchdog", "watchdog -n 1,2"},
    {"nmt start", "nmt start -n 1 -y"},
    {"nmt stop", "nmt stop -n 1 -y"},
    {"nmt preop", "nmt preop -n 1 -y"},
    {"nmt reset", "nmt reset -n 1 -y"},
    {"nmt reset-comm", "nmt reset-comm -n 1 -y"},
    {"nmt watch", "nmt watch --guard 100ms --for 1s -n 1"},
    {"state init", "state init -n 1 -y"},
    {"state preop", "state preop -n 1 -y"},
    {"state safeop", "state safeop -n 1 -y"},
    {"state op", "state op -n 1 -y"},
    {"pdo show", "pdo show -n 1"},
    {"pdo map", "pdo map TPDO1 0x6041 -n 1 -y"},
    {"pdo enable", "pdo enable TPDO2 -n 1 -y"},
    {"pdo disable", "pdo disable TPDO1 -n 1 -y"},
    {"pdo clear", "pdo clear TPDO1 -n 1 -y"},
    {"pdo preset", "pdo preset pv -n 1 -y"},
    {"pdo apply", "pdo apply DIR/pdos.toml -n 1 -y"},
    {"pdo save", "pdo save DIR/saved.toml -n 1"},
    {"pdo watch", "pdo watch --for 1s -n 1"},
    {"pdo send", "pdo send RPDO1 15 -n 1 -y"},
    {"test comm", "test comm -n 1"},
    {"test io", "test io --for 1s -n 1"},
    {"test jog", "test jog 30rpm --turn 10000 -n 1 -y"},
    {"test home", "test home --turn 10000 -n 1 -y"},
    {"test all", "test all 30rpm --turn 10000 -n 1 -y"},
    {"report", "report DIR/report.json -n 1"},
    {"witness", "witness DIR/witness.json -n 1"},
    {"sync once", "sync once -y"},
    {"sync start", "sync start --for 1s -y"},
    {"sync stop", "sync stop"},
    {"watch", "watch 0x6041 --for 1s -n 1"},
    {"scope", "scope 0x6041 0x6064 --for 1s -n 1"},
    {"monitor", "monitor --for 1s"},
    {"decode", "decode DIR/recording.log"},
    {"replay", "replay DIR/recording.log --speed 100 -n 1 -y"},
    {"drives", "drives"},
    {"drives check", "drives check gsd600"},
    {"drives new", "drives new p22 --from EDS --dry-run"},
    {"cabinet check", "cabinet check tests/cli/data/cabinet.toml"},
    {"cabinet init", "cabinet init DIR/made.toml"},
    {"cabinet show", "cabinet show --cabinet DIR/cabinet.toml"},
    {"cabinet plan", "cabinet plan --cabinet DIR/cabinet.toml"},
    {"cabinet apply", "cabinet apply --cabinet DIR/cabinet.toml -y"},
    {"cabinet swap", "cabinet swap a1 --from 9 --cabinet DIR/cabinet.toml -y"},
    {"cabinet backup", "cabinet backup --cabinet DIR/cabinet.toml"},
    {"cabinet diff", "cabinet diff DIR/cabinet.toml DIR/cabinet.toml"},
    {"eds check", "eds check EDS"},
    {"eds verify", "eds verify EDS -n 1"},
    {"eds learn", "eds learn -o DIR/learned.eds --range 6040-6041 -n 1"},
    {"run", "run DIR/lines.servoctl"},
    {"sim", "sim FAMILY@3"},
    {"gateway", "gateway --listen DIR/gateway --allow write -y"},
    {"help", "help jog"},
    {"man", "man"},
    {"completion", "completion bash"},
};

/// Runs the samples on two simulated drives of a family, each line with a bus and a shell of its own, and
/// keeps the frames.
class SampleLines {
 public:
  explicit SampleLines(std::string family) : family_(std::move(family)) {
    fs::create_directories(dir_);
    std::ofstream(dir_ / "recording.log") << "(0000000001.000000) can0 601#2B4060000F000000\n"
                                             "(0000000001.001000) can0 581#6040600000000000\n"
                                             "(0000000001.002000) can0 000#0101\n"
                                             "(0000000001.003000) can0 201#0F00\n"
                                             "(0000000001.004000) can0 080#\n";
    std::ofstream(dir_ / "pdos.toml") << "[TPDO1]\nmap = [\"0x6041\"]\n";
    std::ofstream(dir_ / "lines.servoctl") << "read 0x6041 -n 1\nwrite 0x6040 15 -n 1 -y\n";
    std::ofstream(dir_ / "cabinet.toml")
        << "[bus.main]\nurl = \"sim:" << family_ << "@1," << family_ << "@2\"\n[axis.\"a{1-2}\"]\n"
        << "node = \"1-2\"\nfamily = \"" << family_ << "\"\nparameters = { \"0x6083\" = 1234 }\n";
    EXPECT_EQ(perform("backup DIR/backup.json -n 1"), 0) << console.err_text;
  }
  SampleLines(const SampleLines&) = delete;
  SampleLines& operator=(const SampleLines&) = delete;
  ~SampleLines() { fs::remove_all(dir_); }
  const fs::path& folder() const { return dir_; }

  /// The exit code; frames are those that were on the bus. Without `names_family` no family is given.
  int perform(std::string line, const std::string& option = {}, bool names_family = true) {
    const std::map<std::string, std::string> parameters{
        {"gsd600", "Pn0214"}, {"da200", "P0.03"}, {"sv2", "PA-05"}, {"ts", "Fn_33"}};
    const auto parameter = parameters.find(family_);
    replace(line, "PARAM", parameter == parameters.end() ? "none" : parameter->second);
    replace(line, "DIR", dir_.string());
    replace(line, "FAMILY", family_);
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(source_dir()) / "eds"))
      if (entry.path().filename() == family_ + ".eds") replace(line, "EDS", entry.path().string());
    std::vector<std::string> words;
    std::istringstream in(line);
    for (std::string word; in >> word;) words.push_back(word);
    if (!option.empty()) words.push_back(option);
    console.err_text.clear();
    // Both serve until they are cancelled; `gateway` waits for clients, a quarter of a second each time.
    const bool serves = words.front() == "sim" || words.front() == "gateway";
    int questions_left = words.front() == "gateway" ? 5 : 3'000;
    Shell::Options options;
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.state_folder = dir_ / "state";
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = "sim:" + family_ + "@1," + family_ + "@2" + obeying(family_);
    if (names_family) options.defaults.drive = family_;
    options.defaults.trace = dir_ / "trace.log";
    options.cancelled = [&, serves] { return serves && questions_left-- <= 0; };
    fs::remove(dir_ / "trace.log");
    int code = 0;
    {
      Shell shell(console, std::move(options));
      code = is_batch(words) ? run_batch(shell, words, {}) : shell.run(words);
    }
    frames.clear();
    std::ifstream trace(dir_ / "trace.log");
    for (std::string text; std::getline(trace, text);)
      if (const auto logged = can::parse_log_line(text)) frames.push_back(logged->frame);
    return code;
  }
  /// What it was told of drives by -d before is not known any more.
  void forget_drives() const { fs::remove_all(dir_ / "state"); }

  RecordingConsole console;
  std::vector<can::Frame> frames;

 private:
  static void replace(std::string& text, std::string_view from, std::string_view to) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  }

  std::string family_;
  fs::path dir_ =
      fs::temp_directory_path() / ("servoctl-samples-" + std::to_string(::getpid()) + "-" + family_);
};

}  // namespace servoctl::cli
