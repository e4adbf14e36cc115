#pragma once

#include <cstdint>
#include <optional>

#include "od/parameter.hpp"
#include "show/topic_query.hpp"

/// Where `explain` and `param search` look for words.
namespace servoctl::show {

/// In what all words of the query stand, the best first.
enum class WordsIn : std::uint8_t { name, labels, note };

/// Of a panel parameter: in its number and names, else with its labels, else with its note; empty: nowhere.
std::optional<WordsIn> words_in(const TopicQuery& query, const od::Parameter& parameter);

}  // namespace servoctl::show
