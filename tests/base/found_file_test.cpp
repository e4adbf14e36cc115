// Files that nobody named: whose they are, and who else may write them.
#include "base/found_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "base/file.hpp"

namespace servoctl {
namespace {

namespace fs = std::filesystem;

constexpr uid_t kOther = 65534;  ///< nobody
constexpr std::string_view kWay = "name it";

class FoundFile : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder);
    ::chmod(folder.c_str(), 0755);
    write(file, "mine");
  }
  void TearDown() override {
    fs::remove_all(folder);
    ::unsetenv("SUDO_UID");
  }

  static void write(const fs::path& path, std::string_view text) {
    std::ofstream(path) << text;
    ::chmod(path.c_str(), 0644);
  }
  static std::string text_of(const fs::path& path) {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static bool refused(const Result<void>& result) { return !result && result.error().code == Errc::refused; }
  static bool gives_away() { return ::geteuid() == 0; }
  static void give(const fs::path& path) { ASSERT_EQ(::lchown(path.c_str(), kOther, kOther), 0); }

  const fs::path folder =
      fs::temp_directory_path() / (std::string("servoctl-found-") + std::to_string(::getpid()) + "-" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
  const fs::path file = folder / "cabinet.toml";
};

TEST_F(FoundFile, OfThisUserIsTrusted) { EXPECT_TRUE(check_found_file(file, kWay)); }

TEST_F(FoundFile, OfAnotherUserIsRefusedWithTheWayToTrustIt) {
  if (!gives_away()) GTEST_SKIP() << "only root can give a file away";
  give(file);
  const auto checked = check_found_file(file, kWay);
  ASSERT_TRUE(refused(checked));
  EXPECT_EQ(checked.error().hint.text(), kWay);
  EXPECT_NE(checked.error().message.text().find("belongs to"), std::string::npos)
      << checked.error().message.text();
  EXPECT_TRUE(check_found_file(file, kWay, kOther)) << "the owner of the program";
}

TEST_F(FoundFile, OfWhoCalledSudoIsTrusted) {
  if (!gives_away()) GTEST_SKIP() << "only root can give a file away";
  give(file);
  ::setenv("SUDO_UID", "65534", 1);
  EXPECT_TRUE(check_found_file(file, kWay));
  ::setenv("SUDO_UID", "65533", 1);
  EXPECT_TRUE(refused(check_found_file(file, kWay)));
}

TEST_F(FoundFile, ThatEverybodyMayWriteIsRefused) {
  ::chmod(file.c_str(), 0646);
  EXPECT_TRUE(refused(check_found_file(file, kWay)));
  ::chmod(file.c_str(), 0644);
  ::chmod(folder.c_str(), 0777);
  EXPECT_TRUE(refused(check_found_file(file, kWay))) << "in a folder in which everybody may replace it";
  ::chmod(folder.c_str(), 01777);
  EXPECT_TRUE(check_found_file(file, kWay)) << "the sticky bit keeps it";
}

TEST_F(FoundFile, ThatAGroupMayWriteIsRefusedUnlessTheGroupIsPrivate) {
  if (!gives_away()) GTEST_SKIP() << "only root can give a file to a group";
  ::chmod(file.c_str(), 0664);
  EXPECT_TRUE(check_found_file(file, kWay)) << "the private group of root";
  ASSERT_EQ(::chown(file.c_str(), 0, 100), 0);
  EXPECT_TRUE(refused(check_found_file(file, kWay))) << "a group that others are in";
}

TEST_F(FoundFile, BehindALinkOfAnotherUserIsRefused) {
  if (!gives_away()) GTEST_SKIP() << "only root can give a link away";
  const auto link = folder / "link.toml";
  fs::create_symlink(file, link);
  EXPECT_TRUE(check_found_file(link, kWay));
  give(link);
  EXPECT_TRUE(refused(check_found_file(link, kWay)));
}

TEST_F(FoundFile, FolderForStateBelongsToThisUserAloneAlsoUnderSudo) {
  EXPECT_TRUE(check_own_folder(folder));
  ::chmod(folder.c_str(), 0777);
  EXPECT_TRUE(refused(check_own_folder(folder)));
  ::chmod(folder.c_str(), 01777);
  EXPECT_TRUE(refused(check_own_folder(folder))) << "others may put links into it";
  if (!gives_away()) return;
  ::chmod(folder.c_str(), 0755);
  ::setenv("SUDO_UID", "65534", 1);
  give(folder);
  EXPECT_TRUE(refused(check_own_folder(folder)));
}

TEST_F(FoundFile, OwnFileIsNotWrittenThroughALinkToAnotherUsersFile) {
  if (!gives_away()) GTEST_SKIP() << "only root can give a file away";
  give(file);
  const auto history = folder / "history";
  fs::create_symlink(file, history);
  EXPECT_TRUE(refused(write_own_file(history, "lines"))) << "a link of ours to a file of another";
  EXPECT_EQ(text_of(file), "mine");
  fs::remove(history);
  write(folder / "target", "root's");
  fs::create_symlink(folder / "target", history);
  give(history);
  EXPECT_TRUE(refused(write_own_file(history, "lines"))) << "a link of another to a file of ours";
  EXPECT_EQ(text_of(folder / "target"), "root's");
  fs::remove(history);
  EXPECT_TRUE(write_own_file(history, "lines"));
  EXPECT_TRUE(write_own_file(history, "more"));
  EXPECT_EQ(text_of(history), "more");
}

TEST_F(FoundFile, NoFileIsWrittenThroughALinkOfAnotherUser) {
  if (!gives_away()) GTEST_SKIP() << "only root can give a link away";
  const auto link = folder / "out.csv";
  fs::create_symlink(file, link);
  EXPECT_TRUE(write_file_atomically(link, "by my link"));
  EXPECT_EQ(text_of(file), "by my link");
  give(link);
  EXPECT_TRUE(refused(write_file_atomically(link, "by their link")));
  EXPECT_EQ(text_of(file), "by my link");
  const auto nowhere = folder / "new.csv";
  fs::create_symlink(folder / "made", nowhere);
  give(nowhere);
  EXPECT_TRUE(refused(write_file_atomically(nowhere, "x")));
  EXPECT_FALSE(fs::exists(folder / "made"));
}

}  // namespace
}  // namespace servoctl
