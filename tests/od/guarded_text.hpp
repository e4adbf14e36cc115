#pragma once

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <string_view>

namespace servoctl::od {

/// A copy of a text whose last byte is the last before memory that cannot be read: one byte too far ends the
/// test.
class GuardedText {
 public:
  explicit GuardedText(std::string_view text)
      : page_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))),
        readable_((text.size() / page_ + 1) * page_),
        memory_(static_cast<char*>(
            mmap(nullptr, readable_ + page_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))),
        text_(memory_ + readable_ - text.size(), text.size()) {
    EXPECT_NE(static_cast<void*>(memory_), MAP_FAILED);
    std::memcpy(memory_ + readable_ - text.size(), text.data(), text.size());
    EXPECT_EQ(mprotect(memory_ + readable_, page_, PROT_NONE), 0);
  }
  ~GuardedText() { munmap(memory_, readable_ + page_); }
  GuardedText(const GuardedText&) = delete;
  GuardedText& operator=(const GuardedText&) = delete;

  std::string_view text() const { return text_; }

 private:
  std::size_t page_;
  std::size_t readable_;
  char* memory_;
  std::string_view text_;
};

}  // namespace servoctl::od
