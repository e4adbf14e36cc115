#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "drive/profile.hpp"
#include "show/explanation.hpp"

/// What explanations() is made of. Each adds what the query means to the end of `out`.
namespace servoctl::show {

/// A topic that stands in no file.
drive::Topic topic_heading(std::string_view family, std::string kind, std::string name, std::string title,
                           std::string title_zh);

/// The lines of the manual behind a line of a table.
std::string source_of_line(std::uint32_t line);

void add_faults(const TopicQuery& query, const drive::Profile& profile, bool by_name_only, bool chinese,
                std::vector<Explanation>& out);

/// Faults that the panel shows by a name and this number alone: `15` behind a word for them is `Er.15`.
void add_counted_faults(std::string_view number, const Library& library, bool chinese,
                        std::vector<Explanation>& out);

/// Eight hexadecimal digits: of a class that CiA 301 has, or one that the family's own words tell of.
void add_abort(const TopicQuery& query, const drive::Profile& profile, std::vector<Explanation>& out);

/// An object or parameter and a value: `statusword 0x1288`, `6060h=3`.
void add_value(const TopicQuery& query, const Library& library, std::vector<Explanation>& out);

/// A number of 16 bits that nothing is called by: as error code, with its class, as status- and controlword.
void add_number(const TopicQuery& query, const drive::Profile& profile, std::vector<Explanation>& out);

void add_exit_code(const TopicQuery& query, std::vector<Explanation>& out);

}  // namespace servoctl::show
