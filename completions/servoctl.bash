# Completion of servoctl for bash; written by `servoctl completion bash`.
_servoctl_scan() {
  local word skip=''
  command='' drive=${SERVOCTL_DRIVE-} source='' options='--bus --node --drive --timeout --retries --json --output --lang --yes --read-only --dry-run --trace --help'
  for word in "$@"; do
    if [ -n "$skip" ]; then
      case $skip in -d|--drive) drive=$word ;; esac
      skip=''
      continue
    fi
    case $word in
      --bus|-b|--node|-n|--drive|-d|--timeout|--retries|--output|-o|--lang|--trace|--type|--to|--transfer|--from|--only|--for|--guard|--life|--var) skip=$word ;;
      -*) ;;
      *)
        case $command in
          '') command=$word ;;
          param|fault|nmt|eds) command="$command $word" ;;
        esac ;;
    esac
  done
  if [ -n "$skip" ]; then
    case $skip in
      -b|--bus) source='buses' ;;
      -n|--node) source='=all' ;;
      -d|--drive) source='families' ;;
      --timeout) source='none' ;;
      --retries) source='none' ;;
      -o|--output) source='=text json jsonl' ;;
      --lang) source='=en zh' ;;
      --trace) source='files' ;;
      --type) source='=bool i8 i16 i24 i32 i64 u8 u16 u24 u32 u64 f32 f64 string bytes domain' ;;
      --to) source='files' ;;
      --transfer) source='=auto expedited segmented block' ;;
      --from) source='files' ;;
      --only) source='none' ;;
      --for) source='none' ;;
      --guard) source='none' ;;
      --life) source='none' ;;
      --var) source='none' ;;
    esac
    return
  fi
  case $command in
    '') source='=scan info status read write objects param backup diff verify restore clone store defaults fault nmt decode drives eds run sim completion help' ;;
    param) source='=list get set search explain' ;;
    fault) source='=show list reset clear-history' ;;
    nmt) source='=start stop preop reset reset-comm watch' ;;
    eds) source='=check' ;;
    'read') source='objects' ;;
    'write') source='objects' ;;
    'objects') source='none' ;;
    'param list') source='none' ;;
    'param get') source='parameters' ;;
    'param set') source='parameters' ;;
    'param search') source='none' ;;
    'param explain') source='parameters' ;;
    'backup') source='files' ;;
    'diff') source='files' ;;
    'verify') source='files' ;;
    'restore') source='files' ;;
    'store') source='=all communication application vendor' ;;
    'defaults') source='=all communication application vendor' ;;
    'fault list') source='none' ;;
    'decode') source='files' ;;
    'drives') source='families' ;;
    'eds check') source='files' ;;
    'run') source='files' ;;
    'sim') source='none' ;;
    'completion') source='=bash zsh fish objects parameters families' ;;
    'help') source='=scan info status read write objects param backup diff verify restore clone store defaults fault nmt decode drives eds run sim completion help' ;;
  esac
  case $command in
    'read') options+=' --type --to --transfer' ;;
    'write') options+=' --type --from --transfer --keep --unlock' ;;
    'param set') options+=' --keep --unlock' ;;
    'backup') options+=' --only' ;;
    'restore') options+=' --with-address --no-rollback --force --keep --unlock --resume' ;;
    'clone') options+=' --from --to --force --keep --unlock --resume' ;;
    'nmt start') options+=' --wait' ;;
    'nmt stop') options+=' --wait' ;;
    'nmt preop') options+=' --wait' ;;
    'nmt reset') options+=' --wait' ;;
    'nmt reset-comm') options+=' --wait' ;;
    'nmt watch') options+=' --for --guard --life' ;;
    'decode') options+=' --raw' ;;
    'run') options+=' --var --check' ;;
  esac
}

_servoctl_words() {
  case $source in
    '='*) printf '%s\n' "${source#=}" | tr ' ' '\n' ;;
    objects|parameters)
      [ -z "$drive" ] || servoctl completion "$source" -d "$drive" 2>/dev/null ;;
    families) servoctl completion families 2>/dev/null ;;
    buses)
      local interface
      for interface in /sys/class/net/*; do
        [ "$(cat "$interface/type" 2>/dev/null)" != 280 ] || printf '%s\n' "${interface##*/}"
      done
      printf '%s\n' sim: local: ;;
  esac
}

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
