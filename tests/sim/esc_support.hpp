#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/bytes.hpp"
#include "drive/standard_objects.hpp"
#include "sim/esc_ring.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::sim {

/// `64 00` as bytes; a digit that is none fails the test.
inline Bytes hex(std::string_view text) {
  const auto parsed = parse_hex_bytes(text);
  EXPECT_TRUE(parsed) << text;
  return parsed.value_or(Bytes{});
}

/// Commands of a datagram, by their numbers.
enum : std::uint8_t {
  kNop,
  kAprd,
  kApwr,
  kAprw,
  kFprd,
  kFpwr,
  kFprw,
  kBrd,
  kBwr,
  kBrw,
  kLrd,
  kLwr,
  kLrw,
  kArmw,
  kFrmw
};

/// Simulated slaves of a family in a ring, and a master that is no more than bytes: nothing here comes from
/// src/ethercat.
class EscTest : public testing::Test {
 protected:
  /// What came back of a datagram; counter -1: nothing did.
  struct Reply {
    int counter = -1;
    Bytes data;
    Bytes header;
  };
  static constexpr std::uint16_t kStation = 0x1001;

  void load() {
    static const auto kLoaded = [] {
      const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
      return drive::load_profile("sv2", folders);
    }();
    ASSERT_TRUE(kLoaded) << kLoaded.error().message.text();
    profile_ = std::make_unique<drive::Profile>(*kLoaded);
    options_ = EscSlave::Options::of(*profile_);
  }
  /// So many slaves, with the station addresses 1001h, 1002h ….
  void build(std::size_t count = 1) {
    if (!profile_) load();
    for (std::size_t i = 0; i < count; ++i) {
      slaves_.push_back(
          std::make_unique<EscSlave>(*profile_, 1, memory_, "sv2-" + std::to_string(i), options_));
      ring_.attach(*slaves_.back(), now_);
    }
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_EQ(datagram(kApwr, static_cast<std::uint16_t>(-static_cast<int>(i)) | 0x0010'0000U,
                         store_le(kStation + i, 2))
                    .counter,
                1);
  }
  EscSlave& slave(std::size_t i = 0) { return *slaves_[i]; }

  /// The frame as it comes back; empty: it does not.
  Bytes send(const Bytes& frame) {
    ring_.on_frame(frame, now_);
    return ring_.take_frame().value_or(Bytes{});
  }
  static Bytes frame_of(const std::vector<Bytes>& datagrams) {
    Bytes out = hex("FFFFFFFFFFFF 101010101010 88A4 0000");
    std::size_t more_at = 0;
    for (const auto& each : datagrams) {
      if (more_at != 0) out[more_at] |= 0x80;
      more_at = out.size() + 7;
      out.insert(out.end(), each.begin(), each.end());
    }
    const auto length = out.size() - 16;
    out[14] = static_cast<std::uint8_t>(length);
    out[15] = static_cast<std::uint8_t>(0x10U | length >> 8U);
    out.resize(std::max<std::size_t>(out.size(), 60));
    return out;
  }
  /// `address` as it stands in the header: position or station below, register above, or logical.
  static Bytes datagram_of(std::uint8_t command, std::uint32_t address, const Bytes& data) {
    Bytes out{command, 0x55};
    for (unsigned shift = 0; shift < 32; shift += 8)
      out.push_back(static_cast<std::uint8_t>(address >> shift));
    out.push_back(static_cast<std::uint8_t>(data.size()));
    out.push_back(static_cast<std::uint8_t>(data.size() >> 8U));
    out.resize(10);
    out.insert(out.end(), data.begin(), data.end());
    out.resize(out.size() + 2);
    return out;
  }
  Reply datagram(std::uint8_t command, std::uint32_t address, const Bytes& data) {
    const auto back = send(frame_of({datagram_of(command, address, data)}));
    if (back.empty()) return {};
    const auto at = back.begin() + 26;
    const auto end = at + static_cast<std::ptrdiff_t>(data.size());
    return {end[0] | end[1] << 8U, Bytes(at, end), Bytes(back.begin() + 16, at)};
  }

