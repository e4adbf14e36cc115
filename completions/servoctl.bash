# Completion of servoctl for bash; written by `servoctl completion bash`.
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
