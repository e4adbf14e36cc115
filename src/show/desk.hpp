#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "drive/load_unit.hpp"
#include "drive/profile.hpp"
#include "session/session.hpp"
#include "show/audience.hpp"

namespace servoctl::show {

/// What work on drives is done at: the bus and the data of the family, what holds for the whole line, who
/// looks on, and what there is to tell beside the result.
struct Desk {
  session::Session* session = nullptr;      ///< Set when the command needs a bus.
  const drive::Profile* profile = nullptr;  ///< Set when a family was named, or is needed.
  /// What CiA 301 and 402 say: for the names of standard objects where `profile` is null. May be null.
  const drive::Profile* standard = nullptr;
  std::vector<std::uint8_t> nodes;  ///< That are meant; 0 stands for all.
  /// Numbers that are given to drives: nobody may come there while a question waits.
  std::vector<std::uint8_t> free_nodes;
  /// What the loads of nodes move, where somebody said it: `20mm` means something there.
  std::map<std::uint8_t, drive::LoadUnit> loads;
  bool chinese = false;                ///< Names in Chinese where there are any.
  bool json = false;                   ///< What is said is read by programs: in English, but for names.
  bool dry_run = false;                ///< Show what would be sent, send nothing.
  bool keeps_samples = false;          ///< `--json`: the result carries what emit() was given.
  bool wants_records = false;          ///< `-o jsonl`: samples are shown as records, one a line.
  std::filesystem::path state_folder;  ///< For records of changes under way; empty: none are kept.
  Audience* audience = nullptr;        ///< Null: nobody.

  std::vector<Error> errors;     ///< Parts that failed while others succeeded; the first makes the exit code.
  std::vector<Message> notices;  ///< Things worth knowing that are no errors.

  /// As those of Audience.
  Result<void> confirm(std::string_view question) const;
  void emit(const report::Record& sample, std::string_view line) const;
  void write(std::string_view lines) const;
  void tell(std::string_view text) const;
  void show_progress(std::string_view line) const;
  void show_share(double share, TimePoint begin, TimePoint now) const;
  /// As tell(), of what is to be laid out: it fits the terminal.
  void tell_value(const report::Value& value) const;
  std::unique_ptr<LiveView> open_view(const LiveView::Layout& layout) const;
  /// Whether sentences and words beside the names are to be Chinese.
  bool speaks_chinese() const { return chinese && !json; }
  bool audience_is_gone() const { return audience != nullptr && audience->is_gone(); }
};

}  // namespace servoctl::show
