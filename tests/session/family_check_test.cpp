// Which family a drive's identity speaks for, against, or says nothing of.
#include "session/family_check.hpp"
#include "session/hearing.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>

#include "session/identify.hpp"
#include "session/scan.hpp"
#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

namespace fs = std::filesystem;
using Kind = FamilyVerdict::Kind;

drive::Profile profile(std::string_view family) { return drive::load_profile(family, kFolders).value(); }

FamilyVerdict judge(const Identity& identity, const drive::Profile& named) {
  return judge_family(identity, named, drive::find_families(kFolders));
}

Identity identity_of(const std::string& family) {
  auto session = Session(sim::open_sim(family + "@1", kFolders, sim::SimBus::Clock::virtual_time).value(),
                         "sim", Options{});
  const std::uint8_t node[] = {1};
  return scan(session, node).value().at(0);
}

constexpr const char* kFamilies[] = {"gsd600", "dm", "da200", "sv2", "ts", "cia402"};

/// By the family that is named and the drive that is there.
using Exceptions = std::map<std::pair<std::string, std::string>, Kind>;

/// A family is proven on its own drive and contradicted on every other, but for `exceptions`.
void expect_verdicts(
    const Exceptions& exceptions,
    const std::function<Identity(const std::string& drive, const drive::Profile& named)>& ask) {
  for (const std::string drive : kFamilies)
    for (const std::string family : kFamilies) {
      const auto named = profile(family);
      const auto verdict = judge(ask(drive, named), named);
      const auto exception = exceptions.find({family, drive});
      const auto expected = exception != exceptions.end() ? exception->second
                            : family == drive             ? Kind::proven
                                                          : Kind::contradicted;
      EXPECT_EQ(verdict.kind, expected) << "-d " << family << " on " << drive << ": " << verdict.why;
      EXPECT_EQ(verdict.why.empty(), verdict.kind == Kind::proven) << verdict.why;
    }
}

/// As a scan left it: 1000h = 20192h alone is many drives', and of the ts the manual says nothing.
TEST(FamilyCheck, HoldsEveryFamilyAgainstEveryDrive) {
  std::map<std::string, Identity> identities;
  for (const std::string drive : kFamilies) identities[drive] = identity_of(drive);
  expect_verdicts(
      {
          {{"gsd600", "gsd600"}, Kind::unproven},
          {{"ts", "ts"}, Kind::unproven},
          {{"ts", "gsd600"}, Kind::unproven},
          {{"ts", "cia402"}, Kind::unproven},
          {{"gsd600", "cia402"}, Kind::unproven},
          {{"cia402", "gsd600"}, Kind::proven},
          {{"cia402", "sv2"}, Kind::proven},
          {{"cia402", "ts"}, Kind::unproven},
      },
      [&](const std::string& drive, const drive::Profile&) { return identities[drive]; });
}

/// As it is asked before something is written.
TEST(FamilyCheck, LooksForObjectsThatOnlyTheFamilyHas) {
  expect_verdicts(
      {
          {{"cia402", "gsd600"}, Kind::proven},
          {{"cia402", "sv2"}, Kind::proven},
          {{"cia402", "ts"}, Kind::unproven},
      },
      [](const std::string& drive, const drive::Profile& named) {
        auto session =
            Session(sim::open_sim(drive + "@1", kFolders, sim::SimBus::Clock::virtual_time).value(), "sim",
                    Options{});
        const std::uint8_t node[] = {1};
        return identify(session, node, named.rules).front().value();
      });
}

TEST(FamilyCheck, TakesHalfOfTheOwnObjectsForNoProof) {
  auto identity = identity_of("ts");
  const auto ts = profile("ts");
  for (const auto object : ts.rules.identity_looks) identity.looked[object] = true;
  EXPECT_EQ(judge(identity, ts).kind, Kind::proven);
  identity.looked[ts.rules.identity_looks.front()] = false;
  EXPECT_EQ(judge(identity, ts).kind, Kind::unproven);
}

TEST(FamilyCheck, OffersWhatFitsAndTheGenericFamilyLast) {
  const std::map<std::string, std::vector<std::string>> fitting{
      {"gsd600", {"gsd600", "cia402"}}, {"dm", {"dm"}},         {"da200", {"da200"}},
      {"sv2", {"sv2", "cia402"}},       {"cia402", {"cia402"}}, {"ts", {"ts"}},
  };
  const auto families = drive::find_families(kFolders);
  for (const auto& [drive, expected] : fitting) {
    auto session = Session(sim::open_sim(drive + "@1", kFolders, sim::SimBus::Clock::virtual_time).value(),
                           "sim", Options{});
    const std::uint8_t node[] = {1};
    auto found = scan(session, node).value();
    look_for_families(session, found, families);
    std::vector<std::string> names;
    for (const auto& guess : guess_families(found.front(), families)) names.push_back(guess.family);
    EXPECT_EQ(names, expected) << drive;
  }
}

