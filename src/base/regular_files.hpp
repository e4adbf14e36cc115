#pragma once

namespace servoctl {

/// While one of these lives in a thread, read_file() opens regular files alone (Errc::file for a device, a
/// pipe, a socket): opening a serial port moves its lines, and what is read of a pipe is gone for its owner.
class RegularFilesOnly {
 public:
  RegularFilesOnly() { ++count_; }
  ~RegularFilesOnly() { --count_; }
  RegularFilesOnly(const RegularFilesOnly&) = delete;
  RegularFilesOnly& operator=(const RegularFilesOnly&) = delete;
  static bool hold() { return count_ > 0; }

 private:
  inline static thread_local int count_ = 0;
};

}  // namespace servoctl
