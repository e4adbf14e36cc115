#include "command/shell_completion.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "command/command.hpp"
#include "command/completion_words.hpp"
#include "command/registry.hpp"

namespace servoctl::command {

namespace {

/// What follows the option or stands for the argument.
std::string fish_arguments(const Parameter& p) {
  const auto source = source_of(p);
  if (source.front() == '=') return " -x -a " + shell_quoted(source.substr(1));
  if (source == "files") return " -r -F";
  if (source == "families") return " -x -a '(servoctl completion families 2>/dev/null; __servoctl_sheets)'";
  if (source == "buses") return " -x -a '(__servoctl_buses)'";
  if (source == "topics") return " -x -a '(__servoctl_topics)'";
  if (source == "objects" || source == "parameters") return " -x -a '(__servoctl_names " + source + ")'";
  return " -x";
}

}  // namespace

/// fish asks bash's questions with its own words.
std::string fish_completion() {
  std::string out = "# Completion of servoctl for fish; written by `servoctl completion fish`.\n";
  out += R"sh(function __servoctl_drive
    set -l words (commandline -opc)
    for i in (seq 2 (count $words))
        if contains -- $words[(math $i - 1)] -d --drive
            echo $words[$i]
            return
        end
    end
    echo $SERVOCTL_DRIVE
end

function __servoctl_path # the words that are neither options nor their values
    set -l skip 0
    set -l path
    for word in (commandline -opc)[2..]
        if test $skip = 1
            set skip 0
)sh";
  out += "        else if contains -- $word " + all_value_options() + "\n            set skip 1\n";
  out += R"sh(        else if not string match -q -- '-*' $word
            set path $path $word
        end
    end
    string join \n -- $path
end

function __servoctl_at # these words and no more
    set -l path (__servoctl_path)
    test "$path" = "$argv"
end

function __servoctl_in # these words first
    set -l path (__servoctl_path)
    set -l n (count $argv)
    test (count $path) -ge $n; and test "$path[1..$n]" = "$argv"
end

function __servoctl_names
    set -l drive (__servoctl_drive)
    test -n "$drive"; and servoctl completion $argv[1] -d $drive 2>/dev/null
end

function __servoctl_topics
    set -l drive (__servoctl_drive)
    if test -n "$drive"
        servoctl completion topics -d $drive 2>/dev/null
    else
        servoctl completion topics 2>/dev/null
    end
end

function __servoctl_buses
    for interface in /sys/class/net/*
        set -l type (cat $interface/type 2>/dev/null; or echo 0)
        test $type = 280; and basename $interface
        test $type = 1; and not test -e $interface/phy80211; and echo coe:(basename $interface)
    end
    echo sim:
    echo local:
    echo slcan:/dev/
    echo socketcand://
    echo gateway://
    echo coe:local:
    find /dev -maxdepth 1 \( -name 'ttyUSB*' -o -name 'ttyACM*' \) 2>/dev/null | sed 's|.*|slcan:&\nmodbus:&|'
    echo coe:sim:
    echo modbus:
    echo modbus:sim:
end

function __servoctl_sheets
    set -l typed (commandline -ct)
    for sheet in $typed*.eds $typed*.dcf $typed*.xml
        echo $sheet
    end
end

complete -c servoctl -f
)sh";
  const auto option = [&](const Parameter& p, const std::string& condition) {
    out += "complete -c servoctl" + condition + " -l " + std::string(p.name.substr(2));
    if (!p.short_name.empty()) out += " -s " + std::string(p.short_name.substr(1));
    if (p.kind != Kind::flag) out += fish_arguments(p);
    out += " -d " + shell_quoted(p.help) + "\n";
  };
  for (const auto& p : global_options()) option(p, "");
  for (const auto* command : registry()) {
    const auto parts = split(command->path, ' ');
    if (parts.size() == 1)
      out += fmt::format("complete -c servoctl -n __servoctl_at -a {} -d {}\n", parts[0],
                         shell_quoted(command->summary));
    else
      out += fmt::format("complete -c servoctl -n '__servoctl_at {}' -a {} -d {}\n", parts[0], parts[1],
                         shell_quoted(command->summary));
    for (const auto& p : command->parameters) {
      const auto condition = fmt::format(" -n '__servoctl_in {}'", command->path);
      if (p.name.starts_with("-"))
        option(p, condition);
      else if (source_of(p) != "none")
        out += "complete -c servoctl" + condition + fish_arguments(p) + "\n";
    }
  }
  const auto first_all = first_words();
  for (const auto first : split(first_all, ' '))
    if (!second_words(first).empty())
      out += fmt::format("complete -c servoctl -n __servoctl_at -a {}\n", first);
  return out;
}

}  // namespace servoctl::command
