#pragma once

#include <vector>

#include "drive/profile.hpp"
#include "drive/topics.hpp"

namespace servoctl::drive {

/// Removes the topics of the standard that do not apply to drives of this family: those of an object that its
/// dictionary does not have, of a value that the object cannot take, of a mode of operation or a network that
/// it lacks, and those that explain an object whose values the family defines itself. Rows of other homing
/// methods are removed as well. Topics of the family's own files stay.
void remove_foreign_topics(std::vector<Topic>& topics, const Profile& profile);

}  // namespace servoctl::drive
