// `scope` and `watch`: what is sampled, when, and what becomes of the drive.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "canopen/nmt.hpp"
#include "canopen/pdo.hpp"
#include "session/can_network.hpp"
#include "session/pdo_setup.hpp"
#include "tested_drive.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::commands {
using namespace command;
namespace {

using namespace std::chrono_literals;

class Sampling : public TestedDrive {
 protected:
  session::Values pdo_values() {
    const std::uint8_t node = 1;
    return session::read_pdo_values(*session, context.profile, std::span(&node, 1)).front().value();
  }
  /// Operational, with TPDO2 out of use.
  void start_node() {
    ASSERT_TRUE(session->wait([] { return false; }, session->now() + 1s));
    for (const auto& pdo : session::pdos_of(pdo_values()))
      if (pdo.direction == canopen::PdoDirection::transmit && pdo.number == 2 && pdo.is_valid()) {
        ASSERT_TRUE(session->download(1, {pdo.communication_index(), 1},
                                      store_le(pdo.cob_id | canopen::kPdoInvalid, 4)));
      }
    ASSERT_TRUE(session->can()->send(canopen::nmt_frame(canopen::NmtCommand::start, 1)));
    ASSERT_TRUE(session->wait([] { return false; }, session->now() + 50ms));
  }
  /// Objects a TPDO may carry, in the order of the dictionary.
  std::vector<std::string> mappable() const {
    std::vector<std::string> out;
    for (const auto& object : context.profile->dictionary.objects())
      for (const auto& entry : object.entries)
        if (object.index >= 0x6000 &&
            (entry.pdo == od::PdoMapping::tpdo || entry.pdo == od::PdoMapping::both))
          out.push_back(to_string(entry.address));
    return out;
  }
  bool is_noticed(std::string_view text) const {
    return std::any_of(context.notices.begin(), context.notices.end(),
                       [&](const Message& notice) { return notice.text().find(text) != std::string::npos; });
  }
  std::vector<std::string> csv_lines(const std::string& path) const {
    std::ifstream file(path);
    std::vector<std::string> out;
    for (std::string line; std::getline(file, line);) out.push_back(line);
    return out;
  }
};

class SamplingEveryFamily : public Sampling, public testing::WithParamInterface<const char*> {};

TEST_P(SamplingEveryFamily, MappingIsPutBackHoweverManyObjectsThereAre) {
  build(std::string(GetParam()) + "@1", GetParam());
  start_node();
  const auto before = pdo_values();
  const auto objects = mappable();
  ASSERT_FALSE(objects.empty());
  std::size_t mapped = 0;
  for (std::size_t n = 1; n <= std::min<std::size_t>(objects.size(), 10); ++n) {
    Words words{{"--map", "true"}, {"--for", "20ms"}, {"--every", "2ms"}};
    for (std::size_t i = 0; i < n; ++i) words.emplace_back("object", objects[i]);
    context.notices.clear();
    (void)run("scope", words);
    mapped += !is_noticed("not mapped");
    EXPECT_TRUE(context.errors.empty()) << n << ": " << context.errors.front().message.text();
    EXPECT_EQ(pdo_values(), before) << n << " objects";
    EXPECT_EQ(drive().nmt_state(), canopen::NmtState::operational);
  }
  const auto pdos = session::pdos_of(before);
  const bool spare = std::any_of(pdos.begin(), pdos.end(), [](const canopen::Pdo& pdo) {
    return pdo.direction == canopen::PdoDirection::transmit && !pdo.is_valid() && pdo.event;
  });
  EXPECT_EQ(mapped > 0, spare) << testing::PrintToString(context.notices);
}

TEST_F(Sampling, MappingAsksAndIsNotDoneWithoutAYes) {
  build("gsd600@1", "gsd600");
  start_node();
  show::Unwilling unwilling;
  context.audience = &unwilling;
  const auto before = pdo_values();
  const auto result = run("scope", {{"object", "0x6064"}, {"--map", "true"}});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::refused);
  EXPECT_EQ(pdo_values(), before);
}

