#include "commands/shell_completion.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "commands/command.hpp"

namespace servoctl::commands {
namespace {

/// `*` behind a word of help text or a quote would end the shell's own quotes.
std::string shell_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string options_of(std::span<const Parameter> parameters, bool with_value_only) {
  std::string out;
  for (const auto& p : parameters) {
    if (!p.name.starts_with("-") || (with_value_only && p.kind == Kind::flag)) continue;
    out += (out.empty() ? "" : " ") + std::string(p.name);
    if (with_value_only && !p.short_name.empty()) out += " " + std::string(p.short_name);
  }
  return out;
}

std::string first_words() {
  std::string out;
  std::string last;
  for (const auto* command : registry()) {
    const auto word = std::string(split(command->path, ' ').front());
    if (word != last) out += (out.empty() ? "" : " ") + word;
    last = word;
  }
  return out;
}

/// The second words behind `first`; empty when it is a command by itself.
std::string second_words(std::string_view first) {
  std::string out;
  for (const auto* command : registry()) {
    const auto parts = split(command->path, ' ');
    if (parts.size() > 1 && parts.front() == first) out += (out.empty() ? "" : " ") + std::string(parts[1]);
  }
  return out;
}

std::string all_value_options() {
  auto out = options_of(global_options(), true);
  for (const auto* command : registry())
    if (const auto own = options_of(command->parameters, true); !own.empty())
      for (const auto word : split(own, ' '))
        if ((" " + out + " ").find(" " + std::string(word) + " ") == std::string::npos)
          out += " " + std::string(word);
  return out;
}

/// What the shell functions below understand: a kind of dynamic words, or fixed words behind `=`.
std::string source_of(const Parameter& p) {
  if (!p.choices.empty()) {
    std::string out = "=";
    for (const auto choice : p.choices) out += (out.size() == 1 ? "" : " ") + std::string(choice);
    return out;
  }
  switch (p.kind) {
    case Kind::object: return "objects";
    case Kind::parameter: return "parameters";
    case Kind::family: return "families";
    case Kind::bus: return "buses";
    case Kind::file: return "files";
    case Kind::nodes: return "=all";
    case Kind::command: return "=" + first_words();
    default: return "none";
  }
}

/// Lines `PATTERN) VAR=SOURCE ;;` for a shell's case: options first, by name and short name.
std::string option_cases(std::string_view indent, std::string_view variable) {
  std::string out;
  std::string seen = " ";
  const auto add = [&](const Parameter& p) {
    if (!p.name.starts_with("-") || p.kind == Kind::flag ||
        seen.find(" " + std::string(p.name) + " ") != std::string::npos)
      return;
    seen += std::string(p.name) + " ";
    const auto names =
        p.short_name.empty() ? std::string(p.name) : fmt::format("{}|{}", p.short_name, p.name);
    out += fmt::format("{}{}) {}={} ;;\n", indent, names, variable, shell_quoted(source_of(p)));
  };
  for (const auto& p : global_options()) add(p);
  for (const auto* command : registry())
    for (const auto& p : command->parameters) add(p);
  return out;
}

std::string positional_cases(std::string_view indent, std::string_view variable) {
  std::string out;
  for (const auto* command : registry())
    for (const auto& p : command->parameters)
      if (!p.name.starts_with("-")) {
        out += fmt::format("{}{}) {}={} ;;\n", indent, shell_quoted(command->path), variable,
                           shell_quoted(source_of(p)));
        break;
      }
  return out;
}

std::string own_option_cases(std::string_view indent, std::string_view variable) {
  std::string out;
  for (const auto* command : registry())
    if (const auto own = options_of(command->parameters, false); !own.empty())
      out += fmt::format("{}{}) {}+={} ;;\n", indent, shell_quoted(command->path), variable,
                         shell_quoted(" " + own));
  return out;
}

std::string group_cases(std::string_view indent, std::string_view variable) {
  std::string out;
  const auto first_all = first_words();
  for (const auto first : split(first_all, ' '))
    if (const auto second = second_words(first); !second.empty())
      out += fmt::format("{}{}) {}={} ;;\n", indent, first, variable, shell_quoted("=" + second));
  return out;
}

/// The part bash and zsh share: finds command, drive and what may stand at the cursor in the array `words`
/// (1-based from `first` to `last`), into the variables command, drive, source, options.
std::string scan_function() {
  return fmt::format(R"sh(_servoctl_scan() {{
  local word skip=''
  command='' drive=${{SERVOCTL_DRIVE-}} source='' options={}
  for word in "$@"; do
    if [ -n "$skip" ]; then
      case $skip in -d|--drive) drive=$word ;; esac
      skip=''
      continue
    fi
    case $word in
{}      -*) ;;
      *)
        case $command in
          '') command=$word ;;
          {}) command="$command $word" ;;
        esac ;;
    esac
  done
  if [ -n "$skip" ]; then
    case $skip in
{}    esac
    return
  fi
  case $command in
    '') source={} ;;
{}{}  esac
  case $command in
{}  esac
}}

