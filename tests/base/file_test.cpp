// Files that are written, wherever their name leads.
#include "base/file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <string>

#include "base/regular_files.hpp"

namespace servoctl {
namespace {

namespace fs = std::filesystem;

class WrittenFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  static mode_t mode(const fs::path& path) {
    struct stat info {};
    return ::stat(path.c_str(), &info) == 0 ? info.st_mode & 07777U : 0;
  }
  /// A device like /dev/NAME; a node of our own where that is allowed, so that nobody's /dev is put at stake:
  /// who may make one may lose the other.
  fs::path device(const char* name, unsigned minor) const {
    const auto own = folder / name;
    return ::mknod(own.c_str(), S_IFCHR | 0666, makedev(1, minor)) == 0 ? own : fs::path("/dev") / name;
  }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder), {}); }

  // Tests run at the same time, each in a folder of its own.
  const fs::path folder =
      fs::temp_directory_path() / (std::string("servoctl-written-") + std::to_string(::getpid()) + "-" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(WrittenFile, IsMadeAsTheUmaskSays) {
  for (const mode_t umask : {0022U, 0077U, 0027U}) {
    const auto before = ::umask(umask);
    const auto path = folder / std::to_string(umask);
    EXPECT_TRUE(write_file_atomically(path, "x"));
    ::umask(before);
    EXPECT_EQ(mode(path), 0666U & ~umask);
  }
}

TEST_F(WrittenFile, KeepsItsModeWhenItIsReplaced) {
  const auto path = folder / "f";
  for (const mode_t wanted : {0600U, 0640U, 0755U, 0666U}) {
    std::ofstream(path) << "old";
    ASSERT_EQ(::chmod(path.c_str(), wanted), 0);
    ASSERT_TRUE(write_file_atomically(path, "new"));
    EXPECT_EQ(mode(path), wanted);
    EXPECT_EQ(read_file(path).value(), "new");
  }
}

TEST_F(WrittenFile, KeepsItsOwnerWhereThatIsAllowed) {
  const auto path = folder / "f";
  std::ofstream(path) << "old";
  if (::geteuid() != 0 || ::chown(path.c_str(), 1234, 2345) != 0)
    GTEST_SKIP() << "only root gives files away";
  ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
  ASSERT_TRUE(write_file_atomically(path, "new"));
  struct stat info {};
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_uid, 1234U);
  EXPECT_EQ(info.st_gid, 2345U);
  EXPECT_EQ(info.st_mode & 07777U, 0640U);
}

TEST_F(WrittenFile, BehindLinksIsReplacedAndTheLinksStay) {
  fs::create_directories(folder / "a");
  std::ofstream(folder / "a/target") << "old";
  fs::create_symlink("a/target", folder / "relative");
  fs::create_symlink(folder / "relative", folder / "twice");
  ASSERT_TRUE(write_file_atomically(folder / "twice", "new"));
  EXPECT_TRUE(fs::is_symlink(folder / "twice"));
  EXPECT_TRUE(fs::is_symlink(folder / "relative"));
  EXPECT_FALSE(fs::is_symlink(folder / "a/target"));
  EXPECT_EQ(read_file(folder / "a/target").value(), "new");
  EXPECT_EQ(files(), 3);
}

TEST_F(WrittenFile, BehindALinkThatLeadsNowhereIsMadeThere) {
  fs::create_symlink("target", folder / "link");
  ASSERT_TRUE(check_writable(folder / "link"));
  EXPECT_FALSE(fs::exists(folder / "target"));
  ASSERT_TRUE(write_file_atomically(folder / "link", "new"));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "target").value(), "new");
}

TEST_F(WrittenFile, BehindLinksInACircleIsRefused) {
  fs::create_symlink("b", folder / "a");
  fs::create_symlink("a", folder / "b");
  EXPECT_FALSE(check_writable(folder / "a"));
  EXPECT_FALSE(write_file_atomically(folder / "a", "x"));
  EXPECT_TRUE(fs::is_symlink(folder / "a"));
}

TEST_F(WrittenFile, OnAnotherFileSystemThanItsLinkIsReplacedThere) {
  const fs::path other = fs::path("/dev/shm") / folder.filename();
  if (::access("/dev/shm", W_OK) != 0) GTEST_SKIP() << "no second file system";
  std::ofstream(other) << "old";
  fs::create_symlink(other, folder / "link");
  EXPECT_TRUE(write_file_atomically(folder / "link", "new"));
  EXPECT_EQ(read_file(other).value(), "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  fs::remove(other);
}

TEST_F(WrittenFile, ThatIsADeviceIsWrittenToAndStaysOne) {
  const auto path = device("null", 3);
  const auto before = files();
  EXPECT_TRUE(check_writable(path));
  EXPECT_TRUE(write_file_atomically(path, "x"));
  EXPECT_TRUE(fs::is_character_file(path));
  EXPECT_EQ(files(), before);
}

TEST_F(WrittenFile, ThatIsAFullDeviceIsAnErrorThatSaysWhy) {
  const auto path = device("full", 7);
  const auto written = write_file_atomically(path, "x");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Errc::file);
  EXPECT_NE(written.error().message.text().find("No space left"), std::string::npos);
  EXPECT_NE(written.error().hint.text().find("make room"), std::string::npos);
  EXPECT_TRUE(fs::is_character_file(path));
}

