#include "can/blf.hpp"

#include <linux/can/error.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>

#include "base/format.hpp"
#include "can/byte_cursor.hpp"
#include "can/unpack.hpp"

namespace servoctl::can {
namespace {

constexpr std::string_view kFileMark = "LOGG";
constexpr std::string_view kObjectMark = "LOBJ";
constexpr std::size_t kBaseHeader = 16;
constexpr std::size_t kContainerHeader = 32;
/// Containers of Vector's tools have 128 kB.
constexpr std::size_t kMostUnpacked = std::size_t{64} << 20U;
constexpr std::size_t kMostObject = std::size_t{16} << 20U;
/// In front of an object, behind the one before.
constexpr std::size_t kMostPadding = 7;
constexpr std::uint64_t kLongestMicros = 100'000'000'000'000'000;

enum ObjectType : std::uint32_t {
  kBlfMessage = 1,
  kBlfError = 2,
  kBlfContainer = 10,
  kBlfErrorExt = 73,
  kBlfMessage2 = 86,
  kBlfFdMessage = 100,
  kBlfFdMessage64 = 101,
};

struct ObjectHead {
  std::size_t header = 0;  ///< Bytes in front of its data.
  std::uint16_t version = 0;
  std::size_t size = 0;
  std::uint32_t type = 0;
};

std::optional<ObjectHead> head_of(std::string_view bytes) {
  if (bytes.size() < kBaseHeader || !bytes.starts_with(kObjectMark)) return std::nullopt;
  ByteCursor in(bytes.substr(kObjectMark.size()));
  ObjectHead out;
  out.header = in.u16();
  out.version = in.u16();
  out.size = in.u32();
  out.type = in.u32();
  return out;
}

Frame blf_error_frame() {
  Frame out;
  out.error = true;
  out.id = CAN_ERR_PROT;
  out.size = CAN_ERR_DLC;
  return out;
}

/// Identifier with the flag of 29 bits, then length and data; false where that is no frame.
bool set_frame(std::uint32_t id, bool remote, std::size_t size, std::string_view data, Frame& out) {
  constexpr std::uint32_t kExtended = 0x8000'0000;
  out.extended = (id & kExtended) != 0;
  out.id = id & ~kExtended;
  out.remote = remote;
  out.size = static_cast<std::uint8_t>(std::min(size, out.data.size()));
  if (out.id > (out.extended ? 0x1FFF'FFFFU : 0x7FFU)) return false;
  if (out.payload().size() > data.size()) return false;
  std::copy_n(data.begin(), out.payload().size(), out.data.begin());
  return true;
}

enum class Object : std::uint8_t { frame, other, unsuited, malformed };

Object parse_message(std::string_view body, std::uint16_t& channel, Frame& out) {
  constexpr unsigned kRemote = 0x80;
  ByteCursor in(body);
  channel = in.u16();
  const auto flags = in.u8();
  const auto size = in.u8();
  const auto id = in.u32();
  const bool good = in.ok() && set_frame(id, (flags & kRemote) != 0, size, in.rest(), out);
  return good ? Object::frame : Object::malformed;
}

Object parse_fd_message(std::string_view body, std::uint16_t& channel, Frame& out) {
  ByteCursor in(body);
  channel = in.u16();
  const auto flags = in.u8();
  in.skip(1);
  const auto id = in.u32();
  in.skip(5);
  const auto fd_flags = in.u8();
  const auto size = in.u8();
  in.skip(5);
  if (!in.ok()) return Object::malformed;
  if ((fd_flags & 0x01U) != 0) return Object::unsuited;
  return set_frame(id, (flags & 0x80U) != 0, size, in.rest(), out) ? Object::frame : Object::malformed;
}

Object parse_fd_message64(std::string_view body, std::uint16_t& channel, Frame& out) {
  ByteCursor in(body);
  channel = in.u8();
  const auto code = in.u8();
  const auto size = in.u8();
  in.skip(1);
  const auto id = in.u32();
  in.skip(4);
  const auto flags = in.u32();
  in.skip(24);
  if (!in.ok()) return Object::malformed;
  if ((flags & 0x1000U) != 0) return Object::unsuited;
  const bool remote = (flags & 0x10U) != 0;
  return set_frame(id, remote, remote ? code : size, in.rest(), out) ? Object::frame : Object::malformed;
}

Object parse_object(const ObjectHead& head, std::string_view body, std::uint16_t& channel, Frame& out) {
  switch (head.type) {
    case kBlfMessage:
    case kBlfMessage2: return parse_message(body, channel, out);
    case kBlfFdMessage: return parse_fd_message(body, channel, out);
    case kBlfFdMessage64: return parse_fd_message64(body, channel, out);
    case kBlfError:
    case kBlfErrorExt:
      channel = ByteCursor(body).u16();
      out = blf_error_frame();
      return body.size() < 2 ? Object::malformed : Object::frame;
    default: return Object::other;
  }
}

/// In units of ten microseconds or, where the flags say so, nanoseconds.
Duration object_time(std::string_view object) {
  constexpr std::uint32_t kTenMicros = 1;
  ByteCursor in(object.substr(kBaseHeader));
  const auto flags = in.u32();
  in.skip(4);
  const auto stamp = in.u64();
  const auto micros = flags == kTenMicros ? std::min(stamp, kLongestMicros) * 10 : stamp / 1000;
  return Duration(static_cast<std::int64_t>(std::min(micros, kLongestMicros)));
}

/// When the measurement began, by the clock of the computer; none in a header that has no such date.
LogClock blf_clock(std::string_view header) {
  constexpr std::size_t kStart = 40;
  if (header.size() < kStart + 16) return {};
  ByteCursor in(header.substr(kStart));
  const int year = in.u16();
  const unsigned month = in.u16();
  in.skip(2);
  const unsigned day = in.u16();
  const auto hour = in.u16();
  const auto minute = in.u16();
  const auto second = in.u16();
  const auto millisecond = in.u16();
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                         std::chrono::day(day)};
  if (year < 1970 || year > 2999 || !date.ok() || hour > 23 || minute > 59 || second > 59 ||
      millisecond > 999)
    return {};
  return {LogClock::Kind::local, std::chrono::sys_days(date).time_since_epoch() + std::chrono::hours(hour) +
                                     std::chrono::minutes(minute) + std::chrono::seconds(second) +
                                     std::chrono::milliseconds(millisecond)};
}

class BlfReader {
 public:
  BlfReader(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options)
      : bytes_(&bytes), take_(&take), clock_(options.clock) {
    out_.records = true;
  }

  RecordingStrays read() {
    ByteCursor header(bytes_->ahead(8).substr(kFileMark.size()));
    const std::size_t begin = header.u32();
    if (!header.ok() || begin < 8 || begin > bytes_->ahead(begin).size()) {
      damaged(0, "its header is cut short");
      return std::move(out_);
    }
    if (clock_ != nullptr) *clock_ = blf_clock(bytes_->here().substr(0, begin));
    bytes_->drop(begin);
    while (!bytes_->at_end() && !ended_)
      if (!read_top()) break;
    if (!ended_ && !out_.damage && !pending_.empty() && pending_.find_first_not_of('\0') != std::string::npos)
      damaged(bytes_->offset(), "its last object is cut short");
    return std::move(out_);
  }

 private:
  void damaged(std::size_t offset, std::string what) {
    out_.damage = RecordingDamage{offset, std::move(what)};
  }

  void cut_short(std::size_t size, std::size_t left) {
    damaged(bytes_->offset(), formatted("an object of {} bytes begins there, and {} are left", size, left));
  }

  /// One object of the file itself: mostly a container. False: no more.
  bool read_top() {
    auto rest = bytes_->ahead(kBaseHeader);
    if (rest.size() < kBaseHeader && rest.find_first_not_of('\0') == std::string_view::npos) return false;
    const auto head = head_of(rest);
    if (!head) {
      damaged(bytes_->offset(),
              rest.size() < kBaseHeader ? "it ends in the middle of an object" : "no object begins there");
      return false;
    }
    rest = bytes_->ahead(head->size + 3);
    if (head->type == kBlfContainer && head->size > rest.size()) {
      // What was packed in front of the cut can be unpacked.
      (void)read_container(rest);
      if (!ended_) cut_short(head->size, rest.size());
      return false;
    }
    if (head->size < kBaseHeader || head->size > rest.size()) {
      cut_short(head->size, rest.size());
      return false;
    }
    const auto object = rest.substr(0, head->size);
    if (head->type != kBlfContainer)
      read_object(*head, object);
    else if (!read_container(object))
      return false;
    bytes_->drop(head->size + std::min(head->size % 4, rest.size() - head->size));
    return true;
  }

  bool read_container(std::string_view object) {
    constexpr std::uint16_t kPlain = 0;
    constexpr std::uint16_t kZlib = 2;
    ByteCursor in(object.substr(kBaseHeader));
    const auto method = in.u16();
    in.skip(6);
    const std::size_t size = in.u32();
    in.skip(4);
    if (!in.ok() || object.size() < kContainerHeader || (method != kPlain && method != kZlib)) {
      damaged(bytes_->offset(), formatted("a container of an unknown kind ({}) begins there", method));
      return false;
    }
    if (method == kPlain) {
      pending_ += in.rest();
    } else {
      const auto unpacked = unpack(in.rest(), std::min(size, kMostUnpacked));
      pending_ += unpacked.bytes;
      if (!unpacked.whole) {
        if (read_pending())
          damaged(bytes_->offset(), "the container there is damaged, or holds more than it says");
        return false;
      }
    }
    return read_pending();
  }

  /// The objects that are whole; the rest comes with the next container.
  bool read_pending() {
    std::string_view rest = pending_;
    while (!ended_) {
      const auto mark = rest.substr(0, kMostPadding + kObjectMark.size()).find(kObjectMark);
      if (mark == std::string_view::npos) {
        if (rest.size() >= kMostPadding + kObjectMark.size()) {
          damaged(bytes_->offset(), "the container there holds something that is no object");
          return false;
        }
        break;
      }
      const auto head = head_of(rest.substr(mark));
      if (!head) break;
      if (head->size < kBaseHeader || head->size > kMostObject) {
        damaged(bytes_->offset(), formatted("the container there holds an object of {} bytes", head->size));
        return false;
      }
      if (rest.size() - mark < head->size) break;
      read_object(*head, rest.substr(mark, head->size));
      rest.remove_prefix(mark + head->size);
    }
    pending_.erase(0, pending_.size() - rest.size());
    return !ended_;
  }

  void read_object(const ObjectHead& head, std::string_view object) {
    ++number_;
    // Both versions of the header have their time at the same place.
    constexpr std::size_t kHeader1 = 32;
    constexpr std::size_t kHeader2 = 40;
    const auto header = head.version == 2 ? kHeader2 : kHeader1;
    const bool has_header = (head.version == 1 || head.version == 2) && object.size() >= header;
    Frame frame;
    std::uint16_t channel = 0;
    const auto body = has_header ? object.substr(header) : std::string_view();
    const auto kind = parse_object(head, body, channel, frame);
    if (kind == Object::malformed) out_.add_unknown(number_);
    out_.unsuited += kind == Object::unsuited;
    if (kind == Object::frame) ended_ = !(*take_)({object_time(object), formatted("can{}", channel), frame});
  }

  ByteWindow* bytes_;
  const TakeLogFrame* take_;
  LogClock* clock_;
  std::string pending_;  ///< Out of containers, not read yet.
  std::size_t number_ = 0;
  bool ended_ = false;
  RecordingStrays out_;
};

}  // namespace

bool is_blf(std::string_view beginning) { return beginning.starts_with(kFileMark); }

RecordingStrays read_blf(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options) {
  return BlfReader(bytes, take, options).read();
}

}  // namespace servoctl::can
