#include <set>

#include "base/format.hpp"
#include "base/pdo_index.hpp"
#include "session/write_plan.hpp"
#include "settings/backup_formats.hpp"
#include "settings/comparison.hpp"

namespace servoctl::settings {
namespace {

ObjectAddress cob_id_of(PdoPlace place) {
  place.mapping = false;
  return {index_of(place), 1};
}

/// A PDO whose COB-ID B does not have keeps its own: the lines make it invalid first, and valid at the end.
void add_cob_ids(const Side& a, session::Values& wanted) {
  session::Values own;
  for (const auto& [object, data] : wanted) {
    const auto place = pdo_at(object.index);
    if (!place || a.values.at(object) == data) continue;
    if (const auto ours = a.values.find(cob_id_of(*place)); ours != a.values.end()) own.emplace(*ours);
  }
  wanted.merge(own);
}

}  // namespace

std::vector<ObjectAddress> cob_ids_lacking(const drive::Profile& profile, const Side& side) {
  std::set<ObjectAddress> out;
  for (const auto& [object, data] : side.values) {
    const auto place = pdo_at(object.index);
    if (!place) continue;
    const auto cob_id = cob_id_of(*place);
    if (side.values.count(cob_id) == 0 && profile.dictionary.find(cob_id) != nullptr) out.insert(cob_id);
  }
  return {out.begin(), out.end()};
}

std::vector<std::string> lines_between(const drive::Profile* profile, const Side& a, const Side& b,
                                       bool whole) {
  session::Values present;
  session::Values wanted;
  std::vector<std::string> comments;
  for (const auto& [object, theirs] : b.values) {
    const auto data = for_node(profile, object, theirs, b.node, a.node);
    const auto ours = a.values.find(object);
    const bool both = ours != a.values.end();
    const auto line =
        both && ours->second != data ? write_line(profile, a.node, object, data) : std::string();
    if (!both && whole)
      comments.push_back(formatted("# {} alone has {}", comment_text(b.title), to_string(object)));
    else if (!line.empty() && is_address(profile, object))
      comments.push_back("# not changed: " + line);
    else if (!line.empty() && !may_be_written(profile, object))
      comments.push_back(formatted("# {}: {}", kNotKnownWritable, line));
    else if (both)
      wanted.emplace(object, data);
  }
  add_cob_ids(a, wanted);
  for (const auto& [object, ours] : a.values) {
    if (wanted.count(object) > 0) present.emplace(object, ours);
    if (whole && b.values.count(object) == 0 && wanted.count(object) == 0)
      comments.push_back(formatted("# {} alone has {}", comment_text(a.title), to_string(object)));
  }
  std::vector<std::string> out;
  if (profile != nullptr) out.push_back(formatted("drive {}", batch_word(profile->family)));
  out.push_back(formatted("use {}", a.node));
  for (const auto& step : session::plan_writes(profile, present, wanted))
    out.push_back(commented_line(profile, a.node, step.object, step.data));
  out.insert(out.end(), comments.begin(), comments.end());
  return out;
}

}  // namespace servoctl::settings
