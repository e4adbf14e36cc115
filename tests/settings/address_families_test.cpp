// A plan of addresses of drives of several families: each by the rules of its own.
#include <memory>

#include "tests/session/troubled_bus.hpp"
#include "tests/settings/address_plan_world.hpp"

namespace servoctl::settings {
namespace {

/// A cabinet of two families: drives whose parameter of the node-ID is another object, with other rules.
class PlanOfFamilies : public PlanOfAddresses {
 protected:
  PlanOfFamilies() { text_ = "node,new,family\n1,2,gsd600\n2,1,da200\n3,4,gsd600\n"; }

  std::unique_ptr<AddressWorld> world() const {
    auto out = std::make_unique<AddressWorld>("gsd600", std::vector<std::uint8_t>{1, 3});
    out->add(2, other_);
    return out;
  }
  AddressPlanOptions options(const AddressWorld& world, bool resume = false) {
    AddressPlanOptions out{.each = {}, .resume = resume};
    out.family_of = [&](const AddressRow& row) -> Result<const drive::Profile*> {
      return row.family == "da200" ? &other_ : &world.profile;
    };
    out.hold = [&](std::uint8_t node, const drive::Profile& family) {
      held_.push_back(fmt::format("{} {}", node, family.family));
      return Result<void>();
    };
    return out;
  }
  Result<report::Value> go(AddressWorld& world, bool resume = false) {
    world.desk.profile = nullptr;
    return run_address_plan(world.desk, text_, file_, options(world, resume));
  }

  const drive::Profile other_ = drive::load_profile("da200", kFolders).value();
  std::vector<std::string> held_;
};

TEST_F(PlanOfFamilies, ExchangeTheirNodeIdsInOnePlan) {
  const auto cell = world();
  const auto done = go(*cell);
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_TRUE(cell->desk.errors.empty()) << cell->desk.errors.front().message.text();
  EXPECT_EQ(nodes(*cell), "2 4 1");
  EXPECT_EQ(held_, (std::vector<std::string>{"1 gsd600", "2 da200", "3 gsd600"}));
  EXPECT_EQ(cell->desk.profile, nullptr);
  EXPECT_FALSE(has_journal());
}

TEST_F(PlanOfFamilies, KilledAnywhereCanBeGoneOnWith) {
  text_ = "node,new,family\n1,2,gsd600\n2,1,da200\n";
  int frames = 265;
  int resumed = 0;
  for (int kill_at = 262; kill_at < frames; kill_at += 5) {
    fs::remove(address_journal_of(file_));
    auto cell = std::make_unique<AddressWorld>("gsd600", std::vector<std::uint8_t>{1});
    cell->add(2, other_);
    session::Trouble trouble;
    trouble.kill_at = kill_at;
    auto bus = std::make_unique<session::TroubledBus>(cell->bus, *cell->drives[0], trouble, 1);
    const auto* counted = bus.get();
    cell->restart_session(std::move(bus));
    try {
      (void)go(*cell);
      frames = counted->frames();
    } catch (const session::Killed&) {
      frames = std::max(frames, kill_at + 6);
    }
    const bool journal = has_journal();
    cell->restart_session();
    if (!journal) {
      EXPECT_TRUE(nodes(*cell) == "1 2" || nodes(*cell) == "2 1") << kill_at << ": " << nodes(*cell);
      continue;
    }
    ++resumed;
    const auto done = go(*cell, true);
    ASSERT_TRUE(done) << kill_at << ": " << done.error().message.text();
    EXPECT_TRUE(cell->desk.errors.empty()) << kill_at << ": " << cell->desk.errors.front().message.text();
    EXPECT_EQ(nodes(*cell), "2 1") << kill_at;
    EXPECT_FALSE(has_journal()) << kill_at;
  }
  EXPECT_GT(resumed, 15);
}

TEST_F(PlanOfFamilies, AreTheOnesThatItWasBegunWith) {
  const auto cell = world();
  const auto refused_index = drive::place_of(other_, "P4.05")->index;
  cell->drives[2]->misbehaviour().refused.insert(refused_index);
  ASSERT_TRUE(go(*cell));
  ASSERT_TRUE(has_journal());
  auto wrong = options(*cell, true);
  wrong.family_of = [&](const AddressRow&) -> Result<const drive::Profile*> { return &cell->profile; };
  const auto refused = run_address_plan(cell->desk, text_, file_, wrong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::refused);
  EXPECT_EQ(refused.error().message.text(), "line 3: it was begun as a da200, not as a gsd600");
  cell->drives[2]->misbehaviour().refused.clear();
  held_.clear();
  ASSERT_TRUE(go(*cell, true));
  EXPECT_EQ(nodes(*cell), "2 4 1");
  EXPECT_EQ(held_, (std::vector<std::string>{"127 gsd600", "2 da200"})) << "where they are by now";
}

}  // namespace
}  // namespace servoctl::settings
