// The machines of the master on simulated slaves: two ends that share the codec of frames and nothing else.
#include <gtest/gtest.h>

#include "esc_support.hpp"
#include "ethercat/al_request.hpp"
#include "ethercat/coe_slave.hpp"
#include "ethercat/process_image.hpp"
#include "ethercat/sii_reader.hpp"

namespace servoctl::sim {
namespace {

namespace ec = ethercat;
using std::chrono::milliseconds;

class EscMaster : public EscTest {
 protected:
  static constexpr auto kFirst = ec::SlaveAddress::station(kStation);

  void SetUp() override { build(1); }

  /// Everything that is under way goes on until then, or until `done`.
  template <class Done>
  bool run_until(Duration patience, Done done) {
    for (const auto end = now_ + patience;;) {
      step();
      if (done()) return true;
      if (now_ >= end) return false;
      auto next = std::min({end, ring_.deadline(), master_.deadline()});
      if (coe_) next = std::min(next, coe_->deadline());
      if (image_.running()) next = std::min(next, image_.deadline());
      now_ = std::max(next, now_ + std::chrono::microseconds(20));
    }
  }
  void step() {
    ring_.on_time(now_);
    master_.on_time(now_);
    if (coe_) coe_->on_time(now_);
    for (bool more = true; more;) {
      if (coe_) coe_->serve(master_, now_);
      if (image_.running()) image_.serve(master_, now_);
      more = false;
      while (const auto frame = master_.take_frame(now_)) ring_.on_frame(*frame, now_);
      while (const auto frame = ring_.take_frame()) more = master_.on_frame(*frame, now_) || more;
    }
  }
  /// One machine that asks and is answered.
  template <class Machine>
  auto ask(Machine& machine) {
    ec::Carrier carrier;
    decltype(machine.take_result()) result;
    for (const auto end = now_ + std::chrono::seconds(5); !result && now_ < end;) {
      machine.on_time(now_);
      while (carrier.serve(machine, master_, now_)) step();
      step();
      result = machine.take_result();
      now_ = std::max(now_ + std::chrono::microseconds(20), std::min(machine.deadline(), master_.deadline()));
      if (now_ > end) now_ = end;
    }
    carrier.leave(master_);
    return result;
  }
  void put(const ec::Request& request) {
    const auto ticket = master_.post(request);
    ASSERT_TRUE(ticket);
    std::optional<ec::Answer> answer;
    ASSERT_TRUE(
        run_until(milliseconds(500), [&] { return (answer = master_.take_answer(*ticket)).has_value(); }));
    EXPECT_TRUE(answer->done());
  }
  void open_mailbox(std::uint16_t size = 256) {
    const ec::SiiMailbox place{0x1000, size, 0x1400, size};
    put(ec::mailbox_setup(kFirst, place));
    go_to(2);
    coe_.emplace(1, kFirst, ec::Mailbox::Options{place}, milliseconds(500));
    coe_->mailbox().start(now_);
  }
  void go_to(unsigned state) {
    put(ec::write_registers(kFirst, 0x0120, store_le(state, 2)));
    EXPECT_TRUE(
        run_until(milliseconds(500), [&] { return static_cast<unsigned>(slave().state()) == state; }));
  }
  Result<Bytes> finish() {
    std::optional<Result<Bytes>> result;
    EXPECT_TRUE(run_until(std::chrono::seconds(5), [&] {
      result = coe_->client().take_result();
      return result.has_value();
    }));
    return result.value_or(Bytes{});
  }
  Result<Bytes> upload(ObjectAddress object) {
    coe_->client().start_upload(object, now_);
    return finish();
  }
  Result<Bytes> download(ObjectAddress object, Bytes data) {
    coe_->client().start_download(object, std::move(data), now_);
    return finish();
  }

