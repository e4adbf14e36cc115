#pragma once

#include <string>
#include <string_view>

namespace servoctl::show {

/// A bus as a part of a file's name: the same for every way to write it, and for no other bus.
std::string bus_name(std::string_view url);

}  // namespace servoctl::show
