#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "base/result.hpp"
#include "can/bus.hpp"
#include "can/link.hpp"

namespace servoctl::can {

/// What is to be changed of an interface; what is empty stays. The kernel takes all of it in one message, and
/// changes bitrate, sample point, restart and listening only while the interface is down.
struct LinkChange {
  std::optional<bool> up = {};
  std::optional<std::uint32_t> bitrate = {};       ///< In bit/s.
  std::optional<std::uint16_t> sample_point = {};  ///< In thousandths of a bit; goes with a bitrate.
  std::optional<std::uint32_t> restart_ms = {};
  std::optional<bool> listen_only = {};
  std::optional<std::uint32_t> queue_length = {};
};

/// The question for one interface by its number (RTM_GETLINK), and the change of one (RTM_NEWLINK).
Bytes link_question(unsigned index);
Bytes link_message(unsigned index, const LinkChange& change);

/// The same as a command of iproute2: `ip link set can0 up type can bitrate 500000`.
std::string ip_command(const std::string& name, const LinkChange& change);

/// Why the kernel did not make a change, in words, and what to do: `error` is its value of errno, `words` its
/// own. `now` is the interface as it is.
Error link_refusal(const std::string& name, const LinkChange& change, const LinkState& now, int error,
                   const std::string& words);

/// Whether this process may change interfaces (CAP_NET_ADMIN), as the kernel says: it is asked for a change
/// of no interface. Empty where it does not answer.
std::optional<bool> may_change_links();
/// The same from its answer: a value of errno.
std::optional<bool> may_change_links(int error);
/// The command that gives the right.
std::string right_command();

/// One interface, as far as its settings go: the kernel's, or that of a test.
class LinkControl {
 public:
  LinkControl() = default;
  LinkControl(const LinkControl&) = delete;
  LinkControl& operator=(const LinkControl&) = delete;
  virtual ~LinkControl() = default;

  virtual const std::string& name() const = 0;
  /// Errc::bus when it is gone.
  virtual Result<LinkState> state() = 0;
  /// Errors as link_refusal(): Errc::usage for what it cannot have, Errc::bus for the rest.
  virtual Result<void> change(const LinkChange& change) = 0;
  /// Hears all that is to be heard: frames of both kinds of identifier, and every report of the controller.
  /// Errors as open_socketcan().
  virtual Result<std::unique_ptr<Bus>> listen() = 0;
};

/// An interface of the kernel. Errc::usage when the name cannot be one; Errc::bus when there is none of this
/// name, or it is no CAN interface.
Result<std::unique_ptr<LinkControl>> open_link(const std::string& name);

/// Puts an interface back to what it was: on every way out, unless it is kept as it is.
class LinkKeeper {
 public:
  LinkKeeper(LinkControl& link, LinkState before) : link_(&link), before_(std::move(before)) {}
  LinkKeeper(const LinkKeeper&) = delete;
  LinkKeeper& operator=(const LinkKeeper&) = delete;
  ~LinkKeeper() { (void)put_back(); }

  const LinkState& before() const { return before_; }
  /// At once. An interface that had no bitrate keeps the last one, and is down.
  Result<void> put_back();
  /// It stays as it is now.
  void keep() { link_ = nullptr; }

 private:
  LinkControl* link_;
  LinkState before_;
};

}  // namespace servoctl::can
