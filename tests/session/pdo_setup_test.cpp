// The PDOs of a drive as they are read: with its dictionary, with another one, and with none at all.
#include "session/pdo_setup.hpp"

#include <gtest/gtest.h>

#include "sim/cell.hpp"
#include "sim/sim_bus.hpp"
#include "sim/sim_drive.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

using canopen::Pdo;
using canopen::PdoDirection;

drive::Profile profile_of(std::string_view family) { return drive::load_profile(family, kFolders).value(); }

/// Hands frames to a bus that outlives the session.
class BorrowedBus final : public can::Bus {
 public:
  explicit BorrowedBus(can::Bus& bus) : bus_(&bus) {}
  TimePoint now() const override { return bus_->now(); }
  TimePoint next_event() const override { return bus_->next_event(); }
  Result<void> send(const can::Frame& frame) override {
    ++frames;
    return bus_->send(frame);
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override { return bus_->receive(deadline); }
  static int frames;

 private:
  can::Bus* bus_;
};
int BorrowedBus::frames = 0;

/// Simulated drives of profiles that a test may bend.
class PdoSetup : public testing::Test {
 protected:
  void attach(drive::Profile profile, std::uint8_t node) {
    profiles_.push_back(std::make_unique<drive::Profile>(std::move(profile)));
    drives_.push_back(
        std::make_unique<sim::SimDrive>(*profiles_.back(), node, memory_, std::to_string(node)));
    bus_.attach(*drives_.back());
    BorrowedBus::frames = 0;
  }
  /// From the first call on all drives have booted.
  Session& session() {
    if (!session_) {
      session_ = std::make_unique<Session>(std::make_unique<BorrowedBus>(bus_), "sim", Options{});
      (void)session_->wait([] { return false; }, session_->now() + std::chrono::seconds(1));
    }
    return *session_;
  }
  sim::SimDrive& drive(std::size_t i) { return *drives_[i]; }