TEST(FamilyCheck, NamesTheObjectAndBothValues) {
  const auto verdict = judge(identity_of("da200"), profile("gsd600"));
  EXPECT_EQ(verdict.object, (ObjectAddress{0x1000, 0}));
  EXPECT_EQ(verdict.why, "its 0x1000:0 is 0x04020200, but gsd600 has 0x00020192");
  const auto by_other = judge(identity_of("dm"), profile("ts"));
  EXPECT_NE(by_other.why.find("its identity is that of dm (0x1000:0 = 0x00030000"), std::string::npos)
      << by_other.why;
  EXPECT_NE(by_other.why.find("0x1008:0 = \"DM\""), std::string::npos) << by_other.why;
}

TEST(FamilyCheck, SaysNothingOfWhatADriveDoesNotTell) {
  Identity silent;
  for (const std::string named : kFamilies)
    EXPECT_EQ(judge(silent, profile(named)).kind, Kind::unproven) << named;
  Identity half;
  half.device_type = 0x04020200;
  EXPECT_EQ(judge(half, profile("da200")).kind, Kind::unproven);
  EXPECT_EQ(judge(half, profile("ts")).kind, Kind::unproven) << "one mark of a family is not the family";
  half.vendor_id = 5;
  EXPECT_EQ(judge(half, profile("da200")).kind, Kind::contradicted);
}

TEST(FamilyCheck, IsContradictedByANameThatIsAConstant) {
  auto identity = identity_of("dm");
  identity.device_name = "XY";
  const auto verdict = judge(identity, profile("dm"));
  EXPECT_EQ(verdict.kind, Kind::contradicted);
  EXPECT_EQ(verdict.object, (ObjectAddress{0x1008, 0}));
}

class OwnFile : public testing::Test {
 protected:
  drive::Profile load(std::string_view info, std::string_view type, std::string_view access = "ro") {
    std::ofstream(path_)
        << "[DeviceInfo]\nVendorName=X\nProductName=Y\n"
        << info
        << "[MandatoryObjects]\nSupportedObjects=1\n1=0x1000\n[1000]\nParameterName=Device type\n"
           "ObjectType=0x7\nDataType=0x0007\nAccessType="
        << access << "\nDefaultValue=" << type
        << "\n[OptionalObjects]\nSupportedObjects=1\n1=0x1008\n[1008]\nParameterName=Name\n"
           "ObjectType=0x7\nDataType=0x0009\nAccessType=const\nDefaultValue=0\n";
    return drive::load_profile(path_, kFolders).value();
  }
  ~OwnFile() override { fs::remove(path_); }
  std::string path_ = testing::TempDir() + std::to_string(::getpid()) + "-own.eds";
  Identity identity_{.node = 1,
                     .device_type = 0x20192,
                     .vendor_id = 0x111,
                     .product_code = 0x222,
                     .revision = 0x333,
                     .serial = 1,
                     .device_name = "0",
                     .hardware_version = {},
                     .software_version = {},
                     .state = {},
                     .looked = {}};
};

TEST_F(OwnFile, IsHeldAgainstItsOwnIdentity) {
  const auto named = load("VendorNumber=0x111\nProductNumber=0x222\nRevisionNumber=0x333\n", "0x20192");
  EXPECT_EQ(judge(identity_, named).kind, Kind::proven);
  identity_.revision = 0x334;
  EXPECT_EQ(judge(identity_, named).kind, Kind::unproven) << "another firmware";
  EXPECT_NE(judge(identity_, named).why.find("0x1018:3"), std::string::npos) << judge(identity_, named).why;
  identity_.product_code = 0x223;
  EXPECT_EQ(judge(identity_, named).kind, Kind::contradicted);
  identity_.product_code = 0x222;
  identity_.vendor_id = 0;
  EXPECT_EQ(judge(identity_, named).object, (ObjectAddress{0x1018, 1}));
}

TEST_F(OwnFile, SaysNothingByZerosAndByValuesThatCanBeWritten) {
  const auto named = load("VendorNumber=0\nProductNumber=0\n", "0x30191", "rw");
  EXPECT_EQ(judge(identity_, named).kind, Kind::unproven);
  const auto by_type = load("", "0x30191");
  EXPECT_EQ(judge(identity_, by_type).kind, Kind::contradicted);
}

TEST_F(OwnFile, IsNotContradictedByAFamilyThatFits) {
  const auto named = load("", "0");
  EXPECT_EQ(judge(identity_of("sv2"), named).kind, Kind::unproven);
}

