// A scan that was interrupted goes on for the same drive alone.
#include "settings/learning.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "learning_world.hpp"
#include "settings/scan_file.hpp"

namespace servoctl::settings {
namespace {

class ResumedScanTest : public LearningWorld {};

TEST_F(ResumedScanTest, AnInterruptedScanGoesOnWhereItStopped) {
  learned();
  const auto whole = content_of(file);
  const auto requests = node->requests;
  std::filesystem::remove(file);
  for (const std::size_t share : {4U, 2U}) {
    begin_anew();
    node->dies_after = requests / share;
    const auto ended = learn();
    ASSERT_FALSE(ended);
    EXPECT_EQ(ended.error().code, Errc::timeout) << ended.error().message.text();
    EXPECT_TRUE(std::filesystem::exists(scan_file(file)));
    EXPECT_FALSE(std::filesystem::exists(file));
    ASSERT_FALSE(desk.notices.empty());
    EXPECT_NE(desk.notices.back().text().find("goes on from there"), std::string::npos);
  }
  begin_anew();
  learned();
  EXPECT_EQ(content_of(file), whole);
  EXPECT_LT(node->requests, requests / 2);
}

TEST_F(ResumedScanTest, TheScanOfAnotherDriveIsNotContinued) {
  const auto refuses = [&](const LearnOptions& options = {}) {
    const auto other = learn(options);
    return !other && other.error().code == Errc::refused;
  };
  for (const ObjectAddress object : {ObjectAddress{0x1018, 4}, ObjectAddress{0x1018, 3}}) {
    begin_anew();
    node->dies_after = 5000;
    ASSERT_FALSE(learn());
    begin_anew();
    node->objects.values[object] = {9, 9, 9, 9};
    EXPECT_TRUE(refuses()) << to_string(object);
    std::filesystem::remove(scan_file(file));
  }
  node->dies_after = 5000;
  begin_anew();
  node->dies_after = 5000;
  ASSERT_FALSE(learn());
  begin_anew();
  EXPECT_TRUE(refuses({.ranges = {{0x2000, 0x2010}}}));
  std::filesystem::remove(scan_file(file));
  node->dies_after = node->requests + 2000;
  ASSERT_FALSE(learn({.ranges = {{0x2000, 0x2F00}}}));
  begin_anew();
  EXPECT_TRUE(refuses()) << "the ranges of no --range are others";
  std::ofstream(scan_file(file)) << "a file of somebody\n";
  EXPECT_TRUE(refuses());
  EXPECT_EQ(content_of(scan_file(file)), "a file of somebody\n");
}

TEST_F(ResumedScanTest, AScanThatWasCutOrHasNoSerialNumberBeginsAnew) {
  for (const bool has_serial : {true, false}) {
    begin_anew();
    if (!has_serial) node->objects.values[{0x1018, 4}] = {0, 0, 0, 0};
    node->dies_after = 5000;
    ASSERT_FALSE(learn());
    auto text = content_of(scan_file(file));
    if (has_serial) std::ofstream(scan_file(file)) << text.substr(0, text.size() / 2);
    begin_anew();
    if (!has_serial) node->objects.values[{0x1018, 4}] = {0, 0, 0, 0};
    ASSERT_TRUE(learn());
    EXPECT_NE(desk.notices.front().text().find("starts again"), std::string::npos)
        << desk.notices.front().text();
    std::filesystem::remove(file);
  }
}

}  // namespace
}  // namespace servoctl::settings