 private:
  sim::SimBus bus_{sim::SimBus::Clock::virtual_time};
  sim::Memory memory_;
  std::vector<std::unique_ptr<drive::Profile>> profiles_;
  std::vector<std::unique_ptr<sim::SimDrive>> drives_;
  std::unique_ptr<Session> session_;
};

/// The profile with only the objects that are wanted, and those of `moved` under another index.
drive::Profile bent(drive::Profile profile, const std::vector<std::uint16_t>& missing,
                    const std::map<std::uint16_t, std::uint16_t>& moved) {
  od::Dictionary dictionary;
  for (auto object : profile.dictionary.objects()) {
    if (std::count(missing.begin(), missing.end(), object.index) > 0) continue;
    if (const auto to = moved.find(object.index); to != moved.end()) {
      object.index = to->second;
      for (auto& entry : object.entries) entry.address.index = to->second;
    }
    dictionary.add(object);
  }
  profile.dictionary = std::move(dictionary);
  return profile;
}

std::vector<std::string> names_of(const std::vector<Pdo>& pdos) {
  std::vector<std::string> out;
  for (const auto& pdo : pdos) out.push_back(canopen::name(pdo.direction, pdo.number));
  return out;
}

TEST_F(PdoSetup, TellsWhatTheManualSaysTheDriveLeavesTheFactoryWith) {
  const auto profile = profile_of("gsd600");
  attach(profile, 5);
  const auto pdos = read_pdos(session(), &profile, 5);
  ASSERT_TRUE(pdos) << pdos.error().message.text();
  ASSERT_EQ(names_of(*pdos), (std::vector<std::string>{"RPDO1", "RPDO2", "RPDO3", "RPDO4", "TPDO1", "TPDO2",
                                                       "TPDO3", "TPDO4"}));
  EXPECT_EQ((*pdos)[2].cob_id, 0x405U);
  EXPECT_EQ((*pdos)[2].entries, (std::vector<canopen::PdoEntry>{{{0x6040, 0}, 16}, {{0x607A, 0}, 32}}));
  EXPECT_TRUE((*pdos)[4].is_valid());
  EXPECT_FALSE((*pdos)[5].is_valid());
  EXPECT_EQ((*pdos)[5].cob_id & canopen::kPdoCobIdMask, 0x285U);
  EXPECT_EQ((*pdos)[5].inhibit, 100);
}

TEST_F(PdoSetup, IsTheSameWithoutADictionary) {
  const auto profile = profile_of("dm");
  attach(profile, 3);
  const auto with = read_pdos(session(), &profile, 3);
  const auto without = read_pdos(session(), nullptr, 3);
  ASSERT_TRUE(with);
  ASSERT_TRUE(without) << without.error().message.text();
  EXPECT_EQ(*with, *without);
}

TEST_F(PdoSetup, FindsANumberBehindAHole) {
  const auto drive = bent(profile_of("gsd600"), {},
                          {{0x1403, 0x1406}, {0x1603, 0x1606}, {0x1803, 0x1809}, {0x1A03, 0x1A09}});
  attach(drive, 1);
  const std::vector<std::string> expected{"RPDO1", "RPDO2", "RPDO3", "RPDO7",
                                          "TPDO1", "TPDO2", "TPDO3", "TPDO10"};
  const auto without = read_pdos(session(), nullptr, 1);
  ASSERT_TRUE(without);
  EXPECT_EQ(names_of(*without),
            (std::vector<std::string>{"RPDO1", "RPDO2", "RPDO3", "RPDO7", "TPDO1", "TPDO2", "TPDO3"}));
  const auto with = read_pdos(session(), &drive, 1);
  ASSERT_TRUE(with);
  EXPECT_EQ(names_of(*with), expected);
}

TEST_F(PdoSetup, GoesOnBehindTheFirstEightWhereTheLastOfThemAreThere) {
  const auto drive = bent(profile_of("gsd600"), {},
                          {{0x1402, 0x1406}, {0x1602, 0x1606}, {0x1403, 0x1409}, {0x1603, 0x1609}});
  attach(drive, 1);
  const auto pdos = read_pdos(session(), nullptr, 1);
  ASSERT_TRUE(pdos);
  EXPECT_EQ(names_of(*pdos), (std::vector<std::string>{"RPDO1", "RPDO2", "RPDO7", "RPDO10", "TPDO1", "TPDO2",
                                                       "TPDO3", "TPDO4"}));
}

TEST_F(PdoSetup, LeavesOutWhatThisDriveDoesNotHave) {
  const auto profile = profile_of("gsd600");
  attach(bent(profile, {0x1401, 0x1601, 0x1803}, {}), 1);
  const auto pdos = read_pdos(session(), &profile, 1);
  ASSERT_TRUE(pdos);
  EXPECT_EQ(names_of(*pdos),
            (std::vector<std::string>{"RPDO1", "RPDO3", "RPDO4", "TPDO1", "TPDO2", "TPDO3"}));
}

TEST_F(PdoSetup, OfANodeThatDoesNotAnswerIsAnErrorAndCostsTheOthersNothing) {
  const auto profile = profile_of("gsd600");
  attach(profile, 1);
  attach(profile, 2);
  drive(1).wire_faults().silent = true;
  const std::uint8_t nodes[] = {1, 2, 3};
  for (const auto* known : {&profile, static_cast<const drive::Profile*>(nullptr)}) {
    const auto before = session().now();
    const auto pdos = read_pdos(session(), known, nodes);
    ASSERT_TRUE(pdos[0]);
    EXPECT_EQ(pdos[0]->size(), 8U);
    ASSERT_FALSE(pdos[1]);
    EXPECT_EQ(pdos[1].error().code, Errc::timeout);
    EXPECT_EQ(pdos[2].error().node, 3);
    EXPECT_LE(session().now() - before, std::chrono::milliseconds(1100));
  }
}

TEST_F(PdoSetup, WithoutADictionaryAsksABoundedNumberOfQuestions) {
  attach(bent(profile_of("gsd600"), {0x1400, 0x1401, 0x1402, 0x1403, 0x1800, 0x1801, 0x1802, 0x1803}, {}), 1);
  const auto pdos = read_pdos(session(), nullptr, 1);
  ASSERT_TRUE(pdos);
  EXPECT_TRUE(pdos->empty());
  EXPECT_EQ(BorrowedBus::frames, 16);
}

TEST_F(PdoSetup, KnowsFixedPdosWithoutCobIdAndWhichOfThemAreAssigned) {
  const auto profile = profile_of("sv2");
  attach(profile, 1);
  const auto pdos = read_pdos(session(), &profile, 1);
  ASSERT_TRUE(pdos);
  ASSERT_EQ(pdos->size(), 11U);  // 1600h, 1701h to 1705h, 1A00h, 1B01h to 1B04h (529-546)
  const auto& rpdo = (*pdos)[2];
  EXPECT_EQ(rpdo.mapping_index(), 0x1702);
  EXPECT_FALSE(rpdo.is_valid());
  EXPECT_EQ(rpdo.bits(), 19U * 8);  // 530
  EXPECT_TRUE(
      assigned_pdos(&profile,
                    read_pdo_values(session(), &profile, std::array<std::uint8_t, 1>{1}).front().value())
          .empty());
  const SdoRequest assign[] = {
      {1, {0x1C12, 0}, Bytes{0}}, {1, {0x1C12, 1}, Bytes{2, 0x17}}, {1, {0x1C12, 0}, Bytes{1}}};
  for (const auto& written : session().transfer(assign))
    ASSERT_TRUE(written) << written.error().message.text();
  EXPECT_EQ(
      assigned_pdos(&profile,
                    read_pdo_values(session(), &profile, std::array<std::uint8_t, 1>{1}).front().value()),
      std::vector<std::uint16_t>{0x1702});
}

TEST_F(PdoSetup, FromTheFactoryIsWhatTheSimulatedDriveStartsWith) {
  std::uint8_t node = 0;
  for (const auto* family : {"gsd600", "dm", "da200", "ts", "sv2"}) attach(profile_of(family), ++node);
  for (std::uint8_t each = 1; each <= node; ++each) {
    const auto& profile = drive(each - 1U).profile();
    SCOPED_TRACE(profile.family);
    const auto values = read_pdo_values(session(), &profile, std::span(&each, 1)).front();
    ASSERT_TRUE(values);
    std::size_t compared = 0;
    for (const auto& [object, data] : default_pdo_values(profile, each)) {
      const auto found = values->find(object);
      if (found == values->end()) continue;  // An entry behind the count.
      EXPECT_EQ(found->second, data) << to_string(object);
      ++compared;
    }
    EXPECT_GE(compared, 8U);
  }
}

TEST(PdosOf, TakesACountThatIsNoneForNoEntries) {
  EXPECT_TRUE(pdos_of({{{0x1600, 0}, {0xFE}}, {{0x1600, 1}, {0x10, 0, 0x40, 0x60}}}).front().entries.empty());
  EXPECT_TRUE(pdos_of({{{0x1600, 0}, Bytes(20, 0xFF)}}).front().entries.empty());
  // One that is missing in the middle: nobody knows where the others stand.
  EXPECT_TRUE(pdos_of({{{0x1A00, 0}, {2}}, {{0x1A00, 2}, {0x20, 0, 0x6C, 0x60}}}).front().entries.empty());
  EXPECT_TRUE(pdos_of({{{0x1018, 1}, {1}}}).empty());
}

}  // namespace
}  // namespace servoctl::session
