#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <set>
#include <vector>

#include "coe_server.hpp"
#include "ethercat/coe_slave.hpp"

namespace servoctl::ethercat {
inline constexpr ObjectAddress kObject{0x2000, 1};

/// One slave with a mailbox and a server at the end of a wire, and what drives it. Time is virtual.
struct Wire {
  Wire(std::uint16_t out_size, std::uint16_t in_size, Duration timeout = std::chrono::milliseconds(500))
      : place{0x1000, out_size, 0x1800, in_size},
        box(place),
        server(box, in_size),
        slave(7, SlaveAddress::station(0x1007), Mailbox::Options{place, 3}, timeout) {
    slave.mailbox().start(now);
  }

  /// Everything that can go without waiting, then the wait.
  void step() {
    slave.serve(ring, now);
    while (const auto frame = ring.take_frame(now)) pass(*frame);
    while (const auto emergency = slave.mailbox().take_emergency()) emergencies.push_back(emergency->code);
    slave.serve(ring, now);
    if (!arriving.empty()) {
      now += std::chrono::microseconds(30);
      const auto frame = std::move(arriving.front());
      arriving.pop_front();
      ring.on_frame(frame, now);
      return;
    }
    const auto next = std::min({slave.deadline(), ring.deadline(), box.next()});
    if (next == kNever) return;
    now = std::max(now + std::chrono::microseconds(1), next);
    box.run(now);
    ring.on_time(now);
    slave.on_time(now);
  }
  void pass(ByteSpan sent) {
    Bytes frame(sent.begin(), sent.end());
    const auto number = frames++;
    if (lost_out.count(number) != 0) return;
    auto reader = FrameReader::open(frame);
    ASSERT_TRUE(reader);
    while (const auto datagram = reader->next()) {
      EXPECT_EQ(datagram->adp(), 0x1007);
      box.run(now);
      const Request request{datagram->command, datagram->address,
                            Bytes(datagram->data.begin(), datagram->data.end()), false};
      set_working_counter(frame, *datagram, box.process(request, now));
      std::copy(box.data().begin(), box.data().end(), data_of(frame, *datagram).begin());
    }
    if (lost_back.count(number) == 0) arriving.push_back(frame);
  }

  Result<Bytes> finish() {
    const auto begin = now;
    for (int steps = 0; steps < 200'000; ++steps) {
      if (auto result = slave.client().take_result()) {
        EXPECT_FALSE(slave.client().take_result());
        return *result;
      }
      step();
    }
    ADD_FAILURE() << "no end after " << (now - begin).count() << " us";
    return fail(Errc::bug, "no end");
  }
  /// Asked again after silence, as whoever reads does.
  Result<Bytes> read(int tries = 1) {
    for (;; --tries) {
      slave.client().start_upload(kObject, now);
      auto result = finish();
      if (result || result.error().code != Errc::timeout || tries <= 1) return result;
    }
  }
  Result<Bytes> write(const Bytes& data) {
    slave.client().start_download(kObject, data, now);
    return finish();
  }
  void settle() {
    for (int i = 0; i < 60; ++i) step();
  }

  SiiMailbox place;
  MailboxSlave box;
  CoeServer server;
  Ring ring{Ring::Options{}};
  CoeSlave slave;
  TimePoint now{std::chrono::seconds(1)};
  std::deque<Bytes> arriving;
  std::set<int> lost_out;
  std::set<int> lost_back;
  int frames = 0;
  std::vector<std::uint16_t> emergencies;
};

inline Bytes pattern(std::size_t size) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  return out;
}

inline Bytes emergency(std::uint16_t code) {
  return {0x00, 0x10, static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8), 0x81, 1, 2, 3,
          4,    5};
}

}  // namespace servoctl::ethercat
