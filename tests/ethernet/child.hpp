#pragma once

#include <signal.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace servoctl::ethernet {

/// Runs a function in a child process, which is killed at the latest by the destructor. The function gets
/// what tells the parent that it is ready; the constructor waits for that, or for the end of the child.
class Child {
 public:
  template <class Function>
  explicit Child(Function function) {
    std::array<int, 2> pipe{};
    if (::pipe(pipe.data()) != 0) return;
    id_ = ::fork();
    if (id_ == 0) {
      ::close(pipe[0]);
      function([&] {
        const char byte = 1;
        if (::write(pipe[1], &byte, 1) != 1) ::_exit(1);
      });
      ::_exit(0);
    }
    ::close(pipe[1]);
    char byte = 0;
    is_ready_ = ::read(pipe[0], &byte, 1) == 1;
    ::close(pipe[0]);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { kill(); }

  ::pid_t id() const { return id_; }
  bool is_ready() const { return is_ready_; }
  void stop() const { signal(SIGSTOP); }
  /// Returns when it is gone.
  void kill() {
    signal(SIGKILL);
    if (id_ > 0) ::waitpid(std::exchange(id_, -1), nullptr, 0);
  }

 private:
  void signal(int number) const {
    if (id_ > 0) ::kill(id_, number);
  }

  ::pid_t id_ = -1;
  bool is_ready_ = false;
};

}  // namespace servoctl::ethernet