  ec::Ring master_{ec::Ring::Options{}};
  std::optional<ec::CoeSlave> coe_;
  ec::ProcessImage image_{ec::ProcessImage::Options{}};
};

TEST_F(EscMaster, ObjectsAreReadAndWritten) {
  open_mailbox();
  EXPECT_EQ(to_hex(upload({0x1018, 1}).value()), "53 56 44 00");
  EXPECT_EQ(to_hex(upload({0x1008, 0}).value()), "44 53 58 30 30 45");
  EXPECT_TRUE(download({0x60FF, 0}, hex("10270000")));
  EXPECT_EQ(slave().model().values().number({0x60FF, 0}), 10000U);
  EXPECT_EQ(upload({0x1234, 0}).error().abort_code, 0x0602'0000U);
  EXPECT_EQ(download({0x6041, 0}, hex("0000")).error().abort_code, 0x0601'0002U);
}

TEST_F(EscMaster, LostFramesDelaysAndEmergenciesCostTimeAndNothingElse) {
  open_mailbox();
  ring_.faults().loses_every = 7;
  slave().faults().answer_delay = milliseconds(5);
  for (std::uint32_t i = 0; i < 40; ++i) {
    slave().faults().emergencies = i % 3 == 0 ? 1 : 0;
    EXPECT_TRUE(download({0x60FF, 0}, store_le(i, 4))) << i;
    EXPECT_EQ(load_le(upload({0x60FF, 0}).value()), i);
  }
  int emergencies = 0;
  while (coe_->mailbox().take_emergency()) ++emergencies;
  EXPECT_EQ(emergencies, 14);
}

TEST_F(EscMaster, ProcessDataFlowAtFourMilliseconds) {
  open_mailbox();
  for (const auto& [object, value] : std::initializer_list<std::pair<ObjectAddress, std::uint16_t>>{
           {{0x1C12, 1}, 0x1702}, {{0x1C13, 1}, 0x1B04}}) {
    EXPECT_TRUE(download({object.index, 0}, {0}));
    EXPECT_TRUE(download(object, store_le(value, 2)));
    EXPECT_TRUE(download({object.index, 0}, {1}));
  }
  ec::ProcessMapping mapping;
  for (const auto& [index, fields] :
       {std::pair{0x1702, &mapping.outputs}, std::pair{0x1B04, &mapping.inputs}}) {
    const auto count = upload({static_cast<std::uint16_t>(index), 0}).value()[0];
    for (std::uint8_t sub = 1; sub <= count; ++sub)
      fields->push_back(canopen::parse_pdo_entry(
          static_cast<std::uint32_t>(load_le(upload({static_cast<std::uint16_t>(index), sub}).value()))));
  }
  const auto logical = image_.add(1, mapping);
  const auto plan = ec::plan_slave(1, {2, 0x1800, 0x64, 3, 0x1C00, 0x20}, mapping, logical);
  ASSERT_TRUE(plan) << plan.error().message.text();
  for (const auto& request : plan->requests(kFirst)) put(request);
  go_to(4);
  for (const auto& entry : mapping.outputs) {
    const auto now = upload(entry.object).value();
    EXPECT_TRUE(image_.set(1, entry.object, now));
  }
  ASSERT_TRUE(image_.set(1, {0x6060, 0}, Bytes{3}));
  ASSERT_TRUE(image_.start(now_));
  (void)run_until(milliseconds(20), [] { return false; });
  go_to(8);
  for (const std::uint8_t word : {std::uint8_t{6}, std::uint8_t{7}, std::uint8_t{15}}) {
    ASSERT_TRUE(image_.set(1, {0x6040, 0}, Bytes{word, 0}));
    (void)run_until(milliseconds(20), [] { return false; });
  }
  ASSERT_TRUE(image_.set(1, {0x60FF, 0}, store_le(20000, 4)));
  ring_.faults().loses_every = 9;
  (void)run_until(milliseconds(1000), [] { return false; });
  EXPECT_EQ(slave().state(), EscState::op);
  const auto speed = image_.fresh_input(1, {0x606C, 0}, now_);
  ASSERT_TRUE(speed);
  EXPECT_NEAR(static_cast<double>(load_le(speed->value)), 20000, 200);
  EXPECT_GT(image_.counts(1).lost, 20U);
  EXPECT_EQ(image_.counts(1).short_inputs, 0U);
  image_.stop();
  (void)run_until(milliseconds(300), [] { return false; });
  EXPECT_EQ(slave().al_code(), 0x001B);
  EXPECT_FALSE(drive::is_energised(slave().model().power_state()));
}

TEST_F(EscMaster, SdosOfAnySizeGoThroughAnyMailbox) {
  od::Object text{0x5FFF, "Text", od::ObjectCode::var, {}};
  text.entries.emplace_back();
  text.entries[0].address = {0x5FFF, 0};
  text.entries[0].type = od::DataType::string;
  for (const std::uint16_t size : {std::uint16_t{34}, std::uint16_t{47}, std::uint16_t{256}}) {
    slaves_.clear();
    ring_ = {};
    load();
    profile_->dictionary.add(text);
    build(1);
    coe_.reset();
    open_mailbox(size);
    for (std::size_t length = 1; length < 200; length += 3) {
      const Bytes data(length, 'x');
      EXPECT_TRUE(download({0x5FFF, 0}, data)) << length << " in " << size;
      EXPECT_EQ(upload({0x5FFF, 0}).value(), data) << length << " in " << size;
    }
  }
}

TEST_F(EscMaster, TheSiiIsReadWholeAndSaysWhatTheFamilySays) {
  slave().registers().sii().delay = milliseconds(1);
  ec::SiiReader reader(1, kFirst);
  reader.start(now_);
  const auto bytes = ask(reader);
  ASSERT_TRUE(bytes && *bytes);
  const auto image = ec::parse_sii(**bytes);
  EXPECT_TRUE(image.doubts.empty()) << image.doubts.front();
  EXPECT_EQ(image.vendor, 0x0044'5653U);
  EXPECT_EQ(image.name, "DSX00E");
  EXPECT_EQ(image.mailbox, (ec::SiiMailbox{0x1000, 256, 0x1400, 256}));
  EXPECT_EQ(image.coe, 0x0D);
  ASSERT_EQ(image.rx_pdos.size(), 6U);
  EXPECT_EQ(image.rx_pdos[2].index, 0x1702);
  EXPECT_EQ(image.rx_pdos[2].bits(), 19U * 8);
  ASSERT_EQ(image.tx_pdos.size(), 5U);
  EXPECT_EQ(image.tx_pdos[4].bits(), 29U * 8);
  const auto area = ec::process_area(image);
  EXPECT_EQ(area.out_start, 0x1800);
  EXPECT_EQ(area.in_control, 0x20);
}

TEST_F(EscMaster, WhatIsWrongWithAnSiiIsFound) {
  for (const auto fault : {SiiFault::checksum, SiiFault::blank, SiiFault::cut_short, SiiFault::mute}) {
    slaves_.clear();
    ring_ = {};
    options_.sii = fault;
    build(1);
    ec::SiiReader reader(1, kFirst);
    reader.start(now_);
    const auto bytes = ask(reader);
    ASSERT_TRUE(bytes);
    if (fault == SiiFault::mute)
      EXPECT_FALSE(*bytes);
    else
      EXPECT_TRUE(!*bytes || !ec::parse_sii(**bytes).doubts.empty()) << static_cast<int>(fault);
  }
}

TEST_F(EscMaster, StatesAreAskedForAndRefusalsUnderstood) {
  ec::AlRequest states(1, kFirst);
  states.start(ec::AlState::preop, now_);
  auto result = ask(states);
  ASSERT_TRUE(result);
  ASSERT_FALSE(*result);
  EXPECT_NE(result->error().message.text().find("0016"), std::string::npos) << result->error().message.text();
  put(ec::mailbox_setup(kFirst, {0x1000, 256, 0x1400, 256}));
  slave().faults().state_delay = milliseconds(70);
  states.start(ec::AlState::preop, now_);
  result = ask(states);
  ASSERT_TRUE(result && *result);
  EXPECT_EQ(slave().state(), EscState::pre_op);
}

}  // namespace
}  // namespace servoctl::sim