TEST_F(Sampling, AnEnergisedDriveOfAnUnknownFamilyIsLeftAlone) {
  build("da200@1", "da200");
  start_node();
  for (const unsigned word : {0x06U, 0x07U, 0x0FU}) {
    ASSERT_TRUE(session->download(1, {0x6040, 0}, store_le(word, 2)));
    ASSERT_TRUE(session->wait([] { return false; }, session->now() + 200ms));
  }
  ASSERT_EQ(drive().power_state(), drive::DriveState::operation_enabled);
  const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
  const auto generic = drive::load_profile("cia402", folders).value();
  const auto* family = std::exchange(context.profile, &generic);
  ASSERT_TRUE(run("scope", {{"object", "0x6064"}, {"--map", "true"}, {"--for", "20ms"}}));
  EXPECT_TRUE(is_noticed("read by SDO, not mapped: node 1: it is energised"));
  EXPECT_FALSE(is_noticed("node 1: read")) << "the node is named once";
  EXPECT_EQ(drive().power_state(), drive::DriveState::operation_enabled);
  EXPECT_EQ(drive().nmt_state(), canopen::NmtState::operational);
  context.profile = family;
}

TEST_F(Sampling, WhatCouldNotBePutBackIsAnError) {
  build("gsd600@1", "gsd600");
  start_node();
  // Silent from the middle of the sampling on.
  const auto end = session->now() + 60ms;
  bus->on_receive = [&](can::Frame&) { drive().wire_faults().silent |= session->now() > end; };
  (void)run("scope", {{"object", "0x6064"}, {"--map", "true"}, {"--for", "100ms"}});
  const bool told = std::any_of(context.errors.begin(), context.errors.end(), [](const Error& error) {
    return error.message.text().find("TPDO2 could not be restored: node 1") == 0 &&
           error.message.text().find("0x1A01:1") != std::string::npos;
  });
  EXPECT_TRUE(told);
}

/// The rows of a table of the result; empty where it is not shown to people.
std::vector<std::string> shown_labels(const report::Record& result) {
  std::vector<std::string> out;
  for (const auto& field : result)
    if (const auto* table = field.value.table(); table != nullptr && field.key == "words")
      for (const auto& row : table->rows) out.push_back(*std::get_if<std::string>(&row.back().data()));
  return out;
}

