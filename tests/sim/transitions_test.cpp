// The tables of transitions the manuals print: controlword in, statusword out, for every family
// (tests/vectors/*-states.csv).
#include <algorithm>
#include <cstdio>

#include "base/csv.hpp"
#include "base/file.hpp"
#include "base/number.hpp"
#include "sim_support.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

struct Row {
  std::string family;
  unsigned line = 0;
  unsigned transition = 0;  ///< CiA 402-2, figure 6: 0 to 16.
  std::optional<unsigned> controlword;
  unsigned statusword = 0;
  unsigned mask = 0;
};

std::vector<Row> rows_of(const std::string& family) {
  const std::string path = source_dir() + "/tests/vectors/" + family + "-states.csv";
  const auto table = parse_csv(read_file(path).value(), path).value();
  std::vector<Row> out;
  for (const auto& cells : table.rows) {
    const auto number = [&](const char* column) -> std::optional<unsigned> {
      const auto value = parse_integer(cells.cells[table.column(column)]);
      return value ? std::optional(static_cast<unsigned>(value->magnitude)) : std::nullopt;
    };
    if (cells.cells[table.column("mode")] != "all" || !number("step") || !number("statusword")) continue;
    out.push_back({family, *number("line"), *number("step"), number("controlword"), *number("statusword"),
                   *number("mask")});
  }
  return out;
}

/// Where the numbered transitions of CiA 402 begin.
DriveState start_of(unsigned transition) {
  switch (transition) {
    case 2: return DriveState::switch_on_disabled;
    case 3:
    case 7: return DriveState::ready_to_switch_on;
    case 4:
    case 6:
    case 10: return DriveState::switched_on;
    case 5:
    case 8:
    case 9:
    case 11: return DriveState::operation_enabled;
    case 12:
    case 16: return DriveState::quick_stop_active;
    case 14: return DriveState::fault_reaction_active;
    case 15: return DriveState::fault;
    default: return DriveState::unknown;
  }
}

std::vector<Row> all_rows() {
  std::vector<Row> out;
  for (const auto* family : {"da200", "dm", "gsd600", "ts"})
    for (auto& row : rows_of(family))
      if (row.transition != 0) out.push_back(std::move(row));  // That one is over before anybody can ask.
  return out;
}

class ManualTransitions : public CellTest, public testing::WithParamInterface<Row> {
 protected:
  void SetUp() override {
    build(GetParam().family + "@1");
    commission(cell_);
    ASSERT_EQ(next(100ms), "701#00");
  }
  /// The answer; what the drive has to say beside it is passed over.
  std::string sdo(std::string_view frame) {
    auto answer = ask(frame);
    while (answer.substr(0, 3) == "081") answer = next();
    return answer;
  }
  void write(ObjectAddress object, unsigned value) {
    char frame[32];
    const auto size = od::size_of(profile().dictionary.find(object)->type).value();
    std::snprintf(frame, sizeof frame, "601#%02X%02X%02X%02X%02X%02X0000", size == 1 ? 0x2FU : 0x2BU,
                  object.index & 0xFFU, object.index >> 8U, unsigned{object.sub}, value & 0xFFU, value >> 8U);
    const auto answer = sdo(frame);
    ASSERT_EQ(answer.substr(0, 6), "581#60") << frame << " " << answer;
  }
  void control(unsigned word) { write({0x6040, 0}, word); }
  unsigned status() {
    const auto answer = sdo("601#4041600000000000");
    return static_cast<unsigned>(std::stoul(answer.substr(14, 2) + answer.substr(12, 2), nullptr, 16));
  }
  void settle() {
    const auto end = bus.now() + 100ms;
    while (bus.now() < end) (void)next(end - bus.now());
  }
  void fail() { drive().raise_fault(0x1000, {}, bus.now()); }

  /// Where the drive must be told that it may reset faults, and restarted.
  void allow_reset() {
    const auto& gate = profile().rules.fault.reset_enabled_by;
    if (!gate) return;
    write(gate->object, static_cast<unsigned>(gate->value));
    send("000#8101");
    ASSERT_EQ(next(200ms), "701#00");
  }

  void go_to(DriveState state) {
    const bool optional = profile().dictionary.find({0x605A, 0}) != nullptr;
    const auto staying = optional ? profile().rules.quick_stop_stays_enabled : std::vector<std::int64_t>{};
    if (GetParam().transition == 16 && !staying.empty())
      write({0x605A, 0}, static_cast<unsigned>(staying.front()));
    if (GetParam().transition == 12 && !staying.empty()) write({0x605A, 0}, 1);
    if (state == DriveState::fault) {
      allow_reset();
      fail();
      settle();
    }
    if (state == DriveState::fault_reaction_active) fail();
    const std::pair<DriveState, unsigned> steps[] = {{DriveState::ready_to_switch_on, 0x06},
                                                     {DriveState::switched_on, 0x07},
                                                     {DriveState::operation_enabled, 0x0F},
                                                     {DriveState::quick_stop_active, 0x02}};
    const auto last =
        std::find_if(std::begin(steps), std::end(steps), [&](const auto& s) { return s.first == state; });
    if (last == std::end(steps)) return;
    for (auto step = std::begin(steps); step <= last; ++step) control(step->second);
  }
  const drive::Profile& profile() const { return *cell_.profiles.front(); }
};

TEST_P(ManualTransitions, EndInTheStatuswordTheManualPrints) {
  const auto& row = GetParam();
  go_to(start_of(row.transition));
  if (row.transition == 13) fail();
  const bool by_itself = row.transition == 12 || row.transition == 14 || row.transition == 16;
  if (by_itself && (row.transition != 12 || !row.controlword)) settle();
  if (row.controlword) control(*row.controlword);
  EXPECT_EQ(status() & row.mask, row.statusword & row.mask);
}

TEST(ManualTransitionRows, AreAsManyAsTheManualsPrint) {
  EXPECT_EQ(rows_of("gsd600").size(), 17U);
  EXPECT_EQ(rows_of("dm").size(), 17U);
  EXPECT_EQ(rows_of("da200").size(), 16U);
  EXPECT_EQ(rows_of("ts").size(), 5U);
}

INSTANTIATE_TEST_SUITE_P(Families, ManualTransitions, testing::ValuesIn(all_rows()), [](const auto& row) {
  return row.param.family + "_line_" + std::to_string(row.param.line) + "_transition_" +
         std::to_string(row.param.transition) + "_" + std::to_string(row.param.controlword.value_or(0));
});

}  // namespace
}  // namespace servoctl::sim
