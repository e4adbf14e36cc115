#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/object_address.hpp"
#include "base/result.hpp"
#include "drive/profile.hpp"

namespace servoctl::drive {

/// The family whose topics hold for every drive.
inline constexpr std::string_view kStandardFamily = "cia402";

/// One row of a topic's table: as many cells as the topic has columns, and what the row is about.
struct TopicRow {
  std::vector<std::string> cells;  ///< Numbers, signs and names of signals: the same in every language.
  std::string text;                ///< Empty where the cells say all.
  std::string text_zh;
  std::string line;  ///< As Topic::line.
};

/// What a manual says of one thing that is neither object, parameter nor fault: a connector, a display, a
/// mode, a homing method (docs/drive-data.md).
struct Topic {
  std::string family;  ///< In whose file it is.
  std::string kind;    ///< One of topic_kinds().
  std::string name;    ///< As the manual calls it; once in a file, whatever its case.
  std::vector<std::string> also;
  std::string title;
  std::string title_zh;
  std::string text;  ///< Paragraphs, with an empty line between them.
  std::string text_zh;
  std::vector<std::string> columns;
  std::vector<std::string> columns_zh;
  std::vector<TopicRow> rows;
  std::string picture;  ///< Drawn in characters, several lines.
  /// Words that cells and picture hold in English, and their Chinese; the longest first.
  std::vector<std::pair<std::string, std::string>> words_zh;
  std::string note;  ///< Where the manual contradicts itself or is wrong.
  std::string note_zh;
  bool assumed = false;                 ///< Something of it is not in the manual.
  bool figure = false;                  ///< The manual has part of it only as a picture.
  std::optional<ObjectAddress> object;  ///< With `value`: the topic is what this value of the object means.
  std::optional<std::int64_t> value;
  std::string network;               ///< Applies to this network alone: `can` or `ethercat`; empty: to all.
  std::optional<std::int64_t> mode;  ///< Applies where there is this mode of operation of CiA 402-2.
  std::string line;  ///< Lines of the manual, `6692-6711 6801`, or a clause of a standard: `CiA 301, 7.3.2`.
};

/// What a topic may be about: `wiring connector cable panel led …`.
std::span<const std::string_view> topic_kinds();

/// Whether the text says where something is: numbers or ranges of lines with blanks between them, or a
/// clause, which begins with a letter.
bool is_source_line(std::string_view text);

/// Reads `<family>.topics.toml`. Errc::file with file and line for an unknown key, a value of the wrong kind,
/// a row with another number of cells than there are columns, a text in one language only, a name that
/// appears twice, something that is missing.
Result<std::vector<Topic>> parse_topics(std::string_view toml, std::string_view file,
                                        std::string_view family);

/// The same of all topics that are right; adds everything that is wrong to `errors`.
std::vector<Topic> read_topics(std::string_view toml, std::string_view file, std::string_view family,
                               std::vector<Error>& errors);

/// The same, of each topic its kind, name, object and value, and whether it has a picture: what decides which
/// of two takes the place of the other. The rest may be missing and is not checked.
Result<std::vector<Topic>> parse_topic_heads(std::string_view toml, std::string_view file,
                                             std::string_view family);

/// The topics in the family's own file, none where it has none. Errors as parse_topics().
Result<std::vector<Topic>> load_own_topics(const Profile& profile);

/// All topics of a family: its own, those of its parents, those of the standard. One of the same name, or of
/// the same value of an object, takes the place of those behind it, unless only they have a picture. Without
/// topics of the standard that do not apply to the family (topic_scope.hpp). Errors as parse_topics().
Result<std::vector<Topic>> load_topics(const Profile& profile,
                                       std::span<const std::filesystem::path> folders);

/// The names of load_topics(), in a tenth of its time.
Result<std::vector<std::string>> topic_names(const Profile& profile,
                                             std::span<const std::filesystem::path> folders);

}  // namespace servoctl::drive
