#!/usr/bin/env bash
# Runs the benchmarks and times whole processes. usage: run.sh BUILD_DIR
# Machines differ and are noisy: compare figures within one run, see bench/RESULTS.md.
set -euo pipefail
build=$1
"$build/bench/servoctl_bench" --benchmark_min_time=0.2

python3 - "$build/servoctl" <<'PYTHON'
import os, statistics, subprocess, sys, time

servoctl = sys.argv[1]
env = dict(os.environ, SERVOCTL_BUS="sim:gsd600@1", SERVOCTL_DRIVE="")


def run(words):
    begin = time.perf_counter()
    subprocess.run(words, env=env, stdout=subprocess.DEVNULL, check=True)
    return (time.perf_counter() - begin) * 1e3


def peak(words):
    # A child of this process would count this process's memory as its own; one of time(1) does not.
    timed = subprocess.run(["/usr/bin/time", "-f", "%M", *words], env=env, stdout=subprocess.DEVNULL,
                           stderr=subprocess.PIPE, check=True, text=True)
    return int(timed.stderr.split()[-1]) / 1024


print("\nwhole processes, 30 runs each, after one to warm up   median ms   peak MiB")
for name, words in {
    "true (the floor)": ["true"],
    "servoctl --version": [servoctl, "--version"],
    "servoctl help": [servoctl, "help"],
    "servoctl param explain Pn0202 -d gsd600": [servoctl, "param", "explain", "Pn0202", "-d", "gsd600"],
    "servoctl read 0x6041 -n 1 (drive simulated inside)": [servoctl, "read", "0x6041", "-n", "1"],
}.items():
    run(words)
    times = [run(words) for _ in range(30)]
    print(f"{name:<54} {statistics.median(times):9.2f} {peak(words):10.1f}")
PYTHON

echo
"$(dirname "$0")/../tests/with-vcan.sh" "$(cd "$(dirname "$0")" && pwd)/vcan.sh" "$(cd "$build" && pwd)" || echo "vcan0: not available here"
