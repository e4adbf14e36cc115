// Files that a line writes: none is replaced without a question, by --read-only none at all.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "cli/batch/batch_command.hpp"
#include "cli/line_runner.hpp"
#include "cli/output_files.hpp"
#include "command/registry.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr std::string_view kOld = "of somebody\n";

class OutputFile : public testing::Test {
 protected:
  OutputFile() : shell(console, options()) {
    fs::create_directories(folder / "job");
    std::ofstream(file) << kOld;
  }
  ~OutputFile() override { fs::remove_all(folder); }

  static Shell::Options options() {
    Shell::Options o;
    o.drive_folders = {fs::path(source_dir()) / "eds"};
    o.clock = sim::SimBus::Clock::virtual_time;
    o.defaults.bus = "sim:gsd600@1";
    o.defaults.drive = "gsd600";
    o.defaults.nodes = "1";
    return o;
  }

  static std::string text_of(const fs::path& path) {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  bool kept() const { return text_of(file) == kOld; }
  bool told(std::string_view text) const { return console.err_text.find(text) != std::string::npos; }
  int run(Words words) {
    console.err_text.clear();
    console.questions.clear();
    return shell.run(words);
  }
  /// Runs the text as `servoctl run FILE MORE`, from a file in job/.
  int run_text(const std::string& text, Words more = {}) {
    std::ofstream(folder / "job/steps.servoctl") << text;
    console.err_text.clear();
    more.insert(more.begin(), {"run", (folder / "job/steps.servoctl").string()});
    return run_batch(shell, more, {});
  }

  const fs::path folder =
      fs::temp_directory_path() / (std::string("servoctl-outputs-") + std::to_string(::getpid()) + "-" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
  const fs::path file = folder / "old.json";
  RecordingConsole console;
  Shell shell;
};

TEST_F(OutputFile, ThatExistsIsReplacedOnlyWhenSomebodySaysSo) {
  const auto name = file.string();
  const Words lines[] = {{"read", "0x1000", "--to", name},
                         {"backup", name},
                         {"report", name},
                         {"pdo", "save", name},
                         {"scope", "statusword", "--for", "50ms", "--csv", name},
                         {"scope", "statusword", "--for", "50ms", "--svg", name},
                         {"test", "comm", "--count", "3", "--junit", name},
                         {"read", "0x1000", "--trace", name}};
  for (const auto& line : lines) {
    EXPECT_EQ(run(line), 8) << line.front() << console.err_text;
    EXPECT_TRUE(told("confirmation needed: Replace the file " + name + "?")) << console.err_text;
    EXPECT_TRUE(kept()) << line.front();
    auto only_read = line;
    only_read.insert(only_read.end(), {"--read-only", "--yes"});
    EXPECT_EQ(run(only_read), 8) << line.front();
    EXPECT_TRUE(told("--read-only replaces no file")) << console.err_text;
    EXPECT_TRUE(kept()) << line.front();
  }
}

TEST_F(OutputFile, OfEveryCommandIsKnownAsOne) {
  for (const auto* command : command::registry())
    for (const auto& parameter : command->parameters) {
      const bool writes = parameter.help.find("to this file") != std::string_view::npos ||
                          parameter.help.find("to a file") != std::string_view::npos;
      EXPECT_TRUE(!writes || is_output(*command, parameter)) << command->path << " " << parameter.name;
    }
}

TEST_F(OutputFile, IsReplacedAfterAYes) {
  EXPECT_EQ(run({"read", "0x1000", "--to", file.string(), "--yes"}), 0) << console.err_text;
  EXPECT_EQ(fs::file_size(file), 4U);
  console.person = console.answer = true;
  EXPECT_EQ(run({"backup", file.string()}), 0) << console.err_text;
  EXPECT_EQ(console.questions, Words{"Replace the file " + file.string() + "?"});
  EXPECT_GT(fs::file_size(file), 4U);
}

TEST_F(OutputFile, ThatIsNewOrEmptyNeedsNoQuestion) {
  const auto fresh = (folder / "new.json").string();
  EXPECT_EQ(run({"backup", fresh, "--read-only"}), 0) << console.err_text;
  std::ofstream(file, std::ios::trunc).flush();
  EXPECT_EQ(run({"read", "0x1000", "--to", file.string()}), 0) << console.err_text;
}

TEST_F(OutputFile, BehindALinkIsNamedInTheQuestion) {
  const auto link = folder / "link.bin";
  fs::create_symlink(file, link);
  EXPECT_EQ(run({"read", "0x1000", "--to", link.string()}), 8);
  EXPECT_TRUE(
      told("Replace the file " + fs::canonical(file).string() + ", to which the link " + link.string()))
      << console.err_text;
}

TEST_F(OutputFile, OfABatchIsToldBeforeTheFirstLine) {
  EXPECT_EQ(run_text("param set Pn0214 45Hz\nread 0x1000 --to " + file.string()), 8) << console.err_text;
  EXPECT_TRUE(told("steps.servoctl:2: confirmation needed")) << console.err_text;
  EXPECT_TRUE(kept());
}

TEST_F(OutputFile, OfALogIsAddedToOnlyWhereItIsOne) {
  LineRunner runner(shell);
  EXPECT_EQ(runner.run("log on " + file.string()), 8);
  EXPECT_TRUE(kept());
  std::ofstream(file, std::ios::trunc) << "2026-11-23T14:00:00.123Z > scan\n";
  EXPECT_EQ(runner.run("log on " + file.string()), 0) << console.err_text;
  EXPECT_EQ(runner.run("log off"), 0);
}

class RestrictedRun : public OutputFile {
 protected:
  void refuses(const std::string& line, std::string_view why) {
    EXPECT_EQ(run_text(line, {"--restricted", "--yes"}), 8) << line << "\n" << console.err_text;
    EXPECT_TRUE(told(why)) << line << "\n" << console.err_text;
    EXPECT_TRUE(kept()) << line;
  }
};

TEST_F(RestrictedRun, ReachesOnlyTheBusItWasGiven) {
  refuses("scan --bus sim:gsd600@2", "--restricted allows no other bus than sim:gsd600@1: sim:gsd600@2");
  refuses("bus sim:gsd600@2", "--restricted allows no other bus");
  refuses("sim gsd600@3 --bus local:x", "--restricted does not allow 'sim'");
  refuses("gateway --listen 127.0.0.1:0", "--restricted does not allow 'gateway'");
  refuses("bus up can7 --bitrate 500k", "--restricted does not allow 'bus up'");
  EXPECT_EQ(run_text("bus sim:gsd600@1\nread 0x1000\nread 0x1000 --bus sim:gsd600@1", {"--restricted"}), 0)
      << console.err_text;
}

TEST_F(RestrictedRun, ReadsAndWritesOnlyBelowItsFolder) {
  const auto old = file.string();
  refuses("read 0x1000 --to " + old, "--restricted allows no file outside of");
  refuses("read 0x1000 --trace " + old, "--restricted allows no file outside of");
  refuses("write 0x2001:0F --from /etc/hostname", "--restricted allows no file outside of");
  refuses("read 0x1000 -d " + (folder / "x.eds").string(), "--restricted allows no file outside of");
  refuses("drive " + (folder / "x.eds").string(), "--restricted allows no file outside of");
  refuses("restore " + old, "--restricted allows no file outside of");
  refuses("scan --cabinet " + (folder / "job/cabinet.toml").string(), "no line to name a cabinet file");
  fs::create_symlink(folder / "made", folder / "job/link.bin");
  refuses("read 0x1000 --to " + (folder / "job/link.bin").string(), "--restricted allows no file outside of");
  fs::create_directory_symlink(folder, folder / "job/up");
  refuses("read 0x1000 --to " + (folder / "job/up/old.json").string(),
          "--restricted allows no file outside of");
  std::ofstream(folder / "secret.csv") << "name\nroot\n";
  EXPECT_EQ(run_text("for ROW in ../secret.csv\nread 0x1000\nend", {"--restricted"}), 8) << console.err_text;
  EXPECT_EQ(run_text("read 0x1000 --to " + (folder / "job/own.bin").string(), {"--restricted"}), 0)
      << console.err_text;
  EXPECT_EQ(run_text("diff factory node:1 --only changed", {"--restricted", "--check"}) & ~3, 0)
      << console.err_text;
}

TEST_F(RestrictedRun, TakesItsOwnYesForNone) {
  EXPECT_EQ(run_text("store --yes", {"--restricted"}), 8) << console.err_text;
  EXPECT_TRUE(told("confirmation needed")) << console.err_text;
  EXPECT_EQ(run_text("store --yes"), 0) << console.err_text;
}

}  // namespace
}  // namespace servoctl::cli
