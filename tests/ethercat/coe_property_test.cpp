#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <random>

#include "coe_wire.hpp"

namespace servoctl::ethercat {
namespace {

/// Sizes of both mailboxes and of the object, how the slave counts, how long it takes, what comes between.
struct Conditions {
  std::uint16_t out_size = *rc::gen::inRange<std::uint16_t>(16, 300);
  std::uint16_t in_size = *rc::gen::inRange<std::uint16_t>(16, 300);
  std::vector<std::uint8_t> numbers =
      *rc::gen::element(std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7}, std::vector<std::uint8_t>{0},
                        std::vector<std::uint8_t>{3}, std::vector<std::uint8_t>{5, 0, 2, 2});
  Duration latency{*rc::gen::inRange(0, 8000)};
  bool drops_doubles = *rc::gen::arbitrary<bool>();
  std::uint8_t abort_service = *rc::gen::element<std::uint8_t>(2, 3);

  void put(Wire& wire) const {
    wire.box.numbers = numbers;
    wire.box.latency = latency;
    wire.box.drops_doubles = drops_doubles;
    wire.server.abort_service = abort_service;
  }
};

RC_GTEST_PROP(CoeSlave, EverySizeGoesThroughEveryMailbox, ()) {
  const Conditions conditions;
  Wire wire(conditions.out_size, conditions.in_size);
  conditions.put(wire);
  std::vector<std::uint16_t> told;
  for (int round = 0; round < 3; ++round) {
    const auto data = pattern(*rc::gen::inRange<std::size_t>(0, 700));
    for (int i = *rc::gen::inRange(0, 3); i > 0; --i) {
      told.push_back(static_cast<std::uint16_t>(0x8100 + told.size()));
      wire.server.before.push_back(emergency(told.back()));
    }
    const auto written = wire.write(data);
    RC_ASSERT(written);
    RC_ASSERT(wire.server.written.size() == static_cast<std::size_t>(round + 1));
    RC_ASSERT(wire.server.written.back() == data);
    const auto read = wire.read();
    RC_ASSERT(read);
    RC_ASSERT(*read == data);
  }
  while (!wire.server.before.empty()) RC_ASSERT(wire.read());
  wire.settle();
  RC_ASSERT(wire.emergencies == told);
  wire.server.refuses = 0x0601'0006;
  const auto refused = wire.read();
  RC_ASSERT(!refused);
  RC_ASSERT(refused.error().abort_code == 0x0601'0006U);
  RC_ASSERT(wire.server.aborted == 0);
}

RC_GTEST_PROP(CoeSlave, LostFramesLoseNoTruth, ()) {
  const Conditions conditions;
  Wire wire(conditions.out_size, conditions.in_size);
  conditions.put(wire);
  wire.box.repeats = *rc::gen::weightedElement<bool>({{4, true}, {1, false}});
  const auto every = *rc::gen::inRange(1, 40);
  std::mt19937 chance(*rc::gen::arbitrary<std::uint32_t>());
  for (int number = 0; number < 3000; ++number) {
    const auto fate = chance() % (2U * static_cast<unsigned>(every));
    if (fate > 1) continue;
    // Alone, or many in a row.
    const auto last = number + (chance() % 4 == 0 ? static_cast<int>(chance() % 40) : 0);
    for (; number <= last; ++number) (fate == 0 ? wire.lost_out : wire.lost_back).insert(number);
  }
  std::vector<std::uint16_t> told;
  wire.server.objects[{0x2000, 1}] = pattern(3);
  for (int round = 0; round < 4; ++round) {
    const auto data = pattern(*rc::gen::inRange<std::size_t>(0, 300));
    if (*rc::gen::arbitrary<bool>()) {
      told.push_back(static_cast<std::uint16_t>(0x8100 + told.size()));
      wire.server.before.push_back(emergency(told.back()));
    }
    const auto before = wire.server.written.size();
    wire.server.refuses = *rc::gen::weightedElement<std::uint32_t>({{3, 0U}, {1, 0x0800'0022U}});
    const auto written = wire.write(data);
    const auto times = wire.server.written.size() - before;
    RC_ASSERT(times <= 1U);
    if (written) RC_ASSERT(times == 1U);
    if (times == 1U) RC_ASSERT(wire.server.written.back() == data);
    RC_LOG() << (written ? "written" : written.error().message.text()) << '\n';
    RC_ASSERT(
        (written || written.error().code == Errc::timeout || written.error().abort_code == 0x0800'0022U));
    wire.server.refuses = 0;
    const auto present = wire.server.objects[{0x2000, 1}];
    const auto read = wire.read(5);
    if (read) RC_ASSERT(*read == present);
  }
  // What was told came once at most, and in its order.
  auto place = told.begin();
  for (const auto code : wire.emergencies) {
    place = std::find(place, told.end(), code);
    RC_ASSERT(place != told.end());
    ++place;
  }
}

}  // namespace
}  // namespace servoctl::ethercat