_servoctl_words() {{
  case $source in
    '='*) printf '%s\n' "${{source#=}}" | tr ' ' '\n' ;;
    objects|parameters)
      [ -z "$drive" ] || servoctl completion "$source" -d "$drive" 2>/dev/null ;;
    families) servoctl completion families 2>/dev/null ;;
    buses)
      local interface
      for interface in /sys/class/net/*; do
        [ "$(cat "$interface/type" 2>/dev/null)" != 280 ] || printf '%s\n' "${{interface##*/}}"
      done
      printf '%s\n' sim: local: ;;
  esac
}}
)sh",
                     shell_quoted(options_of(global_options(), false)),
                     [] {
                       std::string out;
                       const auto options = all_value_options();
                       for (const auto word : split(options, ' '))
                         out += (out.empty() ? "      " : "|") + std::string(word);
                       return out + ") skip=$word ;;\n";
                     }(),
                     [] {
                       std::string out;
                       const auto first_all = first_words();
                       for (const auto first : split(first_all, ' '))
                         if (!second_words(first).empty())
                           out += (out.empty() ? "" : "|") + std::string(first);
                       return out;
                     }(),
                     option_cases("      ", "source"), shell_quoted("=" + first_words()),
                     group_cases("    ", "source"), positional_cases("    ", "source"),
                     own_option_cases("    ", "options"));
}

std::string bash_script() {
  return "# Completion of servoctl for bash; written by `servoctl completion bash`.\n" + scan_function() +
         R"sh(
_servoctl() {
  local cur=${COMP_WORDS[COMP_CWORD]} command drive source options
  _servoctl_scan "${COMP_WORDS[@]:1:COMP_CWORD-1}"
  COMPREPLY=()
  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")
  elif [[ $source == files ]]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
  else
    local word
    while IFS= read -r word; do
      [[ ${word,,} != "${cur,,}"* ]] || COMPREPLY+=("$word")
    done < <(_servoctl_words)
  fi
}
complete -F _servoctl servoctl
)sh";
}

std::string zsh_script() {
  return "#compdef servoctl\n# Completion of servoctl for zsh; written by `servoctl completion zsh`.\n" +
         scan_function() + R"sh(
_servoctl() {
  local command drive source options
  _servoctl_scan "${(@)words[2,CURRENT-1]}"
  if [[ ${words[CURRENT]} == -* ]]; then
    compadd -- ${=options}
  elif [[ $source == files ]]; then
    _files
  else
    compadd -M 'm:{a-zA-Z}={A-Za-z}' -- ${(f)"$(_servoctl_words)"}
  fi
}

if [ "$funcstack[1]" = "_servoctl" ]; then
  _servoctl "$@"
elif (( $+functions[compdef] )); then
  compdef _servoctl servoctl
fi
)sh";
}

/// fish asks bash's questions with its own words.
std::string fish_script() {
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

function __servoctl_buses
    for interface in /sys/class/net/*
        test (cat $interface/type 2>/dev/null; or echo 0) = 280; and basename $interface
    end
    echo sim:
    echo local:
end

complete -c servoctl -f
)sh";
  const auto arguments = [](const Parameter& p) -> std::string {
    const auto source = source_of(p);
    if (source.front() == '=') return " -x -a " + shell_quoted(source.substr(1));
    if (source == "files") return " -r -F";
    if (source == "families") return " -x -a '(servoctl completion families 2>/dev/null)'";
    if (source == "buses") return " -x -a '(__servoctl_buses)'";
    if (source == "objects" || source == "parameters") return " -x -a '(__servoctl_names " + source + ")'";
    return " -x";
  };
  const auto option = [&](const Parameter& p, const std::string& condition) {
    out += "complete -c servoctl" + condition + " -l " + std::string(p.name.substr(2));
    if (!p.short_name.empty()) out += " -s " + std::string(p.short_name.substr(1));
    if (p.kind != Kind::flag) out += arguments(p);
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
        out += "complete -c servoctl" + condition + arguments(p) + "\n";
    }
  }
  const auto first_all = first_words();
  for (const auto first : split(first_all, ' '))
    if (!second_words(first).empty())
      out += fmt::format("complete -c servoctl -n __servoctl_at -a {}\n", first);
  return out;
}

}  // namespace

std::string completion_script(std::string_view shell) {
  if (shell == "zsh") return zsh_script();
  if (shell == "fish") return fish_script();
  return bash_script();
}

}  // namespace servoctl::commands