  Reply read(std::uint16_t address, std::size_t size, std::uint16_t station = kStation) {
    return datagram(kFprd, static_cast<std::uint32_t>(address) << 16U | station, Bytes(size, 0));
  }
  int write(std::uint16_t address, const Bytes& data, std::uint16_t station = kStation) {
    return datagram(kFpwr, static_cast<std::uint32_t>(address) << 16U | station, data).counter;
  }
  int write(std::uint16_t address, std::string_view data, std::uint16_t station = kStation) {
    return write(address, hex(data), station);
  }
  /// The bytes of a register, `11 00`; `lost` when no slave answered.
  std::string show(std::uint16_t address, std::size_t size, std::uint16_t station = kStation) {
    const auto got = read(address, size, station);
    return got.counter == 1 ? to_hex(got.data) : "lost";
  }

  /// Until then, every deadline on the way.
  void run(Duration time) {
    for (const auto end = now_ + time; now_ < end;) {
      now_ = std::max(now_ + std::chrono::microseconds(1), std::min(end, ring_.deadline()));
      ring_.on_time(now_);
    }
  }

  // States.
  void set_up_mailboxes(std::uint16_t station = kStation) {
    EXPECT_EQ(write(0x0800, "0010 0001 26 00 01 00", station), 1);
    EXPECT_EQ(write(0x0808, "0014 0001 22 00 01 00", station), 1);
  }
  /// Writes 0120h; 0130h to 0135h as they are then.
  std::string request(unsigned control, std::uint16_t station = kStation) {
    EXPECT_EQ(write(0x0120, store_le(control, 2), station), 1);
    return al(station);
  }
  std::string al(std::uint16_t station = kStation) { return show(0x0130, 6, station); }
  void go_to_pre_op(std::uint16_t station = kStation) {
    set_up_mailboxes(station);
    ASSERT_EQ(request(2, station), "02 00 00 00 00 00");
  }

  // Mailbox: the counter runs, the whole sync manager is written and read.
  int post(const Bytes& message, std::uint8_t type = 3, std::uint16_t station = kStation) {
    counter_ = static_cast<std::uint8_t>(counter_ % 7 + 1);
    return post_raw(static_cast<std::uint8_t>(type | counter_ << 4U), message, station);
  }
  int post_raw(std::uint8_t type_and_counter, const Bytes& message, std::uint16_t station = kStation) {
    Bytes whole = store_le(message.size(), 2);
    whole.resize(5);
    whole.push_back(type_and_counter);
    whole.insert(whole.end(), message.begin(), message.end());
    whole.resize(mailbox_);
    return write(0x1000, whole, station);
  }
  /// The message that lies there with its header, without what the mailbox has behind it; empty: none.
  std::string fetch(std::uint16_t station = kStation) {
    const auto got = read(0x1400, mailbox_, station);
    if (got.counter != 1) return {};
    const auto length = load_le(ByteSpan(got.data).first(2));
    return to_hex(ByteSpan(got.data).first(std::min<std::size_t>(length + 6, got.data.size())));
  }
  /// The same without its header.
  std::string fetch_data(std::uint16_t station = kStation) {
    const auto message = fetch(station);
    return message.size() > 18 ? message.substr(18) : std::string();
  }
  /// An SDO request of eight bytes or more; the answer with number and service.
  std::string sdo(std::string_view request, std::uint16_t station = kStation) {
    auto message = hex("0020");
    const auto body = hex(request);
    message.insert(message.end(), body.begin(), body.end());
    EXPECT_EQ(post(message, 3, station), 1);
    return fetch_data(station);
  }

  TimePoint now_{std::chrono::seconds(1)};
  Memory memory_;
  std::unique_ptr<drive::Profile> profile_;
  EscSlave::Options options_;
  std::vector<std::unique_ptr<EscSlave>> slaves_;
  EscRing ring_;
  std::uint8_t counter_ = 0;
  std::size_t mailbox_ = 256;
};

}  // namespace servoctl::sim
