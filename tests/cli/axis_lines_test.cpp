// Axes of a cabinet by name: which bus, node and family they stand for, and what is told of them.
#include "axis_lines.hpp"

namespace servoctl::cli {
namespace {

std::vector<std::string> offered_axes(std::string_view line, Shell& shell) {
  std::vector<std::string> out;
  for (const auto& one : complete(line, shell).candidates) out.push_back(one.word);
  return out;
}

TEST_F(AxisLines, ANameStandsForBusNodeAndFamily) {
  EXPECT_EQ(run("param get Pn0202 -n feeder2 --json"), 0) << all();
  EXPECT_TRUE(says(R"("axis":"feeder2","node":2)")) << all();
  EXPECT_TRUE(says(R"("bus":"sim:gsd600@1,gsd600@2,da200@3")")) << all();
  EXPECT_EQ(run("read statusword -n 送料"), 0) << all();
  EXPECT_TRUE(says("送料")) << all();
}

/// Of a batch file: each search asks for the file in every folder above.
TEST_F(AxisLines, ManyLinesSearchForTheirFileOnceAndAgainBehindOneThatMayHaveMadeIt) {
  const auto before = fs::current_path();
  const auto below = folder / "below";
  fs::create_directories(below);
  fs::rename(folder / "cabinet.toml", folder / "elsewhere.toml");
  fs::current_path(below);
  CabinetHolder holder;
  holder.search_once(true);
  EXPECT_EQ(holder.get({}).value(), nullptr);
  fs::rename(folder / "elsewhere.toml", folder / "cabinet.toml");
  EXPECT_EQ(holder.get({}).value(), nullptr);
  holder.search_again();
  const auto found = holder.get({});
  fs::current_path(before);
  ASSERT_TRUE(found) << found.error().message.text();
  ASSERT_NE(*found, nullptr);
  EXPECT_EQ((*found)->axes.size(), 4U);
}

TEST_F(AxisLines, TheFirstWordAfterACommandMayBeAnAxis) {
  EXPECT_EQ(run("param get feeder1,feeder2 Pn0202 --json"), 0) << all();
  EXPECT_TRUE(says(R"("axis":"feeder1")") && says(R"("axis":"feeder2")")) << all();
  EXPECT_EQ(run("param get -n1 feeder1 -b sim:gsd600@1"), 2) << all();  // A node is named already.
  EXPECT_EQ(run("read feeder9 statusword"), 2) << all();
}

TEST_F(AxisLines, AxesOfSeveralBusesAndFamiliesHaveOneAnswer) {
  EXPECT_EQ(run("read statusword -n all --json"), 0) << all();
  for (const auto* name : {"feeder1", "feeder2", "送料", "table"})
    EXPECT_TRUE(says(std::string("\"axis\":\"") + name + '"')) << name << all();
  EXPECT_EQ(run("read statusword --json -n all --retries 0 --timeout 50ms"), 0) << all();
  EXPECT_EQ(run("read Pn0202 -n feeder1,table"), 2) << all();  // The other family has no such number.
  EXPECT_TRUE(says("feeder1") && says("'Pn0202' is not an object or parameter of sv2")) << all();
}

TEST_F(AxisLines, SeveralBusesAreWorkedOnAtTheSameTime) {
  std::mutex mutex;
  std::set<std::thread::id> threads;
  Shell::Options options;
  options.drive_folders = {fs::path(source_dir()) / "eds"};
  options.clock = sim::SimBus::Clock::virtual_time;
  options.defaults.cabinet = folder / "cabinet.toml";
  // Asked for in every wait, by whoever waits.
  options.cancelled = [&] {
    const std::lock_guard lock(mutex);
    threads.insert(std::this_thread::get_id());
    return false;
  };
  shell = std::make_unique<Shell>(console, options);
  shell->stay_open(true);
  EXPECT_EQ(run("read 0x6041 -n all --json"), 0) << all();
  for (const auto* name : {"feeder1", "feeder2", "送料", "table"})
    EXPECT_TRUE(says(fmt::format(R"("axis":"{}")", name))) << all();
  EXPECT_GE(threads.size(), 2U) << "a thread for each bus";
  EXPECT_EQ(run("disable -n all"), 0) << all();
  EXPECT_EQ(run("write 0x6040 0x99999 -n all"), 2) << all();
  EXPECT_EQ(run("read 0x5FFF -n all"), 5) << all();
  threads.clear();
  (void)run("store -n feeder1,table");
  EXPECT_TRUE(says("confirmation needed")) << all();
  EXPECT_EQ(threads.count(std::this_thread::get_id()), threads.size()) << "what asks goes bus by bus";
}

TEST_F(AxisLines, WhatOneBusCannotDoIsDoneOnNone) {
  EXPECT_EQ(run("heartbeat set 100ms -n feeders,table"), 2) << all();
  EXPECT_TRUE(says("'heartbeat set' needs CAN, and table is not on CAN")) << all();
  EXPECT_TRUE(says("-n feeder1,feeder2")) << all();
  EXPECT_EQ(run("read 0x1017 -n feeder1 --json"), 0) << all();
  EXPECT_TRUE(says(R"("raw":0)")) << all();
  EXPECT_EQ(run("heartbeat show -n feeders,table"), 2) << all();
  EXPECT_TRUE(says("feeder1")) << "what only reads says what it can" << all();
}

TEST_F(AxisLines, WhatMovesOrGoesOnIsOfOneBusAndFamily) {
  EXPECT_EQ(run("watch statusword -n all --for 1s"), 2) << all();
  EXPECT_TRUE(says("for axes of one bus and one family at a time")) << all();
  EXPECT_EQ(run("enable -n feeder1,table --yes"), 2) << all();
  EXPECT_EQ(run("jog -n feeders 10mm/s --for 1s --yes"), 2) << all();
  EXPECT_TRUE(says("one motor at a time")) << all();
}

TEST_F(AxisLines, AMotionIsToldInTheUnitOfTheLoadAndMovesThatFar) {
  EXPECT_EQ(run("move feeder1 20mm --speed 50mm/s --yes"), 0) << all();
  EXPECT_TRUE(says("go by 3600 deg (20 mm), to 3600 deg (20 mm), at 1500 rpm (50 mm/s)")) << all();
  EXPECT_TRUE(says("position of the load")) << all();
  EXPECT_EQ(run("read 0x6064 -n feeder1 --json"), 0) << all();
  EXPECT_TRUE(says(R"("value":100000,)")) << all();                     // Ten revolutions of 10000.
  EXPECT_EQ(run("jog feeder1 101mm/s --for 100ms --yes"), 8) << all();  // Above the limit of the file.
  EXPECT_EQ(run("move 送料 20mm --yes"), 2) << all();                   // Nobody said what it moves.
}

TEST_F(AxisLines, ALineThatContradictsTheFileIsRefused) {
  EXPECT_EQ(run("status -n feeder1 -d da200"), 2) << all();
  EXPECT_TRUE(says("feeder1 is gsd600 by cabinet.toml, not da200")) << all();
  EXPECT_EQ(run("status -n feeder1 -b sim:gsd600@1"), 2) << all();
  EXPECT_EQ(run("status -n feeder1 -b main -d gsd600"), 0) << all();
  EXPECT_EQ(run("status -n feedr1"), 2) << all();
  EXPECT_TRUE(says("did you mean feeder1")) << all();
}

TEST_F(AxisLines, AnotherBusLetsNoDriveGo) {
  EXPECT_EQ(run("enable feeder1 --yes"), 0) << all();
  EXPECT_EQ(run("status table"), 0) << all();
  EXPECT_EQ(console.err_text, "");  // Nothing was let go.
  EXPECT_EQ(run("status feeder1 --json"), 0) << all();
  EXPECT_TRUE(says(R"("energised":true)")) << all();
  EXPECT_EQ(run("status -b sim:gsd600@1,gsd600@2,da200@3 -n 1 --json"), 0) << all();  // The same bus.
  EXPECT_TRUE(says(R"("energised":true)")) << all();
  EXPECT_EQ(run("status -b sim:dm@1 -n 1"), 0) << all();  // A bus of its own does, and says so by name.
  EXPECT_TRUE(says("feeder1")) << all();
}

TEST_F(AxisLines, APlanOfADriveInOpDoesNotListThePdosOfTheProcessData) {
  ASSERT_EQ(run("write 0x1C12:1 0x1702 -n table"), 0) << all();
  ASSERT_EQ(run("write 0x1C12:0 1 -n table"), 0) << all();
  EXPECT_EQ(run("cabinet plan --axis table"), 0) << all();
  EXPECT_TRUE(says("0x1C12")) << "in PRE-OP it is a setting like others: " << all();
  ASSERT_EQ(run("state op -n table"), 0) << all();
  EXPECT_EQ(run("cabinet plan --axis table"), 0) << all();
  EXPECT_FALSE(says("0x1C12")) << all();
  EXPECT_TRUE(says("table is in OP: its PDOs are those of the process data")) << all();
  EXPECT_EQ(run("state preop -n table"), 0) << all();
}

TEST_F(AxisLines, TheReportNamesTheAxis) {
  const auto page = folder / "report.html";
  EXPECT_EQ(run("report " + page.string() + " -n feeder2 --lang zh"), 0) << all();
  EXPECT_NE(content(page).find("feeder2（节点 2）"), std::string::npos);
}

TEST_F(AxisLines, OneReportIsOfAllBusesAndFamiliesInTheOrderOfTheFile) {
  const auto file = folder / "all.json";
  EXPECT_EQ(run("report " + file.string() + " -n all"), 0) << all();
  const auto report = report::parse_json(content(file), "all.json");
  ASSERT_TRUE(report);
  std::string axes;
  for (const auto& node : std::get<report::List>(report::find(*report, "nodes")->data()))
    axes += report::to_json(*report::find(node, "axis")) + report::to_json(*report::find(node, "family"));
  EXPECT_EQ(axes, R"("feeder1""gsd600""feeder2""gsd600""送料""da200""table""sv2")");
  EXPECT_EQ(std::get<report::List>(report::find(*report, "buses")->data()).size(), 2U);
  EXPECT_EQ(run("report " + (folder / "all.html").string() + " -n all"), 0) << all();
  const auto page = content(folder / "all.html");
  for (const auto* text : {"feeder1 (node 1)", "送料 (node 3)", "table (node 1)", "Bus ring (coe:sim:sv2@1)"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
}

TEST_F(AxisLines, OneFileIsNotReplacedByTheNextBusOrFamily) {
  const auto file = (folder / "one").string();
  for (const auto* line : {"backup {}.json -n all", "pdo save {}.toml -n feeder1,table",
                           "read 1000 --to {} -n feeder1,table", "test comm --junit {} -n feeder1,table"}) {
    SCOPED_TRACE(line);
    EXPECT_EQ(run(fmt::format(fmt::runtime(line), file)), 2) << all();
    EXPECT_TRUE(says("for axes of one bus and one family at a time; these are of ")) << all();
    for (const auto* ending : {"", ".json", ".toml"}) EXPECT_FALSE(fs::exists(file + ending)) << ending;
  }
  EXPECT_EQ(run("test comm --count 3 -n feeder1,table"), 0) << all();
}

TEST_F(AxisLines, AnAxisOfAFileThatTheLineNamesIsKnownByItsNameAlone) {
  std::ofstream(folder / "other.toml") << "[bus.main]\nurl = \"sim:gsd600@1\"\n[axis.hoist]\nnode = 1\n"
                                          "family = \"gsd600\"\n";
  for (const auto* form : {"status hoist --cabinet {}", "status hoist --cabinet={}"})
    EXPECT_EQ(run(fmt::format(fmt::runtime(form), (folder / "other.toml").string())), 0) << all();
}

TEST_F(AxisLines, AWrongFamilyIsCorrectedInTheFileThatSaysIt) {
  write("[bus.main]\nurl = \"sim:dm@1\"\n[axis.arm]\nnode = 1\nfamily = \"gsd600\"\n");
  EXPECT_EQ(run("param set Pn0214=45Hz -n arm"), 8) << all();
  EXPECT_TRUE(says("if the nameplate agrees, correct `family` in the cabinet file")) << all();
  EXPECT_FALSE(says("add -d dm")) << all();
}

TEST_F(AxisLines, AReportOfABusThatIsNotThereIsNotWritten) {
  write(
      "[bus.main]\nurl = \"sim:gsd600@1\"\n[bus.ring]\nurl = \"can99\"\n"
      "[axis.a]\nbus = \"main\"\nnode = 1\nfamily = \"gsd600\"\n"
      "[axis.b]\nbus = \"ring\"\nnode = 1\nfamily = \"sv2\"\n");
  EXPECT_NE(run("report " + (folder / "half.html").string() + " -n all"), 0) << all();
  EXPECT_FALSE(std::filesystem::exists(folder / "half.html"));
}

TEST_F(AxisLines, ATestBelongsToTheAxisItNamesWhereTwoBusesHaveTheNode) {
  EXPECT_EQ(run("test comm --count 3 -n table --json"), 0) << all();
  std::ofstream(folder / "tests.json") << console.out_text;
  const auto file = folder / "tested.json";
  EXPECT_EQ(run("report " + file.string() + " -n feeder1,table --tests " + (folder / "tests.json").string()),
            0)
      << all();
  const auto report = report::parse_json(content(file), "tested.json");
  ASSERT_TRUE(report);
  std::string reads;
  for (const auto& node : std::get<report::List>(report::find(*report, "nodes")->data())) {
    const auto& tests = std::get<report::List>(report::find(node, "tests")->data());
    ASSERT_EQ(tests.size(), 1U);
    reads += report::to_json(*report::find(tests.front(), "criteria")).find("in 3 reads") != std::string::npos
                 ? "earlier "
                 : "now ";
  }
  EXPECT_EQ(reads, "now earlier ");
  EXPECT_EQ(run("report " + file.string() + " --yes -n feeder1 --tests " + (folder / "tests.json").string()),
            0);
  EXPECT_TRUE(says("test comm of axis table is not in the report: add the axis to -n")) << all();
}

TEST_F(AxisLines, AReportSaysWhatTheFileWantsAndWhetherTheDriveHoldsIt) {
  write(
      "[bus.main]\nurl = \"sim:gsd600@1\"\n[axis.lift]\nnode = 1\nfamily = \"gsd600\"\nturn = 131072\n"
      "per_turn = \"20 mm\"\nlimits.speed = \"600rpm\"\nparameters.Pn0214 = \"45Hz\"\nparameters.Pn0202 = 32\n");
  EXPECT_EQ(run("param set Pn0202=32 -n lift"), 0) << all();
  const auto file = folder / "lift.json";
  EXPECT_EQ(run("report " + file.string() + " -n lift"), 0) << all();
  const auto text = content(file);
  for (const auto* part :
       {R"("load":"20 mm/rev","limits":{"speed":"600rpm",)", R"("different":1,"values":[)",
        R"("wanted":"450 = 45 Hz","present":"600 = 60 Hz","held":false})", R"("held":true})"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

TEST_F(AxisLines, CabinetCommandsHoldDrivesAgainstTheFileAndNothingElse) {
  EXPECT_EQ(run("cabinet plan --force-family"), 2) << all();
  EXPECT_TRUE(says("change its `family` there")) << all();
}

TEST_F(AxisLines, TheBusesOfTheFileAreNamesAndDefaults) {
  EXPECT_EQ(run("scan --json"), 0) << all();
  EXPECT_TRUE(says(R"("bus":"coe:sim:sv2@1","axis":"table")")) << all();
  EXPECT_EQ(run("read statusword -b ring -n 1 --json"), 0) << all();
  EXPECT_TRUE(says(R"("axis":"table")")) << all();
  EXPECT_EQ(run("read statusword -n 1"), 2) << all();
  EXPECT_TRUE(says("which bus? cabinet.toml has 2")) << all();
}

TEST_F(AxisLines, APlainNumberWritesAndMovesOnlyOnABusThatTheLineNames) {
  write("[bus.main]\nurl = \"sim:gsd600@1\"\n[axis.feeder]\nnode = 1\nfamily = \"gsd600\"\nturn = 10000\n");
  EXPECT_EQ(run("read statusword -n 1"), 0) << all();
  EXPECT_EQ(run("jog 60rpm --for 1s -n 1 --yes"), 2) << all();
  EXPECT_TRUE(says("which bus? 'jog' changes a drive") && says("--bus main (sim:gsd600@1")) << all();
  EXPECT_EQ(run("param set Pn0202=500 -n 1"), 2) << all();
  EXPECT_EQ(run("param set Pn0202=500 -n 1 -b main"), 0) << all();
  EXPECT_EQ(run("jog feeder 60rpm --for 200ms --yes"), 0) << all();
  EXPECT_EQ(run("enable -n all --yes"), 0) << all();
  EXPECT_EQ(run("disable feeder"), 0) << all();
  for (const auto* line : {"sync once --yes", "nmt start -n all --yes", "sim gsd600@9"}) {
    EXPECT_EQ(run(line), 2) << line << all();
    EXPECT_TRUE(says("which bus?")) << line << all();
  }
}

TEST_F(AxisLines, ErrorsAndHintsSpeakOfTheAxis) {
  write("[bus.main]\nurl = \"sim:gsd600@1\"\n[axis.lift]\nnode = 7\nfamily = \"gsd600\"\n");
  EXPECT_EQ(run("read statusword -n lift --timeout 50ms"), 4) << all();
  EXPECT_TRUE(says("error: lift, object 0x6041:0")) << all();
  EXPECT_FALSE(says("node 7")) << all();
}

TEST_F(AxisLines, AFileThatCannotBeUsedDisturbsOnlyLinesThatNeedIt) {
  write("[bus.main]\nurl = 5\n");
  EXPECT_EQ(run("read 0x6041 -b sim:dm@1 -n 1"), 0) << all();
  EXPECT_EQ(run("status -n feeder1"), 7) << all();
  EXPECT_TRUE(says("cabinet.toml:2:7: 'url' cannot be 5")) << all();
  write("[bus.main]\nurl = \"sim:ts@5\"\n[axis.lift]\nnode = 5\nfamily = \"ts\"\n");  // Read again.
  EXPECT_EQ(run("status -n lift"), 0) << all();
}

TEST_F(AxisLines, ThePromptTakesAnAxisForTheLinesThatFollow) {
  EXPECT_EQ(run("use feeder2"), 0) << all();
  EXPECT_EQ(run("param get Pn0202 --json"), 0) << all();
  EXPECT_TRUE(says(R"("axis":"feeder2")")) << all();
  EXPECT_EQ(run("use feeder8"), 2) << all();
  EXPECT_EQ(run("bus ring"), 0) << "a bus of the file by its name: " << all();
  EXPECT_EQ(run("read statusword -n 1 --json"), 0) << all();
  EXPECT_TRUE(says(R"("axis":"table")")) << all();
  EXPECT_EQ(run("bus nowhere"), 3) << all();
  EXPECT_EQ(run("use table"), 0) << all();
  EXPECT_EQ(run("status --json"), 0) << all();
  EXPECT_TRUE(says(R"("axis":"table")")) << all();
}

TEST_F(AxisLines, ABatchFileIsCheckedByTheFamiliesOfItsAxes) {
  const auto lines = [&](const std::string& text) {
    std::ofstream(folder / "lines.servoctl") << text;
    return run("run " + (folder / "lines.servoctl").string() + " --check");
  };
  EXPECT_EQ(lines("param set feeder1 Pn0202=500\nuse table\nread statusword\n"), 0) << all();
  EXPECT_EQ(lines("param set feeder1 Pn9999=500\n"), 2) << all();
  EXPECT_EQ(lines("param set table Pn0202=500\n"), 2) << all();  // Of another family.
  EXPECT_EQ(lines("status -n feedr1\n"), 2) << all();
}

TEST_F(AxisLines, AreOfferedWhereNodesAre) {
  const auto offered = offered_axes("status -n ", *shell);
  for (const auto* name : {"all", "feeder1", "feeders", "table", "送料"})
    EXPECT_NE(std::find(offered.begin(), offered.end(), name), offered.end()) << name;
  EXPECT_EQ(offered_axes("use ta", *shell), std::vector<std::string>{"table"});
}

}  // namespace
}  // namespace servoctl::cli
