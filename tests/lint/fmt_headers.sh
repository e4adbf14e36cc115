#!/usr/bin/env bash
# The program that is shipped has {fmt} inside, and of it <fmt/format.h> alone: another header links in a debug build and
# not in that one.
# usage: fmt_headers.sh SOURCE_DIR
set -euo pipefail
cd "$1"
[ "$(grep -rl '#include <fmt/format.h>' src commands | wc -l)" -ge 20 ] || { echo "no file includes fmt: the test itself is broken"; exit 1; }
! grep -rn '#include <fmt/' src commands --include='*.cpp' --include='*.hpp' | grep -vE '<fmt/format.h>|fmt_inside.cpp'
