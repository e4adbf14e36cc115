#pragma once

#include <span>
#include <string>
#include <string_view>

namespace servoctl::command {

/// One thing the manual page names, and what is to be said of it; as roff_text() reads it.
struct Entry {
  std::string_view name;
  std::string_view text;
};

/// The forms of a bus: the URL as an example, and what it is.
std::span<const Entry> manual_buses();

/// Every variable of the environment that the program reads.
std::span<const Entry> manual_environment();

/// The files and folders it reads and writes by itself.
std::span<const Entry> manual_files();

/// Command lines, and what they are for.
std::span<const Entry> manual_examples();

/// servoctl(1) in man(7): global options, commands and exit codes are those of the tables that the parser and
/// `help` read. In Chinese on request; names, command lines and placeholders stay as they are typed.
std::string man_page(std::string_view version, std::string_view date, bool chinese = false);

}  // namespace servoctl::command
