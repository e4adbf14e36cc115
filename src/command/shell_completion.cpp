#include "command/shell_completion.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "command/command.hpp"
#include "command/completion_words.hpp"
#include "command/registry.hpp"

namespace servoctl::command {
namespace {

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

# Data sheets in a folder, given as it was typed; those with signs the shell reads are left out.
_servoctl_sheets() {{
  find "${{1:-.}}" -maxdepth 1 -type f \( -name '*.eds' -o -name '*.dcf' -o -name '*.[xX][mM][lL]' \) 2>/dev/null |
    sed 's|.*/||' | grep -v '[^A-Za-z0-9._+-]' | while IFS= read -r sheet; do printf '%s%s\n' "$1" "$sheet"; done
}}

_servoctl_words() {{
  case $source in
    '='*) printf '%s\n' "${{source#=}}" | tr ' ' '\n' ;;
    objects|parameters)
      [ -z "$drive" ] || servoctl completion "$source" -d "$drive" 2>/dev/null ;;
    topics)
      servoctl completion topics ${{drive:+"--drive=$drive"}} 2>/dev/null ;;
    families)
      servoctl completion families 2>/dev/null
      _servoctl_sheets "${{typed%"${{typed##*/}}"}}" ;;
    buses)
      local interface
      for interface in /sys/class/net/*; do
        case $(cat "$interface/type" 2>/dev/null) in
          280) printf '%s\n' "${{interface##*/}}" ;;
          1) [ -e "$interface/phy80211" ] || printf '%s\n' "coe:${{interface##*/}}" ;;
        esac
      done
      find /dev -maxdepth 1 \( -name 'ttyUSB*' -o -name 'ttyACM*' \) 2>/dev/null | sed 's|.*|slcan:&\nmodbus:&|'
      printf '%s\n' sim: local: slcan:/dev/ socketcand:// gateway:// coe:local: coe:sim: modbus: modbus:sim: ;;
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
  local typed=$cur
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
  local command drive source options typed=${words[CURRENT]}
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

}  // namespace

std::string completion_script(std::string_view shell) {
  if (shell == "zsh") return zsh_script();
  if (shell == "fish") return fish_completion();
  return bash_script();
}

}  // namespace servoctl::command
