#include "show/axis_names.hpp"

#include <gtest/gtest.h>

namespace servoctl::show {
namespace {

const AxisNames kNames({{3, "feeder"}, {4, "lift"}});

TEST(AxisNames, StandForTheNumbersOfNodesInSentences) {
  EXPECT_EQ(kNames.in("node 3: no answer"), "feeder: no answer");
  EXPECT_EQ(kNames.in("node 3, object 0x6040:0: refused"), "feeder, object 0x6040:0: refused");
  EXPECT_EQ(kNames.in("no answer from nodes 3, 4 and 5; node 5 is new"),
            "no answer from feeder, lift and 5; node 5 is new");
  EXPECT_EQ(kNames.in("`disable -n 3` or `status -n 3,4`"), "`disable -n feeder` or `status -n feeder,lift`");
}

TEST(AxisNames, LeaveOtherNumbersAlone) {
  for (const auto* text : {"node 5: no answer", "node 30", "node 3.5", "node-ID 3", "mynode 3", "step 3",
                           "node 0x3", "", "node", "node 3a"})
    EXPECT_EQ(kNames.in(text), text);
}

TEST(AxisNames, StandBeforeTheNodeInResults) {
  report::Value record(report::Record{{"node", 3}, {"nodes", report::List{report::Record{{"node", 5}}}}});
  kNames.put_into(record);
  EXPECT_EQ(report::to_json(record), R"({"axis":"feeder","node":3,"nodes":[{"node":5}]})");
  report::Table table;
  table.columns = {{"value"}, {"node"}};
  table.rows = {{1, 4}, {2, 5}};
  report::Value value(std::move(table));
  kNames.put_into(value);
  EXPECT_EQ(report::to_json(value),
            R"([{"value":1,"axis":"lift","node":4},{"value":2,"axis":null,"node":5}])");
  report::Value error(report::Record{{"axis"}, {"node", 3}});
  kNames.put_into(error);
  EXPECT_EQ(report::to_json(error), R"({"axis":"feeder","node":3})");
  kNames.put_into(value);  // A second time nothing is added.
  EXPECT_EQ(report::to_json(value),
            R"([{"value":1,"axis":"lift","node":4},{"value":2,"axis":null,"node":5}])");
}

TEST(AxisNames, StandApartFromChinese) {
  const AxisNames names({{3, "feeder"}});
  EXPECT_EQ(names.in("已写入节点 3 的参数"), "已写入 feeder 的参数");
  EXPECT_EQ(names.in("节点 3：无应答（节点 3）"), "feeder：无应答（feeder）");
}

/// Node 3 of another bus is another axis than that of the line's bus.
TEST(AxisNames, AreThoseOfTheBusOfANotice) {
  auto notice = message("node {}: lost", node_name(3));
  AxisNames({{3, "lift"}}).put_into(notice);
  AxisNames({{3, "feeder"}}).put_into(notice);
  EXPECT_EQ(notice.text(), "lift: lost");
}

}  // namespace
}  // namespace servoctl::show