TEST_F(Sampling, BitFieldsAreToldInWordsAndNotPlotted) {
  build("gsd600@1", "gsd600");
  start_node();
  const std::vector<std::string> expected{"switch on disabled (voltage enabled, remote)",
                                          "no limit, no home switch"};
  for (const auto* command : {"scope", "watch"}) {
    const auto result = run(command, {{"object", "0x6041"},
                                      {"object", "0x60FD"},
                                      {"object", "0x606C"},
                                      {"--for", "50ms"},
                                      {"--plot", "true"}});
    ASSERT_TRUE(result) << command;
    const auto& record = *std::get_if<report::Record>(&result->data());
    EXPECT_EQ(shown_labels(record), expected) << command;
    for (const auto& field : record) {
      const auto* plot = field.value.plot();
      if (plot == nullptr || field.show == report::Show::json) continue;
      ASSERT_EQ(plot->series.size(), 1U) << command;
      EXPECT_EQ(plot->series.front().name, "Velocity actual value") << command;
    }
  }
  const auto refused = run("scope", {{"object", "0x6041"}, {"--svg", own_file("words.svg")}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::usage);
}

TEST_F(Sampling, EachValueHasTheTimeOfItsOwnFrame) {
  build("gsd600@1,gsd600@2", "gsd600");
  context.nodes = {1, 2};
  start_node();
  // Their TPDOs come once a second, 300 ms apart.
  ASSERT_TRUE(session->wait([] { return false; }, session->now() + 250ms));
  ASSERT_TRUE(session->can()->send(canopen::nmt_frame(canopen::NmtCommand::start, 2)));
  std::vector<double> seen;
  bus->on_receive = [&](can::Frame& frame) {
    if (frame.id == 0x181 || frame.id == 0x182)
      seen.push_back(std::chrono::duration<double>(session->now().time_since_epoch()).count());
  };
  const auto path = own_file("sampling_test.csv");
  ASSERT_TRUE(run("scope", {{"object", "0x6041"}, {"--for", "2500ms"}, {"--csv", path}}));
  ASSERT_GE(seen.size(), 4U);
  const auto table = csv_lines(path);
  std::vector<double> times;
  for (std::size_t i = 1; i < table.size(); ++i) {
    times.push_back(std::stod(table[i]));
    const auto comma = table[i].find(',');
    EXPECT_NE(table[i][comma + 1] == ',', table[i].back() == ',') << "a value of one node: " << table[i];
  }
  const auto sampled = [&](double from, double later) {
    return std::any_of(times.begin(), times.end(),
                       [&](double time) { return std::abs(time - from - later) < 2e-6; });
  };
  for (std::size_t i = 1; i < seen.size(); ++i)
    EXPECT_TRUE(std::any_of(times.begin(), times.end(),
                            [&](double time) { return sampled(time, seen[i] - seen[i - 1]); }))
        << "frames " << seen[i] - seen[i - 1] << " s apart";
}

/// TPDO1 carries the torque where it leaves the factory with the statusword, of the same length.
class SamplingAfterARestart : public Sampling {
 protected:
  void build_mapped() {
    build("gsd600@1", "gsd600");
    start_node();
    const auto write = [&](ObjectAddress object, std::uint64_t value, std::size_t size) {
      ASSERT_TRUE(session->download(1, object, store_le(value, size))) << to_string(object);
    };
    write({0x1800, 1}, 0xC000'0181, 4);
    write({0x1A00, 0}, 0, 1);
    write({0x1A00, 1}, 0x6077'0010, 4);
    write({0x1A00, 0}, 1, 1);
    write({0x1800, 2}, 255, 1);
    write({0x1800, 3}, 0, 2);
    write({0x1800, 5}, 20, 2);
    write({0x1800, 1}, 0x4000'0181, 4);
  }
  /// Another master resets the node after a second, and starts it after two.
  void reset_and_start() {
    bus->on_receive = [this, begin = session->now(), done = 0](can::Frame&) mutable {
      if (done < 1 && session->now() > begin + 1s) {
        done = 1;
        (void)sim_bus.send(canopen::nmt_frame(canopen::NmtCommand::reset_node, 1));
      }
      if (done < 2 && session->now() > begin + 2s) {
        done = 2;
        (void)sim_bus.send(canopen::nmt_frame(canopen::NmtCommand::start, 1));
      }
    };
  }
  static std::string json_of(const Result<report::Value>& result) {
    return result ? report::to_json(*result) : result.error().message.text();
  }
};

TEST_F(SamplingAfterARestart, WatchNeverTakesTheStatuswordForTheTorque) {
  build_mapped();
  reset_and_start();
  const auto json = json_of(run("watch", {{"object", "0x6077"}, {"--for", "5s"}, {"--every", "50ms"}}));
  EXPECT_NE(json.find("\"max\":0,"), std::string::npos) << json.substr(0, 400);
  EXPECT_NE(json.find("\"by\":\"pdo\""), std::string::npos);
  EXPECT_NE(json.find("\"by\":\"sdo\""), std::string::npos);
  EXPECT_TRUE(is_noticed("node 1 has restarted: its values are read by SDO"));
}

TEST_F(SamplingAfterARestart, ScopeNeverTakesTheStatuswordForTheTorque) {
  build_mapped();
  reset_and_start();
  const auto json = json_of(run("scope", {{"object", "0x6077"}, {"--for", "5s"}}));
  EXPECT_NE(json.find("\"max\":0,"), std::string::npos) << json.substr(0, 400);
  EXPECT_TRUE(is_noticed("node 1 has restarted"));
}

TEST_F(SamplingAfterARestart, TheMappingIsReadAgainAndUsed) {
  build_mapped();
  reset_and_start();
  const auto json = json_of(run("watch", {{"object", "0x6041"}, {"--for", "8s"}, {"--every", "100ms"}}));
  EXPECT_LT(json.find("\"by\":\"sdo\""), json.rfind("\"by\":\"pdo\"")) << "the factory's TPDO1 carries it";
}

TEST_F(SamplingAfterARestart, PdoWatchShowsNoValuesUntilTheMappingWasReadAgain) {
  build_mapped();
  reset_and_start();
  const auto json = json_of(run("pdo watch", {{"pdo", "TPDO1"}, {"--for", "8s"}}));
  EXPECT_TRUE(is_noticed("node 1 has restarted: its PDOs are shown without values"));
  EXPECT_TRUE(is_noticed("node 1: its PDO mapping was read again"));
  EXPECT_NE(json.find("Torque"), std::string::npos);
  EXPECT_NE(json.find("Statusword"), std::string::npos) << "of the mapping that it has now";
  for (auto at = json.find("\"index\":24695"); at != std::string::npos;
       at = json.find("\"index\":24695", at + 1))
    EXPECT_NE(json.substr(at, 200).find("\"raw\":0,"), std::string::npos) << json.substr(at, 200);
}

TEST_F(SamplingAfterARestart, MonitorSaysFactoryMappingAndReadsItAgainWhereItAsked) {
  build_mapped();
  reset_and_start();
  const auto json = json_of(run("monitor", {{"--ask", "true"}, {"--for", "8s"}}));
  EXPECT_TRUE(is_noticed("node 1: its PDO mapping was read again"));
  // TPDO1 with the torque before the restart; with the statusword, never the torque, afterwards.
  const auto restart = json.find("\"service\":\"boot-up\",\"node\"");
  ASSERT_NE(restart, std::string::npos);
  EXPECT_NE(json.substr(0, restart).find("\"index\":24695"), std::string::npos);
  EXPECT_EQ(json.substr(restart).find("\"index\":24695,\"sub\":0,\"name\":\"Torque actual value\",\"value\""),
            std::string::npos);
}

TEST_F(Sampling, ADriveThatIsGoneAtTheEndMakesTheExitCode) {
  build("gsd600@1", "gsd600");
  for (const auto* command : {"scope", "watch"}) {
    drive().wire_faults().silent = false;
    const auto gone = session->now() + 50ms;
    bus->on_receive = [&](can::Frame&) { drive().wire_faults().silent |= session->now() > gone; };
    ASSERT_TRUE(run(command, {{"object", "0x6041"}, {"--for", "1s"}})) << command;
    ASSERT_FALSE(context.errors.empty()) << command;
    EXPECT_EQ(context.errors.front().code, Errc::timeout);
    EXPECT_EQ(context.errors.front().node, 1);
    EXPECT_EQ(context.errors.front().object, (ObjectAddress{0x6041, 0}));
  }
}

TEST_F(Sampling, AGapInTheMiddleIsNoError) {
  build("gsd600@1", "gsd600");
  session->options().timeout = 20ms;
  bool dropped = false;
  bus->on_receive = [&, at = session->now() + 50ms](can::Frame&) {
    if (session->now() > at && !std::exchange(dropped, true)) drive().wire_faults().drop_answers = 3;
  };
  ASSERT_TRUE(run("watch", {{"object", "0x6041"}, {"--for", "1s"}, {"--every", "20ms"}}));
  EXPECT_TRUE(dropped);
  EXPECT_TRUE(context.errors.empty());
}

TEST_F(Sampling, WhatIsNoNumberIsRefusedBeforeAnythingIsMapped) {
  build("gsd600@1", "gsd600");
  start_node();
  const auto path = own_file("none.svg");
  std::filesystem::remove(path);
  const auto result =
      run("scope", {{"object", "0x6041"}, {"object", "0x1008"}, {"--map", "true"}, {"--svg", path}});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::usage);
  EXPECT_TRUE(questions.empty());
  EXPECT_FALSE(std::filesystem::exists(path));
}

INSTANTIATE_TEST_SUITE_P(Families, SamplingEveryFamily,
                         testing::Values("gsd600", "dm", "sv2", "da200", "ts"));

}  // namespace
}  // namespace servoctl::commands
