#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drive/naming.hpp"

/// Objects and parameters by the names that people and makers give them; resolve() puts them in order.
namespace servoctl::drive {

/// What has exactly this name: an object, `object.part of an entry`, an entry, a parameter, in the language
/// of the data or in Chinese. An object of several entries means each of them.
std::vector<Target> named_wholly(const Profile& profile, std::string_view text, Match match);

/// What has all of these words somewhere in its name or number.
std::vector<Target> named_in_part(const Profile& profile, std::string_view text);

/// The parameters that are called so, wholly or in part.
std::vector<const od::Parameter*> parameters_named(const Profile& profile, std::string_view text,
                                                   Match match);

/// What a user may have meant by a name that nothing has, as a sentence; empty where nothing is near.
Message near_names(const Profile& profile, std::string_view text, bool objects);

/// The same by the word that is spelt like it in some name (`temprature`).
Message near_words(const Profile& profile, std::string_view text);

/// `Pr1.01 1st velocity loop gain`
std::string numbered_name(const od::Parameter& parameter);

/// How an object is written so that resolve() finds it: its number, its name, else its address.
std::string written_name(const Profile& profile, const Target& target);

}  // namespace servoctl::drive
