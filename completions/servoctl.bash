# Completion of servoctl for bash; written by `servoctl completion bash`.
_servoctl_scan() {
  local word skip=''
  command='' drive=${SERVOCTL_DRIVE-} source='' options='--bus --node --drive --cabinet --timeout --retries --json --output --lang --yes --quiet --force-family --read-only --dry-run --trace --help'
  for word in "$@"; do
    if [ -n "$skip" ]; then
      case $skip in -d|--drive) drive=$word ;; esac
      skip=''
      continue
    fi
    case $word in
      --bus|-b|--node|-n|--drive|-d|--cabinet|--timeout|--retries|--output|-o|--lang|--trace|--bitrate|--sample-point|--restart-ms|--txqueuelen|--for|--type|--to|--transfer|--from|--format|--only|--family|--name|--axis|--backup|--wait|--plan|--assign|--patience|--vendor|--product|--revision|--serial|--activate|--turn|--turns|--accel|--csv|--limit|--max-torque|--max-following-error|--window|--master-node|--speed|--search|--offset|--within|--nameplate|--guard|--life|--inhibit|--event|--cob-id|--sync-start|--count|--longest|--junit|--expect|--tolerance|--stop-within|--repeat|--spread|--encoder|--title|--tests|--period|--counter|--every|--svg|--service|--object|--var|--listen|--allow) skip=$word ;;
      -*) ;;
      *)
        case $command in
          '') command=$word ;;
          bus|param|cabinet|lss|fault|units|heartbeat|nmt|state|pdo|test|sync|eds) command="$command $word" ;;
        esac ;;
    esac
  done
  if [ -n "$skip" ]; then
    case $skip in
      -b|--bus) source='buses' ;;
      -n|--node) source='=all' ;;
      -d|--drive) source='families' ;;
      --cabinet) source='files' ;;
      --timeout) source='none' ;;
      --retries) source='none' ;;
      -o|--output) source='=text json jsonl' ;;
      --lang) source='=en zh' ;;
      --trace) source='files' ;;
      --bitrate) source='none' ;;
      --sample-point) source='none' ;;
      --restart-ms) source='none' ;;
      --txqueuelen) source='none' ;;
      --for) source='none' ;;
      --type) source='=bool i8 i16 i24 i32 i64 u8 u16 u24 u32 u64 f32 f64 string bytes domain' ;;
      --to) source='files' ;;
      --transfer) source='=auto expedited segmented block' ;;
      --from) source='files' ;;
      --format) source='=json dcf csv batch' ;;
      --only) source='none' ;;
      --family) source='none' ;;
      --name) source='none' ;;
      --axis) source='none' ;;
      --backup) source='files' ;;
      --wait) source='none' ;;
      --plan) source='files' ;;
      --assign) source='none' ;;
      --patience) source='none' ;;
      --vendor) source='none' ;;
      --product) source='none' ;;
      --revision) source='none' ;;
      --serial) source='none' ;;
      --activate) source='none' ;;
      --turn) source='none' ;;
      --turns) source='none' ;;
      --accel) source='none' ;;
      --csv) source='files' ;;
      --limit) source='none' ;;
      --max-torque) source='none' ;;
      --max-following-error) source='none' ;;
      --window) source='none' ;;
      --master-node) source='none' ;;
      --speed) source='none' ;;
      --search) source='none' ;;
      --offset) source='none' ;;
      --within) source='none' ;;
      --nameplate) source='none' ;;
      --guard) source='none' ;;
      --life) source='none' ;;
      --inhibit) source='none' ;;
      --event) source='none' ;;
      --cob-id) source='none' ;;
      --sync-start) source='none' ;;
      --count) source='none' ;;
      --longest) source='none' ;;
      --junit) source='files' ;;
      --expect) source='none' ;;
      --tolerance) source='none' ;;
      --stop-within) source='none' ;;
      --repeat) source='none' ;;
      --spread) source='none' ;;
      --encoder) source='none' ;;
      --title) source='none' ;;
      --tests) source='files' ;;
      --period) source='none' ;;
      --counter) source='none' ;;
      --every) source='none' ;;
      --svg) source='files' ;;
      --service) source='=nmt sync time emcy pdo sdo boot-up heartbeat guarding lss controller other' ;;
      --object) source='objects' ;;
      --var) source='none' ;;
      --listen) source='none' ;;
      --allow) source='=write' ;;
    esac
    return
  fi
  case $command in
    '') source='=scan bus doctor info status read write explain objects param backup cabinet diff verify restore clone address lss store defaults fault enable disable quick-stop mode jog move home torque units heartbeat watchdog nmt state pdo test report sync watch scope monitor decode replay drives eds run sim gateway help man completion' ;;
    bus) source='=status up down detect' ;;
    param) source='=list get set search explain' ;;
    cabinet) source='=init check show plan apply backup swap diff' ;;
    lss) source='=scan inquire set-node set-bitrate store' ;;
    fault) source='=show list reset clear-history' ;;
    units) source='=show learn forget' ;;
    heartbeat) source='=set consume show' ;;
    nmt) source='=start stop preop reset reset-comm watch' ;;
    state) source='=init preop safeop op' ;;
    pdo) source='=show map enable disable clear preset apply save watch send' ;;
    test) source='=comm io jog home all' ;;
    sync) source='=once start stop' ;;
    eds) source='=check' ;;
    'bus status') source='buses' ;;
    'bus up') source='buses' ;;
    'bus down') source='buses' ;;
    'bus detect') source='buses' ;;
    'doctor') source='buses' ;;
    'read') source='objects' ;;
    'write') source='objects' ;;
    'explain') source='topics' ;;
    'objects') source='none' ;;
    'param list') source='none' ;;
    'param get') source='parameters' ;;
    'param set') source='parameters' ;;
    'param search') source='none' ;;
    'param explain') source='parameters' ;;
    'backup') source='files' ;;
    'cabinet init') source='files' ;;
    'cabinet check') source='files' ;;
    'cabinet show') source='none' ;;
    'cabinet swap') source='none' ;;
    'cabinet diff') source='files' ;;
    'diff') source='files' ;;
    'verify') source='files' ;;
    'restore') source='files' ;;
    'address') source='none' ;;
    'lss set-node') source='none' ;;
    'lss set-bitrate') source='none' ;;
    'store') source='=all communication application vendor' ;;
    'defaults') source='=all communication application vendor' ;;
    'fault list') source='none' ;;
    'mode') source='none' ;;
    'jog') source='none' ;;
    'move') source='none' ;;
    'home') source='none' ;;
    'torque') source='none' ;;
    'heartbeat set') source='none' ;;
    'heartbeat consume') source='none' ;;
    'pdo map') source='none' ;;
    'pdo enable') source='none' ;;
    'pdo disable') source='none' ;;
    'pdo clear') source='none' ;;
    'pdo preset') source='none' ;;
    'pdo apply') source='files' ;;
    'pdo save') source='files' ;;
    'pdo watch') source='none' ;;
    'pdo send') source='none' ;;
    'test jog') source='none' ;;
    'test home') source='none' ;;
    'test all') source='none' ;;
    'report') source='files' ;;
    'watch') source='objects' ;;
    'scope') source='objects' ;;
    'decode') source='files' ;;
    'replay') source='files' ;;
    'drives') source='families' ;;
    'eds check') source='files' ;;
    'run') source='files' ;;
    'sim') source='none' ;;
    'help') source='=scan bus doctor info status read write explain objects param backup cabinet diff verify restore clone address lss store defaults fault enable disable quick-stop mode jog move home torque units heartbeat watchdog nmt state pdo test report sync watch scope monitor decode replay drives eds run sim gateway help man completion use drive undo log exit' ;;
    'completion') source='=bash zsh fish objects parameters topics families' ;;
  esac
  case $command in
    'scan') options+=' --long --all-bitrates' ;;
    'bus up') options+=' --bitrate --sample-point --restart-ms --txqueuelen' ;;
    'bus detect') options+=' --for --bitrate' ;;
    'doctor') options+=' --active --for' ;;
    'status') options+=' --long' ;;
    'read') options+=' --type --to --transfer' ;;
    'write') options+=' --type --from --transfer --keep --unlock' ;;
    'param set') options+=' --keep --unlock' ;;
    'backup') options+=' --format --only' ;;
    'cabinet init') options+=' --family --name' ;;
    'cabinet show') options+=' --watch --for' ;;
    'cabinet plan') options+=' --axis --only --no-unlisted' ;;
    'cabinet apply') options+=' --axis --only --no-keep --unlock --all-or-nothing --resume' ;;
    'cabinet backup') options+=' --axis' ;;
    'cabinet swap') options+=' --from --backup --wait --no-keep --unlock --resume' ;;
    'diff') options+=' --batch --skip-invalid' ;;
    'verify') options+=' --skip-invalid' ;;
    'restore') options+=' --only --with-address --no-rollback --force --skip-invalid --keep --unlock --resume' ;;
    'clone') options+=' --from --to --force --keep --unlock --resume' ;;
    'address') options+=' --bitrate --plan --wait --unlock --resume' ;;
    'lss scan') options+=' --assign --keep --patience --vendor --product --revision --serial' ;;
    'lss inquire') options+=' --vendor --product --revision --serial --only' ;;
    'lss set-node') options+=' --vendor --product --revision --serial --only --keep' ;;
    'lss set-bitrate') options+=' --activate --all --vendor --product --revision --serial --only --keep' ;;
    'lss store') options+=' --vendor --product --revision --serial --only' ;;
    'enable') options+=' --turn' ;;
    'jog') options+=' --for --turns --until-key --accel --csv --limit --max-torque --max-following-error --window --turn --master-node --plot' ;;
    'move') options+=' --relative --speed --accel --csv --limit --max-torque --max-following-error --window --turn --master-node --plot' ;;
    'home') options+=' --speed --search --offset --within --csv --limit --max-torque --max-following-error --window --turn --master-node --plot' ;;
    'torque') options+=' --for --csv --limit --max-torque --max-following-error --window --turn --master-node --plot' ;;
    'units show') options+=' --turn' ;;
    'units learn') options+=' --speed --for --nameplate --max-torque --max-following-error --window --master-node --plot --csv' ;;
    'heartbeat set') options+=' --keep --unlock' ;;
    'heartbeat consume') options+=' --keep --unlock' ;;
    'nmt start') options+=' --wait' ;;
    'nmt stop') options+=' --wait' ;;
    'nmt preop') options+=' --wait' ;;
    'nmt reset') options+=' --wait' ;;
    'nmt reset-comm') options+=' --wait' ;;
    'nmt watch') options+=' --for --guard --life' ;;
    'state init') options+=' --take-over' ;;
    'state preop') options+=' --take-over' ;;
    'state safeop') options+=' --take-over' ;;
    'state op') options+=' --take-over' ;;
    'pdo map') options+=' --type --inhibit --event --cob-id --sync-start --keep --unlock' ;;
    'pdo enable') options+=' --keep --unlock' ;;
    'pdo disable') options+=' --keep --unlock' ;;
    'pdo clear') options+=' --keep --unlock' ;;
    'pdo preset') options+=' --keep --unlock' ;;
    'pdo apply') options+=' --keep --unlock' ;;
    'pdo watch') options+=' --for' ;;
    'test comm') options+=' --count --longest --junit' ;;
    'test io') options+=' --expect --for --junit' ;;
    'test jog') options+=' --for --tolerance --stop-within --accel --csv --junit --limit --max-torque --max-following-error --window --turn --master-node --plot' ;;
    'test home') options+=' --repeat --spread --encoder --csv --junit --limit --max-torque --max-following-error --window --turn --master-node --plot' ;;
    'test all') options+=' --expect --for --tolerance --stop-within --no-home --repeat --spread --encoder --accel --junit --limit --max-torque --max-following-error --window --turn --master-node --plot' ;;
    'report') options+=' --output --title --tests' ;;
    'sync start') options+=' --period --counter --for' ;;
    'watch') options+=' --every --for --changes --plot' ;;
    'scope') options+=' --for --map --every --csv --svg --plot' ;;
    'monitor') options+=' --for --service --object --ask --bitrate --table --raw' ;;
    'decode') options+=' --raw --service --object' ;;
    'replay') options+=' --speed --only --master' ;;
    'run') options+=' --var --frames --check' ;;
    'gateway') options+=' --listen --allow' ;;
  esac
}

