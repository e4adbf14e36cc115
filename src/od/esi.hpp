#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/object_address.hpp"
#include "base/pdo_index.hpp"
#include "base/result.hpp"
#include "od/data_type.hpp"
#include "od/eds.hpp"

namespace servoctl::od {

/// A device of an ESI file: what EtherCAT masters know it by.
struct EsiDevice {
  std::string type;  ///< `SV660N`: the text of Type.
  std::string name;  ///< In English where the file has that.
  std::string name_zh;
  std::string group;
  std::uint32_t product_code = 0;
  std::uint32_t revision = 0;
  std::uint32_t line = 0;
};

/// What stands in a PDO. `object` is 0 for bits that fill a gap.
struct EsiPdoEntry {
  ObjectAddress object;
  std::uint8_t bits = 0;
  std::string name;
  std::string name_zh;
  std::optional<DataType> type;
  std::uint32_t line = 0;
};

struct EsiPdo {
  PdoDirection direction = PdoDirection::receive;
  std::uint16_t index = 0;
  std::string name;
  bool fixed = false;                        ///< Its mapping cannot be changed.
  bool mandatory = false;                    ///< It is always assigned.
  std::optional<std::uint8_t> sync_manager;  ///< Assigned to it unless told otherwise.
  std::vector<EsiPdoEntry> entries;
  std::uint32_t line = 0;

  std::size_t bits() const;
};

/// A sync manager: a piece of the slave's memory that is handed over as a whole.
struct EsiSyncManager {
  enum class Use : std::uint8_t { other, mailbox_out, mailbox_in, outputs, inputs };
  Use use = Use::other;
  std::uint16_t start = 0;
  std::uint16_t size = 0;  ///< Bytes by default.
  std::optional<std::uint16_t> least;
  std::optional<std::uint16_t> most;
  std::uint8_t control = 0;
  bool enabled = true;
  std::uint32_t line = 0;
};

/// How a device is synchronised; cycle and shift in ns, 0 where the master chooses.
struct EsiOpMode {
  std::string name;
  std::string description;
  std::uint16_t assign_activate = 0;  ///< 0: without distributed clocks.
  std::int64_t cycle_sync0 = 0;
  std::int64_t shift_sync0 = 0;
};

/// What an ESI says of the device beside its objects.
struct EsiLayout {
  std::vector<EsiSyncManager> sync_managers;
  std::vector<std::string> fmmus;  ///< `Outputs`, `Inputs`, `MBoxState`
  std::vector<EsiPdo> pdos;
  std::vector<EsiOpMode> modes;
  bool coe = false;
  bool sdo_info = false;
  bool pdo_assign = false;
  bool pdo_config = false;
  bool complete_access = false;
  std::size_t eeprom_bytes = 0;

  const EsiSyncManager* find(EsiSyncManager::Use use) const;
};

/// A device of an ESI read in full: everything usable, and everything that was not.
struct EsiFile {
  EsiDevice device;
  std::size_t number = 1;   ///< Which device of the file it is, from 1.
  std::size_t devices = 1;  ///< How many there are.
  EsiLayout layout;
  EdsFile sheet;  ///< Its dictionary and what was found.
};

/// Of the size of files with many devices; what is larger is refused unread.
constexpr std::size_t kMostEsiBytes = 64U << 20U;

/// Reads an EtherCAT slave information file (ETG.2000), in the encoding it declares or any that to_utf8()
/// tells. `device` chooses among several: a number from 1, a type, a name, or a product code (`0x1234`, with
/// `:` and the revision where several have it). A bad object is reported and skipped. Errc::file when the
/// file is no ESI or not well-formed, Errc::usage when it is not clear which device is meant: the hint lists
/// them.
Result<EsiFile> read_esi(std::string_view bytes, std::string_view file, std::string_view device = {});

/// All devices of a file, each read in full.
Result<std::vector<EsiFile>> read_all_esi(std::string_view bytes, std::string_view file);

}  // namespace servoctl::od
