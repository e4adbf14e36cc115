#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drive/topics.hpp"
#include "report/value.hpp"
#include "show/topic_query.hpp"

/// What `explain` tells: objects, parameters, faults and codes in the form of topics.
namespace servoctl::show {

/// One answer.
struct Explanation {
  drive::Topic topic;
  Found found = Found::text;
  std::vector<std::size_t> rows = {};  ///< Of the topic's table only these; empty: all.
  report::Value details = {};  ///< Of an object, parameter or fault: its record, or a table of several.
};

/// What is looked through for one family.
struct Library {
  const drive::Profile* profile = nullptr;
  std::vector<drive::Topic> topics;
  bool by_name_only = false;  ///< Nobody named the family: what has the very name, no words in texts.
};

/// All that the query means, the best first and in the order of the libraries. The codes of servoctl and CiA
/// 301 are told once, in the words of the first library.
std::vector<Explanation> explanations(const TopicQuery& query, std::span<const Library> libraries,
                                      bool chinese);

/// What to say where the query names a thing of which the family's manual says nothing; else empty.
std::string not_in_manual(const TopicQuery& query, const drive::Profile& profile);

/// The names that a query may have meant.
std::vector<std::string> explained_names(std::span<const Library> libraries);

/// Topics that stand in no file.
inline constexpr std::string_view kExitCodes = "exit codes";
inline constexpr std::string_view kAlStatusCodes = "AL status codes";

/// `exit 5`, and all of them: what the exit codes of the program mean (docs/scripting.md).
drive::Topic exit_code_topic();

/// What the codes of EtherCAT slaves mean, and what to do (ethercat/al_status.hpp).
drive::Topic al_status_topic();

/// Its record for scripts (docs/json.md).
report::Record explanation_record(const Explanation& explanation);

}  // namespace servoctl::show
