// How lines end that leave a drive energised, on every kind of bus, when something goes wrong at that moment.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

class EnergisedEnd : public testing::Test {
 protected:
  void open(const std::string& bus, const std::string& family) {
    Shell::Options options;
    options.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = bus;
    options.defaults.drive = family;
    shell = std::make_unique<Shell>(console, options);
    shell->stay_open(true);
  }
  int run(std::string_view line) {
    console.out_text.clear();
    console.err_text.clear();
    return LineRunner(*shell).run(line);
  }
  std::string all() const { return console.out_text + console.err_text; }
  bool says(std::string_view what) const { return all().find(what) != std::string::npos; }

  RecordingConsole console;
  std::unique_ptr<Shell> shell;
};

/// What goes wrong after the drive was enabled, and what is said of it at the end.
struct Trouble {
  const char* name;
  const char* bus;
  const char* family;
  const char* says;
};

constexpr const char* kMayBe = "NODE 1 MAY STILL BE ENERGISED: SWITCH OFF THE SUPPLY";
constexpr const char* kInFault = "node 1: it had been enabled; it is de-energised now, but in fault";

constexpr Trouble kTroubles[] = {
    {"CanSilent", "sim:gsd600@1?silent=2s", "gsd600", kMayBe},
    {"CanAborts", "sim:gsd600@1?lie=no-stop", "gsd600", kMayBe},
    {"RingSilentMailbox", "coe:sim:sv2@1?lie=wkc,silent-mailbox,frozen-outputs&lie-after=100ms", "sv2",
     kMayBe},
    {"RingInFault", "coe:sim:sv2@1?lie=wkc,frozen-outputs&lie-after=100ms", "sv2", kInFault},
};

class EnergisedEndOfBus : public EnergisedEnd, public testing::WithParamInterface<Trouble> {};

TEST_P(EnergisedEndOfBus, ADriveThatCannotBeLetGoReachesTheExitCode) {
  const auto& trouble = GetParam();
  for (const int code : {0, 130, 5}) {
    open(trouble.bus, trouble.family);
    ASSERT_EQ(run("enable -n 1 --yes"), 0) << all();
    (void)run("watch statusword -n 1 --for 3s");
    shell->let_go();
    EXPECT_TRUE(says(trouble.says)) << all();
    EXPECT_FALSE(says("it has been stopped and disabled")) << all();
    const auto end = shell->close(code);
    EXPECT_TRUE(code == 5 ? end == 5 : end != 0 && end != 130) << code << " became " << end << all();
  }
}

INSTANTIATE_TEST_SUITE_P(Buses, EnergisedEndOfBus, testing::ValuesIn(kTroubles),
                         [](const auto& one) { return std::string(one.param.name); });

/// Over Modbus a parameter energises, and no 6040h: servoctl does not stop it, and says so.
TEST_F(EnergisedEnd, AParameterThatEnergisesOverModbusIsToldWhereItMayHaveBeenWritten) {
  constexpr const char* kTold =
      "nothing stops it when servoctl or the cable is gone: `param set Fn_38=0 -n 1`";
  open("modbus:sim:ts@1", "ts");
  EXPECT_EQ(run("param set Fn_38=1 -n 1 --yes"), 0) << all();
  EXPECT_TRUE(says(kTold)) << all();
  for (const auto* bus : {"modbus:sim:ts@1?lie=unconfirmed", "modbus:sim:ts@1?silent=1s"}) {
    SCOPED_TRACE(bus);
    open(bus, "ts");
    (void)run("watch Fn_33 -n 1 --for 2s");
    EXPECT_EQ(run("param set Fn_38=1 -n 1 --yes"), 4) << all();
  }
}

TEST_F(EnergisedEnd, WhatDoesNotEndItOverModbusReachesTheExitCode) {
  open("modbus:sim:ts@1?silent=2s", "ts");
  ASSERT_EQ(run("param set Fn_38=1 -n 1 --yes"), 0) << all();
  (void)run("watch Fn_33 -n 1 --for 3s");
  EXPECT_EQ(run("param set Fn_38=0 -n 1"), 4) << all();
}

}  // namespace
}  // namespace servoctl::cli