# Data sheets in a folder, given as it was typed; those with signs the shell reads are left out.
_servoctl_sheets() {
  find "${1:-.}" -maxdepth 1 -type f \( -name '*.eds' -o -name '*.dcf' -o -name '*.[xX][mM][lL]' \) 2>/dev/null |
    sed 's|.*/||' | grep -v '[^A-Za-z0-9._+-]' | while IFS= read -r sheet; do printf '%s%s\n' "$1" "$sheet"; done
}

_servoctl_words() {
  case $source in
    '='*) printf '%s\n' "${source#=}" | tr ' ' '\n' ;;
    objects|parameters)
      [ -z "$drive" ] || servoctl completion "$source" -d "$drive" 2>/dev/null ;;
    topics)
      servoctl completion topics ${drive:+"--drive=$drive"} 2>/dev/null ;;
    families)
      servoctl completion families 2>/dev/null
      _servoctl_sheets "${typed%"${typed##*/}"}" ;;
    buses)
      local interface
      for interface in /sys/class/net/*; do
        case $(cat "$interface/type" 2>/dev/null) in
          280) printf '%s\n' "${interface##*/}" ;;
          1) [ -e "$interface/phy80211" ] || printf '%s\n' "coe:${interface##*/}" ;;
        esac
      done
      find /dev -maxdepth 1 \( -name 'ttyUSB*' -o -name 'ttyACM*' \) 2>/dev/null | sed 's|.*|slcan:&\nmodbus:&|'
      printf '%s\n' sim: local: slcan:/dev/ socketcand:// gateway:// coe:local: coe:sim: modbus: modbus:sim: ;;
  esac
}

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