TEST_F(WrittenFile, ThatIsAFifoIsWrittenToItsReader) {
  const auto path = folder / "fifo";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const int reader = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  EXPECT_TRUE(check_writable(path));
  EXPECT_TRUE(write_file_atomically(path, "samples"));
  std::array<char, 32> got{};
  EXPECT_EQ(::read(reader, got.data(), got.size()), 7);
  EXPECT_EQ(std::string(got.data()), "samples");
  EXPECT_TRUE(fs::is_fifo(path));
  ::close(reader);
}

TEST_F(WrittenFile, ThatIsADescriptorOfOursGoesThere) {
  const auto path = folder / "out";
  const int out = ::open(path.c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_EQ(::write(out, "before ", 7), 7);
  const auto name = "/dev/fd/" + std::to_string(out);
  EXPECT_TRUE(check_writable(name));
  EXPECT_TRUE(write_file_atomically(name, "after"));
  ::close(out);
  EXPECT_EQ(read_file(path).value(), "before after");
  EXPECT_EQ(files(), 1);
  EXPECT_FALSE(check_writable(name));
  EXPECT_FALSE(write_file_atomically(name, "x"));
}

TEST_F(WrittenFile, BeyondTheLimitOfFilesStaysAsItWas) {
  const auto path = folder / "f";
  ASSERT_TRUE(write_file_atomically(path, "old"));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto written = write_file_atomically(path, std::string(10000, 'x'));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.text().find("File too large"), std::string::npos);
  EXPECT_EQ(read_file(path).value(), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(WrittenFile, MayHaveTheLongestNameThereIs) {
  const auto path = folder / std::string(255, 'n');
  EXPECT_TRUE(check_writable(path));
  EXPECT_TRUE(write_file_atomically(path, "x"));
  EXPECT_EQ(files(), 1);
}

TEST_F(WrittenFile, ThatMayNotBeWrittenToIsRefusedThoughItsFolderWouldLetIt) {
  const auto path = folder / "f";
  std::ofstream(path) << "old";
  ASSERT_EQ(::chmod(path.c_str(), 0444), 0);
  if (::access(path.c_str(), W_OK) == 0) GTEST_SKIP() << "root may";
  EXPECT_FALSE(check_writable(path));
  EXPECT_FALSE(write_file_atomically(path, "new"));
  EXPECT_EQ(read_file(path).value(), "old");
}

TEST_F(WrittenFile, IsCheckedAsItWillBeWritten) {
  fs::create_directories(folder / "d");
  std::ofstream(folder / "f") << "old";
  for (const auto& path : {folder / "new", folder / "f", folder / "d", folder / "none/f", folder / "d/",
                           device("null", 3), fs::path("/proc/nothing"), folder / "f/in"}) {
    SCOPED_TRACE(path);
    const auto before = files();
    const bool could = check_writable(path).has_value();
    EXPECT_EQ(files(), before);
    EXPECT_EQ(write_file_atomically(path, "x").has_value(), could);
  }
}

TEST_F(WrittenFile, IsNeitherReadNorWaitedForWhereOnlyRegularFilesAre) {
  const auto fifo = folder / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const auto link = folder / "link";
  fs::create_symlink(fifo, link);
  const RegularFilesOnly regular;
  ::alarm(20);  // One that is opened without a writer is waited for without end.
  const auto begin = std::chrono::steady_clock::now();
  for (const auto& path : {fifo, link, fs::path("/dev/zero")}) {
    EXPECT_EQ(read_file(path).error().code, Errc::file) << path;
    EXPECT_EQ(write_file_atomically(path, "x").error().code, Errc::file) << path;
  }
  ::alarm(0);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  EXPECT_TRUE(fs::is_fifo(fifo));
}

TEST_F(WrittenFile, IsNotReadUnaskedWhenItIsHuge) {
  const auto path = folder / "huge";
  std::ofstream(path) << "x";
  fs::resize_file(path, std::uintmax_t{33} << 20U);
  EXPECT_TRUE(read_file(path));
  const RegularFilesOnly regular;
  EXPECT_EQ(read_file(path).error().code, Errc::file);
}

}  // namespace
}  // namespace servoctl
