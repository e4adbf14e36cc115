#pragma once

#include <dirent.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "can/descriptor.hpp"

namespace servoctl::can {

/// Whether a virtual bus can have this name: 1 to 32 of A-Z a-z 0-9 . _ -; Errc::usage.
Result<void> check_local_name(std::string_view name);

/// The directory of one virtual bus. It holds a datagram socket for each member, `member-PID-N`, and the file
/// `lock`.
///
/// Who sends or joins holds the lock: so all members see the frames in one order, as on a wire, and a file
/// whose socket refuses belongs to a dead process and not to one that is about to join. The system gives the
/// lock back when a process dies.
class LocalDirectory {
 public:
  /// Makes it where needed: in $XDG_RUNTIME_DIR, /run/user/UID, or /tmp/servoctl-UID, the first that there
  /// is. Nobody else may have access to it (Errc::bus).
  static Result<LocalDirectory> open(std::string_view bus_name);

  const std::string& path() const { return path_; }
  bool try_lock() const;
  void unlock() const;
  /// Binds the socket to a name that no other has, and returns the name. Needs the lock.
  Result<std::string> join(int socket) const;
  /// The names of all members, dead ones included.
  std::vector<std::string> members() const;
  void remove(const std::string& member) const;
  /// Binds the socket to this name; what a dead process left there gives way. Needs the lock.
  Result<void> bind(int socket, const std::string& name) const;
  /// Connects the socket to the one of this name, without waiting: 0, or a value of errno.
  int connect(int socket, const std::string& name) const;

  enum class Delivery { done, full, gone };
  /// Gives the datagram to one member, without waiting.
  Delivery deliver(int socket, std::span<const std::uint8_t> datagram, const std::string& member) const;

 private:
  struct Close {
    void operator()(DIR* directory) const { ::closedir(directory); }
  };
  using Listing = std::unique_ptr<DIR, Close>;

  LocalDirectory(std::string path, Listing listing, Descriptor lock)
      : path_(std::move(path)), listing_(std::move(listing)), lock_(std::move(lock)) {}

  std::string path_;
  Listing listing_;
  Descriptor lock_;
};

}  // namespace servoctl::can
