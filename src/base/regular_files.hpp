#pragma once

namespace servoctl {

/// While one of these lives in a thread, read_file() opens regular files alone (Errc::file for a device, a
/// pipe, a socket), of 32 MiB at most, and write_file_atomically() replaces no others: opening a serial port
/// moves its lines, what is read of a pipe is gone for its owner, and a FIFO may be waited for without end.
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
