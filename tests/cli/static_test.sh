#!/usr/bin/env bash
# The program of the tarball is one file: it asks for no library and no loader. It finds hosts in /etc/hosts all the same.
# usage: static_test.sh SERVOCTL
set -euo pipefail
if readelf -lW "$1" | grep -E 'INTERP|NEEDED'; then
  echo "it is not statically linked" >&2
  exit 1
fi
# Nobody listens there: the address is tried, not the name refused.
said=$("$1" read 0x1000 -n 1 -b socketcand://localhost:9/can0 --timeout 500ms 2>&1) && { echo "who answers? $said" >&2; exit 1; }
if ! grep -q 'nothing listens at localhost' <<<"$said"; then
  echo "localhost is not found: $said" >&2
  exit 1
fi
echo "one file"
