#!/usr/bin/env bash
# What the version is in a repository, with a tag, behind it, with changes, and without git.
# usage: version_test.sh SERVOCTL SOURCE_DIR
set -euo pipefail
servoctl=$(readlink -f "$1")
source=$(readlink -f "$2")
command -v git >/dev/null || { echo "git is missing"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
mkdir "$work/tree"
cd "$work/tree"
echo text >CHANGELOG.md
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@b GIT_COMMITTER_NAME=a GIT_COMMITTER_EMAIL=a@b
export GIT_AUTHOR_DATE='2026-02-03T23:30:00 -0200' GIT_COMMITTER_DATE='2026-02-03T23:30:00 -0200'
unset GIT_DIR GIT_WORK_TREE GIT_INDEX_FILE

check() {  # check NAME PATTERN
  cmake -DSOURCE="$work/tree" -DPROJECT=0.1.0 -DINTO="$work/out" -P "$source/packaging/version.cmake"
  local is
  is=$(head -1 "$work/out/version.txt")
  # shellcheck disable=SC2053
  [[ $is == $2 ]] || { echo "$1: $is is not $2"; failures=$((failures + 1)); }
}
check 'without git' 0.1.0
git init -q .
check 'without a commit, as of a tree that git does not trust' '0.1.0~unknown'
git add . && git commit -qm one
check 'without a tag' '0.1.0~1.g???????'
echo more >>CHANGELOG.md
check 'changed' '0.1.0~1.g???????.dirty'
git commit -qam two && git tag v0.2.0
check 'at a tag' 0.2.0
touch untracked
check 'an untracked file' 0.2.0
written=$(stat -c %y "$work/out/version.cpp")
check 'again' 0.2.0
[ "$written" = "$(stat -c %y "$work/out/version.cpp")" ] || { echo "version.cpp is written although nothing changed"; failures=$((failures + 1)); }
grep -q '"2026-02-04"' "$work/out/version.cpp" || { echo "the day is not that of the commit, in UTC"; failures=$((failures + 1)); }
echo more >>CHANGELOG.md
check 'a tag, changed' 0.2.0+dirty
git commit -qam three
check 'behind a tag' '0.2.0+1.g???????'
git tag v0.3.0-rc1
check 'a candidate' '0.3.0~rc1'
mkdir -p sub && cp CHANGELOG.md sub && mv "$work/tree/sub" "$work/tree2" && mv "$work/tree" "$work/outer" && mv "$work/tree2" "$work/outer/tree" &&
  ln -s "$work/outer/tree" "$work/tree"
check 'inside the repository of something else' 0.1.0

[[ $("$servoctl" --version) =~ ^servoctl\ [0-9]+\.[0-9]+\.[0-9]+([~+][0-9a-z.+]+)?$ ]] || { "$servoctl" --version; failures=$((failures + 1)); }
exit $((failures > 0))
