#include "command/shell_completion.hpp"

#include "base/printable.hpp"

namespace servoctl::command {
namespace {

constexpr std::string_view kBash =
    R"sh(# Completion of servoctl for bash; written by `servoctl completion bash`.
# The program is asked what may stand at the cursor: it reads files, opens no bus and sends nothing.
_servoctl() {
  local program=${COMP_WORDS[0]} answer
  [[ $program == */* && -x $program ]] || program=servoctl
  # Behind a redirection stands a file.
  case ${COMP_WORDS[COMP_CWORD-1]} in
    *'>' | *'<' | *'>|') COMPREPLY=(); compopt -o default; return ;;
  esac
  # A word before the cursor that is a variable stands for its value; nothing else is expanded.
  local line=${COMP_LINE:0:COMP_POINT} before name
  before=${line%[[:blank:]]*}
  line=${line:${#before}}
  while [[ "$before " =~ ^(.*[[:blank:]])\"?\$\{?([A-Za-z_][A-Za-z0-9_]*)\}?\"?([[:blank:]].*)$ ]]; do
    name=${BASH_REMATCH[2]}
    before=${BASH_REMATCH[1]}$(printf %q "${!name}")${BASH_REMATCH[3]% }
  done
  mapfile -t answer < <("$program" __complete bash "${COMP_TYPE:-9}" "${COLUMNS:-80}" "$COMP_WORDBREAKS" \
    "$before$line" 2>/dev/null)
  COMPREPLY=("${answer[@]:1}")
  case ${answer[0]-} in
    files) compopt -o default ;;
    open) compopt -o nospace ;;
    # At the second Tab bash only lists; a single entry it would put into the line, so there are two.
    note*) [[ ${COMP_TYPE-} != 63 ]] || COMPREPLY=("(${answer[0]#note })" " ") ;;
  esac
}
complete -o nosort -F _servoctl servoctl 2>/dev/null || complete -F _servoctl servoctl
)sh";

constexpr std::string_view kZsh = R"sh(#compdef servoctl
# Completion of servoctl for zsh; written by `servoctl completion zsh`.
# The program is asked what may stand at the cursor: it reads files, opens no bus and sends nothing.
_servoctl() {
  local program=servoctl
  [[ ${(Q)words[1]} == */* && -x ${(Q)words[1]} ]] && program=${(Q)words[1]}
  local -a answer ready open given match mbegin mend
  local heading tag
  given=("${(@Q)words[2,CURRENT-1]}")
  # A word that is a variable stands for its value; nothing else is expanded.
  local i
  for ((i = 1; i <= $#given; ++i)); do
    [[ $given[i] =~ '^\$\{?([A-Za-z_][A-Za-z0-9_]*)\}?$' ]] && given[i]=${(P)match[1]}
  done
  answer=("${(@f)$("$program" __complete zsh "$QIPREFIX$PREFIX" "${(@)given}" 2>/dev/null)}")
  case ${answer[1]} in
    files) _files; return ;;
    note*) _message -r "${answer[1]#note }"; return ;;
  esac
  shift answer
  local -a as=(-M 'm:{a-zA-Z}={A-Za-z}')
  local ret=1
  for heading in ${${(M)answer:#=*}#=}; do
    tag=${heading%% *}
    ready=(${${(M)answer:#$tag-*}#$tag-})
    open=(${${(M)answer:#$tag+*}#$tag+})
    heading=${heading#* }
    _describe -t $tag -V "$heading" ready $as -- open $as -S '' && ret=0
  done
  return ret
}

if [ "$funcstack[1]" = "_servoctl" ]; then
  _servoctl "$@"
elif (( $+functions[compdef] )); then
  compdef _servoctl servoctl
fi
)sh";

constexpr std::string_view kFish =
    R"sh(# Completion of servoctl for fish; written by `servoctl completion fish`.
# The program is asked what may stand at the cursor: it reads files, opens no bus and sends nothing.
function __servoctl_complete
    set -l words (commandline -opc)
    set -l begun (commandline -ct)
    set -l program servoctl
    string match -q -- '*/*' $words[1]; and test -x $words[1]; and set program $words[1]
    set -e words[1]
    # A word that is a variable stands for its value; nothing else is expanded.
    for i in (seq (count $words))
        set -l name (string replace -rf -- '^"?\{?\$([A-Za-z_][A-Za-z0-9_]*)\}?"?$' '$1' $words[$i])
        and set -q $name
        and set words[$i] "$$name"
    end
    set -l answer ($program __complete fish "$begun" $words 2>/dev/null)
    switch "$answer[1]"
        case 'note*'
            printf '\n(%s)\n' (string sub -s 6 -- $answer[1]) >&2
            commandline -f repaint
        case '*'
            set -e answer[1]
            printf '%s\n' $answer
    end
end

complete -c servoctl -f -k -a '(__servoctl_complete)'
)sh";

}  // namespace

std::string completion_script(std::string_view shell) {
  return std::string(shell == "zsh" ? kZsh : shell == "fish" ? kFish : kBash);
}

bool can_be_offered(std::string_view name) {
  constexpr std::string_view kOwnMeaning = " \"#$&'()*;<>?[\\]^`{|}~!";
  return !name.empty() && name.front() != '-' && name.find_first_of(kOwnMeaning) == std::string_view::npos &&
         printable(name) == name;
}

}  // namespace servoctl::command
