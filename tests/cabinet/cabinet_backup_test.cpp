// Backups of a whole cabinet, and what differs between two cabinets.
#include "cabinet/cabinet_backup.hpp"

#include <gtest/gtest.h>

#include "base/file.hpp"
#include "cabinet/cabinet_diff.hpp"
#include "fleet.hpp"

namespace servoctl::cabinet {
namespace {

constexpr std::string_view kTwoAxes = R"(
[bus.main]
url = "can0"
[axis.feeder]
node = 1
family = "gsd600"
[axis.feeder.parameters]
Pn0214 = "45Hz"
[axis.lift]
node = 2
family = "gsd600"
heartbeat = "500ms"
)";

Result<const drive::Profile*> load(const std::string& family) { return &family_of(family); }

class Saved {
 public:
  Saved() : fleet(5) {
    EXPECT_TRUE(write_file_atomically(fleet.cabinet.file, kTwoAxes));
    EXPECT_TRUE(fleet.apply());
  }
  Result<report::Value> save() {
    fleet.desk.errors.clear();
    return back_up_cabinet(fleet.desk, fleet.cabinet, fleet.stations(), {});
  }
  std::vector<fs::path> folders() const {
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(fleet.folder()))
      if (entry.is_directory()) out.push_back(entry.path());
    std::sort(out.begin(), out.end());
    return out;
  }
  /// Names of what differs.
  std::vector<std::string> compare(const fs::path& a, const fs::path& b) {
    fleet.desk.errors.clear();
    const auto answer = compare_cabinets(fleet.desk, a, b, load);
    EXPECT_TRUE(answer) << answer.error().message.text();
    std::vector<std::string> out;
    if (!answer) return out;
    const auto* table = report::find(*answer, "differences")->table();
    for (const auto& row : table->rows)
      out.push_back(std::get<std::string>(row[0].data()) + " " + std::get<std::string>(row[2].data()));
    EXPECT_EQ(out.empty(), fleet.desk.errors.empty());
    return out;
  }
  Fleet fleet;
};

TEST(CabinetBackup, IsAFolderWithAllAxesAndTheFile) {
  Saved saved;
  const auto answer = saved.save();
  ASSERT_TRUE(answer) << answer.error().message.text();
  ASSERT_TRUE(saved.save());
  const auto folders = saved.folders();
  ASSERT_EQ(folders.size(), 2U) << "two in one second";
  EXPECT_TRUE(folders[0].filename().string().starts_with("backup-20"));
  EXPECT_EQ(*read_file(folders[0] / "cabinet.toml"), kTwoAxes);
  for (std::size_t i = 0; i < saved.fleet.size(); ++i) {
    const auto backup = settings::read_backup(folders[0] / fmt::format("axis{}.json", i + 1));
    ASSERT_TRUE(backup) << backup.error().message.text();
    EXPECT_EQ(backup->family, saved.fleet.cabinet.axes[i].family);
    EXPECT_GT(backup->entries.size(), 20U);
  }
}

TEST(CabinetBackup, LeavesOutAnAxisThatDoesNotAnswerAndSaysSo) {
  Saved saved;
  saved.fleet.drive(2).wire_faults().silent = true;
  ASSERT_TRUE(saved.save());
  ASSERT_EQ(saved.fleet.desk.errors.size(), 1U);
  EXPECT_NE(saved.fleet.desk.errors[0].message.text().find("axis3"), std::string::npos);
  ASSERT_EQ(saved.folders().size(), 1U);
  EXPECT_FALSE(fs::exists(saved.folders()[0] / "axis3.json"));
  EXPECT_TRUE(fs::exists(saved.folders()[0] / "axis4.json"));
  for (std::size_t i = 0; i < saved.fleet.size(); ++i) saved.fleet.drive(i).wire_faults().silent = true;
  EXPECT_FALSE(saved.save());
  EXPECT_EQ(saved.folders().size(), 1U) << "nothing half-written stays";
}

TEST(CabinetDiff, NamesWhatDiffersBetweenTwoBackups) {
  Saved saved;
  ASSERT_TRUE(saved.save());
  ASSERT_TRUE(saved.fleet.session(2).download(3, {0x2001, 15}, store_le(451, 2)));
  ASSERT_TRUE(saved.save());
  const auto folders = saved.folders();
  EXPECT_TRUE(saved.compare(folders[0], folders[0]).empty());
  EXPECT_EQ(saved.compare(folders[0], folders[1]),
            (std::vector<std::string>{"axis3 Pn0214 Speed loop gain 1"}));
  fs::remove(folders[1] / "axis5.json");
  EXPECT_EQ(saved.compare(folders[0], folders[1]),
            (std::vector<std::string>{"axis3 Pn0214 Speed loop gain 1", "axis5 axis"}));
}

TEST(CabinetDiff, NamesWhatDiffersBetweenTwoFilesHoweverItIsWritten) {
  Saved saved;
  const auto other = saved.fleet.folder() / "other.toml";
  std::string text(kTwoAxes);
  text.replace(text.find("Pn0214 = \"45Hz\""), 15, "\"0x2001:F\" = 450");
  ASSERT_TRUE(write_file_atomically(other, text));
  EXPECT_TRUE(saved.compare(saved.fleet.cabinet.file, other).empty());
  text.replace(text.find("= 450"), 5, "= 451");
  text.replace(text.find("500ms"), 5, "250ms");
  ASSERT_TRUE(write_file_atomically(other, text));
  EXPECT_EQ(saved.compare(saved.fleet.cabinet.file, other),
            (std::vector<std::string>{"feeder Pn0214 Speed loop gain 1", "lift heartbeat"}));
  EXPECT_FALSE(compare_cabinets(saved.fleet.desk, saved.fleet.folder() / "none.toml", other, load));
  const auto empty = saved.fleet.folder() / "empty";
  fs::create_directory(empty);
  const auto none = compare_cabinets(saved.fleet.desk, empty, other, load);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message.text(), empty.string() + " contains no backup");
}

TEST(CabinetDiff, HoldsAFileAgainstABackup) {
  Saved saved;
  ASSERT_TRUE(saved.save());
  const auto folder = saved.folders()[0];
  const auto file = saved.fleet.folder() / "axes.toml";
  const auto write = [&](std::string_view value) {
    std::string text = "[bus.main]\nurl = \"can0\"\n";
    const char* const families[] = {"da200", "dm", "gsd600", "sv2", "ts"};
    for (int i = 1; i <= 5; ++i)
      text += fmt::format("[axis.axis{}]\nnode = {}\nfamily = \"{}\"\n", i, i, families[i - 1]);
    text += fmt::format("pdos = \"pp\"\nheartbeat = \"500ms\"\n[axis.axis5.parameters]\nFn_33 = {}\n", value);
    ASSERT_TRUE(write_file_atomically(file, text));
  };
  write("120");
  auto names = saved.compare(file, folder);
  EXPECT_EQ(
      std::count_if(names.begin(), names.end(), [](const auto& n) { return n.starts_with("axis5 Fn_33"); }),
      0);
  EXPECT_FALSE(names.empty()) << "PDOs as the preset says";
  write("121");
  const auto more = saved.compare(folder, file);
  EXPECT_EQ(more.size(), names.size() + 1);
}

}  // namespace
}  // namespace servoctl::cabinet
