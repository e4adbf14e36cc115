#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "ethercat/request.hpp"
#include "ethercat/sii_image.hpp"

namespace servoctl::ethercat {

/// The mailbox of a slave, written from ETG.1000.4, 5.6 and 6.7, without a line of the master's: sync
/// managers 0 and 1 with their registers, its counter, repetitions. What it is to do with a message is a
/// function's.
class MailboxSlave {
 public:
  enum class Loss { none, on_the_way_out, on_the_way_back, uncounted };
  using Handler = std::function<void(std::uint8_t type, Bytes data)>;

  explicit MailboxSlave(SiiMailbox place) : place_(place), out_(place.in_size) {}

  Handler handler;                                    ///< Called for each message that it takes.
  std::function<Loss(const Request&)> loss;           ///< Of each frame.
  Duration latency = std::chrono::microseconds(300);  ///< Until a message is taken out of SM0.
  bool stuck = false;                                 ///< Takes nothing any more.
  bool gone = false;
  bool repeats = true;        ///< Gives the last message again when asked for.
  bool drops_doubles = true;  ///< A message with the number of the one before is none.
  std::vector<std::uint8_t> numbers{1, 2, 3, 4, 5, 6, 7};  ///< Of its own messages, round and round.
  std::vector<Bytes> written;                              ///< All that was written to SM0, whole.
  int reads = 0;

  void reply(std::uint8_t type, Bytes data) {
    Bytes box(place_.in_size, 0xCC);  // What is behind the message is whatever was there.
    box.at(0) = static_cast<std::uint8_t>(data.size());
    box.at(1) = static_cast<std::uint8_t>(data.size() >> 8U);
    box.at(2) = box.at(3) = box.at(4) = 0;
    box.at(5) = static_cast<std::uint8_t>(type | numbers[number_++ % numbers.size()] << 4U);
    for (std::size_t i = 0; i < data.size(); ++i) box.at(6 + i) = data[i];
    queue_.push_back(std::move(box));
    fill();
  }
  /// As it stands, whatever it says.
  void reply_raw(Bytes box) {
    box.resize(place_.in_size);
    queue_.push_back(std::move(box));
    fill();
  }

  /// What its own processor does until now.
  void run(TimePoint now) {
    if (!in_ || stuck || now < ready_) return;
    const auto box = std::move(*in_);
    in_.reset();
    const auto number = box[5] >> 4U & 7U;
    if (drops_doubles && number != 0 && number == last_number_) return;
    last_number_ = number;
    const auto size = static_cast<std::size_t>(box[0] | box[1] << 8U);
    ASSERT_LE(size + 6, box.size());
    if (handler)
      handler(box[5] & 0x0FU, Bytes(box.begin() + 6, box.begin() + 6 + static_cast<std::ptrdiff_t>(size)));
  }
  TimePoint next() const { return in_ && !stuck ? ready_ : kNever; }

  /// One datagram passes; data() has what it brings back. The working counter that it comes back with.
  std::uint16_t process(const Request& request, TimePoint now) {
    return gone ? std::uint16_t{0} : pass(request, now);
  }
  ByteSpan data() const { return reply_; }

  /// One frame with one datagram, there and back.
  Answer answer(const Request& request, TimePoint now) {
    run(now);
    const auto how = loss ? loss(request) : Loss::none;
    if (how == Loss::on_the_way_out) return {{}, 0, true, now};
    const auto counter = process(request, now);
    if (how == Loss::on_the_way_back) return {{}, 0, true, now};
    return {reply_, how == Loss::uncounted ? std::uint16_t{0} : counter, false, now};
  }

 private:
  std::uint16_t pass(const Request& request, TimePoint now) {
    const auto where = static_cast<std::uint16_t>(request.address >> 16U);
    const auto size = request.data.size();
    reply_ = request.data;
    if (request.command == Command::fpwr && where == place_.out_start) {
      EXPECT_EQ(size, place_.out_size) << "the last byte hands it over";
      if (in_) return 0;
      in_ = request.data;
      written.push_back(request.data);
      ready_ = now + latency;
      return 1;
    }
    if (request.command == Command::fprd && where == place_.in_start) {
      EXPECT_EQ(size, place_.in_size);
      if (!full_) return 0;
      ++reads;
      reply_ = out_;
      last_ = out_;
      full_ = false;
      fill();
      return 1;
    }
    if (request.command == Command::fpwr && where == 0x080E) {
      EXPECT_EQ(size, 1U);
      EXPECT_EQ(request.data[0] & 0x01, 0x01) << "it stays enabled";
      if (((request.data[0] ^ activate_) & 2U) != 0) repeat();
      activate_ = request.data[0];
      return 1;
    }
    EXPECT_EQ(request.command, Command::fprd) << "at " << where;
    EXPECT_GE(where, 0x0800);
    EXPECT_LE(where + size, 0x0810U);
    for (std::size_t i = 0; i < size; ++i) reply_[i] = register_at(static_cast<std::uint16_t>(where + i));
    return 1;
  }
  std::uint8_t register_at(std::uint16_t where) const {
    switch (where) {
      case 0x0805: return in_ ? 0x08 : 0x00;
      case 0x080D: return full_ ? 0x08 : 0x00;
      case 0x0806: return 0x01;
      case 0x080E: return activate_;
      case 0x080F: return processor_;
      default: return 0;
    }
  }
  void repeat() {
    processor_ ^= 0x02U;
    if (!repeats || last_.empty()) return;
    if (full_) queue_.push_front(out_);
    out_ = last_;
    full_ = true;
  }
  void fill() {
    if (full_ || queue_.empty()) return;
    out_ = std::move(queue_.front());
    queue_.pop_front();
    full_ = true;
  }

  SiiMailbox place_;
  std::optional<Bytes> in_;
  TimePoint ready_;
  Bytes out_;
  bool full_ = false;
  Bytes last_;
  std::deque<Bytes> queue_;
  std::uint8_t activate_ = 1;
  std::uint8_t processor_ = 0;
  unsigned last_number_ = 0;
  std::size_t number_ = 0;
  Bytes reply_;
};

}  // namespace servoctl::ethercat
