#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "settings/backup_file.hpp"

/// The formats of a backup, each with its text and its reader. `file` is used in messages. Only JSON says all
/// of a backup; what the others read has object, bytes, type and line, and settle() adds the rest.
namespace servoctl::settings {

std::string json_text(const drive::Profile* profile, const Backup& backup);
Result<Backup> read_json_backup(std::string_view text, const std::string& file);

/// The family's data sheet with the values (od::write_dcf()). An entry that cannot stand in it is told in
/// `notices`.
Result<std::string> dcf_text(const drive::Profile& profile, const Backup& backup,
                             const std::string& file_name, std::vector<Message>& notices);
Result<Backup> read_dcf_backup(std::string_view text, const std::string& file, std::uint8_t node);

/// `node,index,sub,parameter,name,type,value,unit,raw,left_out`: `raw` is what the drive holds (`hex:58 02`),
/// and `value` the number in its unit.
std::string csv_text(const drive::Profile& profile, const Backup& backup);
/// Needs `index` and `raw` or `value`. A row whose value and raw differ is refused: one of them was edited.
Result<Backup> read_csv_backup(std::string_view text, const std::string& file, const drive::Profile& profile,
                               std::uint8_t node);

/// Lines for `run`: `param set` and `write`, PDOs by the procedure of CiA 301. Node-ID and bitrate are
/// comments.
std::string batch_text(const drive::Profile& profile, const Backup& backup);
/// Takes lines that write, choose (`use`, `drive`) and nothing else, all for one node. An object written
/// several times is one of a PDO's procedure (the last value counts), or refused.
Result<Backup> read_batch_backup(LineReader& lines_of, std::string_view text, const std::string& file,
                                 const drive::Profile& profile, std::uint8_t node);
/// Whether nothing says that the object is read-only, as a file that was learned does of what it does not
/// know (drive::is_access_unknown()).
bool may_be_written(const drive::Profile* profile, ObjectAddress object);
/// Before a line that is only shown because that is not so.
inline constexpr std::string_view kNotKnownWritable = "not known to be writable";
/// The family's limits, where the value a drive held is outside of them; empty when it is not.
std::string range_missed(const drive::Profile& profile, std::uint8_t node, ObjectAddress object,
                         const Bytes& data);

/// A word as a batch file takes it: in quotes where it has anything but letters, digits and plain signs.
std::string batch_word(const std::string& word);
/// Whether a line can carry the text as it is: UTF-8, nothing in it that cannot be seen.
bool fits_a_line(std::string_view text);
/// The text as a comment behind a line: in one line, and not going on in the next.
std::string comment_text(std::string_view text);

/// A value in words that give these bytes again.
struct WordedValue {
  std::string name;    ///< Number of the panel, else the address of the object.
  std::string value;   ///< `600`, `0x00000181`, `hex:01 02`.
  bool panel = false;  ///< `name` is a number of the panel.
  bool typed = false;  ///< The data do not tell the type: it has to be said beside the value.
  od::DataType type = od::DataType::u32;
};
WordedValue worded_value(const drive::Profile* profile, std::uint8_t node, ObjectAddress object,
                         const Bytes& data);

/// One line that writes the value: `param set Pn0214=600`, `write 0x6065:0 1000`. Text stands in quotes
/// behind
/// `--`, whatever it is: `write 0x2000:0 -- "--from=x"`.
std::string write_line(const drive::Profile* profile, std::uint8_t node, ObjectAddress object,
                       const Bytes& data);

/// The same with the object's name behind it.
std::string commented_line(const drive::Profile* profile, std::uint8_t node, ObjectAddress object,
                           const Bytes& data);

/// A concise DCF: the number of entries (u32), then index (u16), sub-index (u8), size (u32) and data of each,
/// little endian (CiA 302-3, object 1F22h). Entries are numbered from 1 in messages.
Result<Backup> read_concise_dcf(std::string_view bytes, const std::string& file);

/// Adds what the family knows to what a file of another format than JSON says: id, name, type. Leaves out,
/// with the reason, what is no setting. Takes out as unusable an object the family does not know, one that
/// appears twice (unless `procedure`, and of a PDO: then the last counts), and bytes of another length.
void settle(Backup& backup, const std::string& file, const drive::Profile& profile, bool procedure);

}  // namespace servoctl::settings
