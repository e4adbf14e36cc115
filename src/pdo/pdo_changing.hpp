#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/pdo.hpp"
#include "session/write_plan.hpp"
#include "show/desk.hpp"

/// What the commands that change PDOs share.
namespace servoctl::pdo {

/// The PDOs of one node as they are.
struct PresentPdos {
  std::uint8_t node = 0;
  session::Values values;
  std::vector<canopen::Pdo> pdos;

  const canopen::Pdo* find(const canopen::Pdo& like) const;
};

/// The PDOs of one node as they are to be: only those that are to change.
struct WantedPdos {
  std::vector<canopen::Pdo> pdos;
  session::Values assignments = {};  ///< Where the family assigns fixed PDOs.
};

/// Turns what is there into what is wanted. Errc::usage for what the node does not have.
using PdoEdit = std::function<Result<WantedPdos>(const PresentPdos& present)>;

/// How a change is carried out.
struct PdoChanging {
  bool keep = false;
  bool unlock = false;
  std::filesystem::path file = {};  ///< That says what is wanted, where one does.
};

/// Whether both are the PDO of one number and direction.
bool same_pdo(const canopen::Pdo& a, const canopen::Pdo& b);

/// The PDO of this name at this node. Errc::usage, with those it has.
Result<canopen::Pdo> find_pdo(const PresentPdos& present, std::string_view name);

/// Reads the PDOs of all nodes, lets `edit` say what is wanted, and checks it, all before the first write;
/// then changes node after node, each as a whole. With --dry-run the answer is the frames. Asks before it
/// writes: whoever sends and receives these PDOs is concerned. Failures of a node go to `desk.errors`.
/// While a node is written to, its PdoRecord stands; one that is the file is put back and goes away.
Result<report::Value> change_pdos(show::Desk& desk, const PdoEdit& edit, const PdoChanging& how);

/// A mapped object as it is named on the command line: `statusword`, `0x6041:0`, with the number of bits
/// where the dictionary does not tell it (`0x2105:1/16`), or a gap in an RPDO (`gap8`). Errc::usage.
Result<canopen::PdoEntry> parse_mapped(const drive::Profile& profile, std::string_view text);

/// A COB-ID's CAN-ID: `0x181`, or `$NODEID+0x180`; above 0x7FF, or in 8 hexadecimal digits, it has 29 bits
/// and canopen::kPdoExtended. Errc::usage.
Result<std::uint32_t> parse_can_id(std::string_view text, std::uint8_t node);

/// The same, for a PDO that is to be valid: a CAN-ID that CiA 301 keeps for another service (check_cob_id();
/// 0 is that of NMT, and stands for no other) is refused as well.
Result<std::uint32_t> parse_pdo_can_id(std::string_view text, std::uint8_t node);

/// Makes it valid, with a CAN-ID: the one it has, or that of the pre-defined connection set (CiA 301, 7.3.5).
/// Errc::usage where neither is known.
Result<void> switch_on(canopen::Pdo& pdo, std::uint8_t node);

/// Puts the mapping of a PDO without COB-ID among those its family exchanges, or takes it out, beside what
/// `out` and the drive assign already. Errc::usage where there is no room, or nothing assigns it.
Result<void> assign_pdo(const drive::Profile& profile, const PresentPdos& present, const canopen::Pdo& pdo,
                        bool add, session::Values& out);

}  // namespace servoctl::pdo
