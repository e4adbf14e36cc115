#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "session/addressing.hpp"
#include "session/identity.hpp"
#include "session/storage.hpp"
#include "session/write_plan.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// What a drive is to be addressed by; what is empty stays as it is.
struct AddressWish {
  std::optional<std::uint8_t> node = {};      ///< 1 to 127.
  std::optional<std::uint32_t> bitrate = {};  ///< bit/s
  /// What the bus has, where that is known: a drive that is restarted to move must not come up at another
  /// one.
  std::optional<std::uint32_t> bus_bitrate = {};
  std::optional<std::uint32_t> serial = {};  ///< 1018h:04 of the drive that is meant; another one is refused.
};

/// What leads one drive to its new address.
struct AddressChange {
  std::uint8_t node = 0;
  std::uint8_t to = 0;                   ///< `node` where it stays.
  std::uint8_t told_at = 0;              ///< For a plan: where it will be when it is written to; 0: `node`.
  std::optional<std::uint32_t> bitrate;  ///< What it has from its next start on, where one was wished.
  session::Identity identity;
  const drive::Profile* profile = nullptr;  ///< Of its family.
  std::vector<session::SdoRequest> writes;
  std::vector<Bytes> before;  ///< What the objects of `writes` hold now.
  session::Values cob_ids;    ///< Those of its PDOs and of its emergencies.
  drive::NmtRules::Restart restart = drive::NmtRules::Restart::power_cycle;

  bool moves() const { return to != node; }
  bool idle() const { return writes.empty() && !moves(); }
  /// A drive with another bitrate must not start before the others have it: then nothing is restarted.
  bool restarts() const { return !bitrate && restart != drive::NmtRules::Restart::power_cycle; }
};

/// While it lives the work at this desk is done by the data of this family.
class FamilyScope {
 public:
  FamilyScope(show::Desk& desk, const drive::Profile* profile)
      : desk_(&desk), before_(std::exchange(desk.profile, profile)) {}
  FamilyScope(const FamilyScope&) = delete;
  FamilyScope& operator=(const FamilyScope&) = delete;
  ~FamilyScope() { desk_->profile = before_; }

 private:
  show::Desk* desk_;
  const drive::Profile* before_;
};

/// Looks at a drive and finds what has to be written; only reads. Errc::usage where the family has no
/// parameter of the node-ID or the bitrate, or no such value; Errc::refused for a drive with another serial
/// number, one that is energised, two of one number, and one that would come up at another bitrate than that
/// of its bus when it starts at its new node-ID; else as Session::upload().
Result<AddressChange> plan_address(show::Desk& desk, std::uint8_t node, const AddressWish& wish);

/// Errc::refused when the drive has power on its motor, and where two were noticed under this number, when
/// either has; else as Session::upload(). One that has no statusword has none. `what` would change under it:
/// "its address".
Result<void> refuse_energised(session::Session& session, std::uint8_t node, std::string_view what);
/// The same of every node that answers a scan(), for what changes the bus under all of them.
Result<void> refuse_energised_nodes(session::Session& session, std::string_view what);

/// Errc::refused, with what shows it, when somebody uses one of these node-IDs; as nodes_in_use(). A notice
/// where the bus cannot ask those that are stopped; a dry run does not.
Result<void> refuse_taken(show::Desk& desk, std::span<const std::uint8_t> nodes,
                          Duration listening = session::kAddressListening);

/// A notice, once, where those that are stopped cannot be asked whether they are there.
void tell_unguarded(show::Desk& desk);

/// How it ended.
enum class AddressEnd : std::uint8_t {
  nothing_to_do,
  moved,           ///< Found at its new address, the same drive.
  at_bitrate,      ///< Found at its new bitrate, and at its new address if it has one, the same drive.
  awaits_restart,  ///< Written and read back; it holds when the drive is switched off and on.
  as_before,       ///< It failed, and its parameters hold what they held.
  failed           ///< The error says where the drive is, as far as that is known.
};
std::string_view text_of(AddressEnd end);

struct AddressOptions {
  bool unlock = false;  ///< Gives the family's password.
  Duration patience{};  ///< How long a drive that is to be switched off and on is waited for; 0: not at all.
};

/// What came of it.
struct AddressOutcome {
  AddressEnd end = AddressEnd::failed;
  session::Kept kept = session::Kept::unknown;
  std::optional<Error> error;
  std::vector<ObjectAddress> stayed;  ///< COB-IDs with the old node-ID in them.
};

/// Writes the address, reads it back and stores it by the family's way, restarts the drive where that is done
/// over the bus, and looks for it at its new address: the same identity, and nobody at the old one. Where a
/// write or the storing fails, the old values are written back and nothing is restarted. From the first write
/// to the restart Ctrl-C is not heard. Nobody is asked; notices go to the desk.
AddressOutcome change_address(show::Desk& desk, const AddressChange& change, const AddressOptions& options);

/// Looks, as change_address() does, for a drive that was restarted since: `so_far` is what came of it before.
AddressOutcome find_again(show::Desk& desk, const AddressChange& change, AddressOutcome so_far);

/// The frames of that in their order, as `--dry-run` shows them.
Result<report::Value> planned_address(show::Desk& desk, std::span<const AddressChange> changes, bool unlock);

/// What somebody has to do by hand so that the new bitrate holds on this bus, a line each. `family` is that
/// of all drives; empty: they are of several, which no command line changes together.
std::vector<std::string> bitrate_steps(const std::string& bus_url, std::uint32_t bitrate,
                                       const std::string& family);

}  // namespace servoctl::settings
