#!/usr/bin/env bash
# Drives real shells with the generated completion scripts.
# usage: completion_shells.sh SERVOCTL SOURCE_DIR
set -u
servoctl=$(readlink -f "$1")
source_dir=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
ln -s "$servoctl" "$work/servoctl"
PATH="$work:$PATH"
export PATH SERVOCTL_DRIVES="$source_dir/tests/cli/data/explain:$source_dir/eds"
unset SERVOCTL_DRIVE SERVOCTL_BUS SERVOCTL_NODE
failures=0
contains() {  # contains NAME "WORD WORD" CANDIDATES
  local word
  for word in $2; do
    case " $(tr '\n' ' ' <<<"$3") " in
      *" $word "*) ;;
      *) failures=$((failures + 1)); printf 'FAILED %s: %s is not offered in: %s\n' "$1" "$word" "$(tr '\n' ' ' <<<"$3" | cut -c1-200)" ;;
    esac
  done
}

bash_complete() {  # bash_complete WORD… : the last word is completed
  bash --norc -c '
    source "$1"; shift
    COMP_WORDS=(servoctl "$@"); COMP_CWORD=$#
    _servoctl
    printf "%s\n" "${COMPREPLY[@]}"' _ "$source_dir/completions/servoctl.bash" "$@"
}
cases() {  # cases SHELL FUNCTION
  contains "$1 first word" "scan read param nmt help" "$($2 '')"
  contains "$1 par" "param" "$($2 par)"
  contains "$1 second word" "list get set search explain" "$($2 param '')"
  contains "$1 parameter" "Pn0202 Pn0214" "$($2 --bus can0 -d gsd600 param set Pn02)"
  contains "$1 parameter in lower case" "Pn0202" "$($2 -d gsd600 param get pn0202)"
  contains "$1 topic" "CN3 statusword" "$($2 explain -d x1 '')"
  contains "$1 topic of the standard" "pp" "$($2 explain '')"
  contains "$1 object" "statusword" "$($2 -n 1 -d gsd600 read stat)"
  contains "$1 option" "--bus" "$($2 --b)"
  contains "$1 option of a command" "--type --timeout" "$($2 read 0x6041 --t)"
  contains "$1 choice" "text json jsonl" "$($2 -o '')"
  contains "$1 family" "gsd600" "$($2 -d '')"
  contains "$1 data sheet" "$source_dir/tests/cli/data/p20.xml $source_dir/tests/cli/data/node.eds" "$($2 -d "$source_dir/tests/cli/data/")"
  contains "$1 bus" "sim: local:" "$($2 -b '')"
}
cases bash bash_complete
if [ -n "$(bash_complete read stat)" ]; then failures=$((failures + 1)); echo "FAILED bash: names are offered without a drive"; fi

if command -v fish >/dev/null; then
  fish_complete() {
    local line=servoctl word
    for word in "$@"; do line="$line $word"; done
    fish --no-config -c "source $source_dir/completions/servoctl.fish; complete -C '$line'" | cut -f1
  }
  cases fish fish_complete
else
  echo "SKIP fish is not installed"
fi
if command -v zsh >/dev/null; then
  zsh -n "$source_dir/completions/_servoctl" || failures=$((failures + 1))
  zsh_complete() {
    zsh -f -c '
      compadd() { while [ "$1" != "--" ]; do shift; done; shift; print -l -- "$@"; }
      _files() { :; }
      compdef() { :; }
      script=$1; shift
      source $script
      words=(servoctl "$@"); CURRENT=$(( $# + 1 ))
      _servoctl' _ "$source_dir/completions/_servoctl" "$@"
  }
  cases zsh zsh_complete
else
  echo "SKIP zsh is not installed"
fi
printf '%d failed\n' "$failures"
[ "$failures" -eq 0 ]
