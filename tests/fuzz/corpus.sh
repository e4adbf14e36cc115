#!/usr/bin/env bash
# The inputs of a fuzz target are one archive, tests/fuzz/corpus/NAME.tar.gz.
# usage: corpus.sh unpack ARCHIVE FOLDER | pack FOLDER ARCHIVE | replay PROGRAM ARCHIVE
set -euo pipefail
case $1 in
  unpack)
    mkdir -p "$3"
    if [ -e "$2" ]; then tar -xzf "$2" -C "$3"; fi
    ;;
  pack)  # The same inputs make the same archive.
    (cd "$2" && find . -type f -printf '%P\0' | sort -z |
      tar --owner=0 --group=0 --numeric-owner --mode=644 --mtime=@0 --null -T - -cf -) | gzip -9n >"$3"
    ;;
  replay)
    inputs=$(mktemp -d)
    trap 'rm -rf "$inputs"' EXIT
    tar -xzf "$3" -C "$inputs"
    "$2" "$inputs"
    ;;
  *) exit 2 ;;
esac
