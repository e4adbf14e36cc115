#!/usr/bin/env bash
# Prints a Python that has python-can (Debian: python3-can); says so and fails where there is none.
for python in python3 /usr/bin/python3; do
  "$python" -c 'import can' 2>/dev/null && echo "$python" && exit 0
done
echo 'python-can is not here (apt-get install python3-can): left out' >&2
exit 1
