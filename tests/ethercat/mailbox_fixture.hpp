#pragma once

#include "ethercat/mailbox.hpp"
#include "hex.hpp"
#include "mailbox_slave.hpp"

namespace servoctl::ethercat {
using Loss = MailboxSlave::Loss;

inline constexpr SiiMailbox kPlace{0x1800, 64, 0x1C00, 48};

class MailboxTest : public testing::Test {
 protected:
  MailboxTest() {
    slave.handler = [this](std::uint8_t type, const Bytes& data) {
      taken.push_back(data);
      EXPECT_EQ(type, 3);
      if (answers) slave.reply(3, data);
    };
    mailbox.start(now);
    run_for(std::chrono::milliseconds(1));
  }

  /// One request of the machine; the ring would repeat what may be.
  bool step() {
    const auto request = mailbox.take_request();
    if (!request) return false;
    ++frames;
    now += std::chrono::microseconds(50);
    auto answer = slave.answer(*request, now);
    for (int tries = 0; answer.lost && request->repeatable && tries < 2; ++tries) {
      now += std::chrono::milliseconds(20);
      answer = slave.answer(*request, now);
    }
    if (answer.lost) now += std::chrono::milliseconds(20);
    mailbox.on_answer(answer, now);
    return true;
  }
  void run_for(Duration time) {
    const auto end = now + time;
    for (int steps = 0; now < end && steps < 100'000; ++steps) {
      slave.run(now);
      if (step()) continue;
      now = std::min(
          end, std::max(now + std::chrono::microseconds(1), std::min(mailbox.deadline(), slave.next())));
      mailbox.on_time(now);
    }
  }
  void send(std::string_view message, Duration time = std::chrono::seconds(1)) {
    mailbox.send(hex(message), now + time, now);
    mailbox.listen(true, now);
  }
  /// The next message that came, as hex; what else came is told in words.
  std::string came() {
    const auto event = mailbox.take_event();
    if (!event) return "nothing";
    if (const auto* message = std::get_if<Mailbox::Message>(&*event))
      return to_hex(message->data, "") + (message->early ? " early" : "");
    if (const auto* refusal = std::get_if<Mailbox::Refusal>(&*event))
      return "refused: " + mailbox_error_text(refusal->detail);
    return std::get<Mailbox::Failure>(*event).what;
  }
  /// The nth frame of this kind is lost.
  void lose(Command command, std::uint16_t where, Loss how, int times = 1) {
    slave.loss = [=, this](const Request& request) {
      const bool meant = request.command == command && request.address >> 16U == where;
      return meant && lost++ < times ? how : Loss::none;
    };
  }

  MailboxSlave slave{kPlace};
  Mailbox mailbox{4, SlaveAddress::station(0x1004), Mailbox::Options{kPlace}};
  TimePoint now{std::chrono::seconds(1)};
  std::vector<Bytes> taken;
  bool answers = true;
  int frames = 0;
  int lost = 0;
};

}  // namespace servoctl::ethercat
