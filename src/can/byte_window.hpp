#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "can/descriptor.hpp"

namespace servoctl::can {

/// The bytes of a recording one after the other, of a text in memory or of a file or pipe; of the latter only
/// those that are looked at are kept.
class ByteWindow {
 public:
  explicit ByteWindow(std::string_view all) : rest_(all), ended_(true) {}
  /// Reads from the descriptor; `idle` is called before each wait for bytes that are not there yet.
  explicit ByteWindow(Descriptor source, std::function<void()> idle = {});
  ByteWindow(const ByteWindow&) = delete;
  ByteWindow& operator=(const ByteWindow&) = delete;

  /// What comes next: at least `wanted` bytes, or all that are left. It holds until the next call.
  std::string_view ahead(std::size_t wanted);
  /// What comes next, as far as it is here.
  std::string_view here() const { return rest_; }
  /// Makes here() longer; false at the end.
  bool read_more();
  void drop(std::size_t count);

  bool at_end() { return ahead(1).empty(); }
  /// Of the next byte, from the beginning.
  std::uint64_t offset() const { return offset_; }
  /// Why reading ended before the end of the file; 0 if it did not.
  int error() const { return error_; }

 private:
  void wait_for_bytes();

  Descriptor source_;
  std::function<void()> idle_;
  std::string buffer_;
  std::string_view rest_;
  std::uint64_t offset_ = 0;
  bool ended_ = false;
  int error_ = 0;
};

/// A file, or standard input where `path` is `-`. Errc::file when it cannot be opened or is a folder.
Result<Descriptor> open_recording(std::string_view path);

}  // namespace servoctl::can
