#!/usr/bin/env bash
# What the program that is shipped needs at its start: libc alone, and nothing of it that is only for the libc of one version.
# usage: self_contained_test.sh SERVOCTL
set -euo pipefail
needed=$(readelf -dW "$1" | awk '/NEEDED/ { print $NF }' | tr -d '[]' | grep -v '^ld-linux' | sort | tr '\n' ' ')
if [ "$needed" != "libc.so.6 " ]; then
  echo "needs $needed" >&2
  exit 1
fi
if readelf --dyn-syms -W "$1" | grep GLIBC_PRIVATE; then
  echo "works with one version of libc only" >&2
  exit 1
fi
echo "needs libc only"