TEST(Identify, ReadsOnceUntilTheNodeRestarts) {
  auto bus = sim::open_sim("da200@1", kFolders, sim::SimBus::Clock::virtual_time).value();
  Options options;
  options.drive_folders = [] { return std::span<const fs::path>(kFolders); };
  Session session(std::move(bus), "sim", options);
  (void)session.listen();
  std::vector<std::string> heard;
  const Hearing hearing(session,
                        [&](const can::Frame& frame, TimePoint) { heard.push_back(can::to_string(frame)); });
  const std::uint8_t node[] = {1};
  const auto rules = profile("da200").rules;
  EXPECT_EQ(identify(session, node, rules).at(0).value().vendor_id, 4U);
  EXPECT_EQ(heard.size(), 3U) << "1000h, 1018h:01, 1018h:02; a da200 has no 1008h";
  EXPECT_EQ(identify(session, node, rules).at(0).value().device_type, 0x04020200U);
  EXPECT_EQ(heard.size(), 3U);
  ASSERT_TRUE(session.can()->send(canopen::nmt_frame(canopen::NmtCommand::reset_node, 1)));
  ASSERT_TRUE(
      session.wait([&] { return session.watch().boots(1) > 1; }, session.now() + std::chrono::seconds(5)));
  heard.clear();
  EXPECT_TRUE(identify(session, node, rules).at(0));
  EXPECT_EQ(heard.size(), 3U);
}

/// Two drives, or more, of one number: a cell is asked for each alone.
class TwoNodes : public testing::Test {
 protected:
  class Bus final : public can::Bus {
   public:
    explicit Bus(std::vector<sim::Cell> cells) : cells_(std::move(cells)) {
      for (const auto& cell : cells_)
        for (const auto& drive : cell.drives) bus_.attach(*drive);
    }
    TimePoint now() const override { return bus_.now(); }
    Result<void> send(const can::Frame& frame) override { return bus_.send(frame); }
    Result<std::optional<can::Frame>> receive(TimePoint deadline) override { return bus_.receive(deadline); }
    TimePoint next_event() const override { return bus_.next_event(); }

   private:
    std::vector<sim::Cell> cells_;
    sim::SimBus bus_{sim::SimBus::Clock::virtual_time};
  };
  void open(std::initializer_list<std::string> specs) {
    std::vector<sim::Cell> cells;
    for (const auto& spec : specs) cells.push_back(sim::build_cell(spec, kFolders, TimePoint{}).value());
    session_ = std::make_unique<Session>(std::make_unique<Bus>(std::move(cells)), "test", Options{});
    (void)session_->listen();
    (void)session_->take_events();
  }
  const std::uint8_t node_[1] = {1};
  std::unique_ptr<Session> session_;
};

TEST_F(TwoNodes, AreNoticedByAScanHoweverFastTheyAnswer) {
  for (const std::string family : kFamilies)
    for (const std::string delay : {"0ms", "1ms", "5ms", "15ms"}) {
      open({family + "@1", family + "@1?delay=" + delay});
      ASSERT_TRUE(scan(*session_, node_));
      EXPECT_FALSE(session_->can()->duplicates().noticed(1).empty()) << family << " " << delay;
      EXPECT_EQ(refuse_duplicate(*session_, 1).error().code, Errc::refused);
    }
}

TEST_F(TwoNodes, AreNoticedBeforeAWrite) {
  for (const std::string family : kFamilies)
    for (const std::string other : kFamilies) {
      open({family + "@1", other + "@1?delay=3ms"});
      ASSERT_TRUE(identify(*session_, node_, profile(family).rules).at(0));
      EXPECT_FALSE(session_->can()->duplicates().noticed(1).empty()) << family << " " << other;
    }
}

TEST_F(TwoNodes, AreForgottenByAScanThatFindsOne) {
  open({"gsd600@1", "dm@1?silent=3s"});
  ASSERT_TRUE(scan(*session_, node_));
  EXPECT_NE(session_->can()->duplicates().noticed(1), "");
  (void)session_->wait([] { return false; }, session_->now() + std::chrono::seconds(4));
  ASSERT_TRUE(scan(*session_, node_));
  EXPECT_EQ(session_->can()->duplicates().noticed(1), "");
}

TEST_F(TwoNodes, AreNotSeenInOneThatIsSlowOrRestarts) {
  for (const std::string family : kFamilies) {
    open({family + "@1?delay=700ms"});
    session_->options().timeout = std::chrono::milliseconds(300);
    for (int i = 0; i < 3; ++i) (void)scan(*session_, node_);
    ASSERT_TRUE(session_->can()->send(canopen::nmt_frame(canopen::NmtCommand::reset_node, 1)));
    (void)session_->wait([] { return false; }, session_->now() + std::chrono::seconds(3));
    EXPECT_EQ(session_->can()->duplicates().noticed(1), "") << family;
  }
}

}  // namespace
}  // namespace servoctl::session
