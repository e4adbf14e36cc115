#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "base/bytes.hpp"
#include "mailbox_slave.hpp"

namespace servoctl::ethercat {

/// The SDO server of a slave, written from ETG.1000.6, 5.6.2, without a line of the client's.
class CoeServer {
 public:
  CoeServer(MailboxSlave& box, std::size_t answer_size) : box_(box), room_(answer_size - 6) {
    box.handler = [this](std::uint8_t type, Bytes data) { take(type, data); };
  }

  std::map<std::pair<unsigned, unsigned>, Bytes> objects;
  std::vector<Bytes> written;      ///< What was written to any object, in order.
  std::uint8_t abort_service = 3;  ///< Some abort in the service of requests.
  std::uint32_t refuses = 0;       ///< With this code.
  std::deque<Bytes> before;        ///< Messages that go in front of its next answers, one each.
  int initiated = 0;               ///< Requests that begin a transfer.
  int aborted = 0;                 ///< By the client.

 private:
  void take(std::uint8_t type, const Bytes& m) {
    EXPECT_EQ(type, 3);
    ASSERT_GE(m.size(), 10U) << "no SDO request is shorter";
    EXPECT_EQ(m[0], 0);
    EXPECT_EQ(m[1], 0x20) << "service 2";
    if (!before.empty()) {
      box_.reply(3, before.front());
      before.pop_front();
    }
    switch (m[2] >> 5) {
      case 2: return upload(m);
      case 1: return download(m);
      case 3: return upload_segment(m);
      case 0: return download_segment(m);
      case 4:
        ++aborted;
        state_ = State::idle;
        return;
      default: ADD_FAILURE() << "command " << int{m[2]};
    }
  }
  void answer(unsigned command, Bytes rest) {
    rest.insert(rest.begin(), {0x00, 0x30, static_cast<std::uint8_t>(command)});
    box_.reply(3, std::move(rest));
  }
  Bytes head(std::uint32_t value) const {
    return {static_cast<std::uint8_t>(object_.first),  static_cast<std::uint8_t>(object_.first >> 8),
            static_cast<std::uint8_t>(object_.second), static_cast<std::uint8_t>(value),
            static_cast<std::uint8_t>(value >> 8),     static_cast<std::uint8_t>(value >> 16),
            static_cast<std::uint8_t>(value >> 24)};
  }
  void abort(std::uint32_t code) {
    state_ = State::idle;
    auto rest = head(code);
    rest.insert(rest.begin(), {0x00, static_cast<std::uint8_t>(abort_service << 4), 0x80});
    box_.reply(3, std::move(rest));
  }
  void initiate(const Bytes& m) {
    ++initiated;
    object_ = {m[3] | m[4] << 8, m[5]};
    at_ = 0;
    toggle_ = 0;
  }

  void upload(const Bytes& m) {
    initiate(m);
    EXPECT_EQ(m.size(), 10U);
    const auto found = objects.find(object_);
    if (refuses != 0 || found == objects.end()) return abort(refuses != 0 ? refuses : 0x0602'0000);
    data_ = found->second;
    if (!data_.empty() && data_.size() <= 4) {
      auto rest = head(0);
      std::copy(data_.begin(), data_.end(), rest.begin() + 3);
      return answer(0x43 | (4 - static_cast<unsigned>(data_.size())) << 2, std::move(rest));
    }
    auto rest = head(static_cast<std::uint32_t>(data_.size()));
    at_ = std::min(data_.size(), room_ - 10);
    rest.insert(rest.end(), data_.begin(), data_.begin() + static_cast<std::ptrdiff_t>(at_));
    state_ = at_ < data_.size() ? State::uploading : State::idle;
    answer(0x41, std::move(rest));
  }
  void upload_segment(const Bytes& m) {
    if (state_ != State::uploading) return abort(0x0504'0001);
    if ((m[2] & 0x10) != toggle_) return abort(0x0503'0000);
    const auto size = std::min(data_.size() - at_, room_ - 3);
    Bytes rest(data_.begin() + static_cast<std::ptrdiff_t>(at_),
               data_.begin() + static_cast<std::ptrdiff_t>(at_ + size));
    at_ += size;
    unsigned command = toggle_ | (at_ == data_.size() ? 1U : 0U);
    if (size < 7) {
      command |= (7 - static_cast<unsigned>(size)) << 1;
      rest.resize(7);
    }
    toggle_ ^= 0x10;
    if (at_ == data_.size()) state_ = State::idle;
    answer(command, std::move(rest));
  }

  void download(const Bytes& m) {
    initiate(m);
    if (refuses != 0) return abort(refuses);
    if ((m[2] & 2) != 0) {
      EXPECT_EQ(m.size(), 10U);
      const auto size = static_cast<std::ptrdiff_t>(4 - (m[2] >> 2 & 3));
      data_.assign(m.begin() + 6, m.begin() + 6 + size);
      return store(0x60, head(0));
    }
    EXPECT_EQ(m[2] & 1, 1) << "its size is indicated";
    expected_ = m[6] | std::size_t{m[7]} << 8 | std::size_t{m[8]} << 16 | std::size_t{m[9]} << 24;
    data_.assign(m.begin() + 10, m.end());
    EXPECT_LE(data_.size(), expected_);
    if (data_.size() == expected_) return store(0x60, head(0));
    state_ = State::downloading;
    answer(0x60, head(0));
  }
  void download_segment(const Bytes& m) {
    if (state_ != State::downloading) return abort(0x0504'0001);
    if ((m[2] & 0x10) != toggle_) return abort(0x0503'0000);
    const auto unused = m.size() == 10 ? m[2] >> 1 & 7 : 0;
    data_.insert(data_.end(), m.begin() + 3, m.end() - unused);
    const unsigned command = 0x20 | toggle_;
    toggle_ ^= 0x10;
    if ((m[2] & 1) == 0) return answer(command, Bytes(7));
    EXPECT_EQ(data_.size(), expected_);
    store(command, Bytes(7));
  }
  void store(unsigned command, Bytes rest) {
    state_ = State::idle;
    written.push_back(data_);
    objects[object_] = data_;
    answer(command, std::move(rest));
  }

  enum class State { idle, uploading, downloading };
  MailboxSlave& box_;
  std::size_t room_;
  State state_ = State::idle;
  std::pair<unsigned, unsigned> object_;
  Bytes data_;
  std::size_t at_ = 0;
  std::size_t expected_ = 0;
  unsigned toggle_ = 0;
};

}  // namespace servoctl::ethercat
