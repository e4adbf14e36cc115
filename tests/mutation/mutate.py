#!/usr/bin/env python3
"""Breaks the code of a layer in one small way at a time and runs the layer's tests: what survives is a missing test.

usage: mutate.py [--count N] [--seed S] [--jobs J] LAYER...     (LAYER: canopen, od, ...)

Works on a copy of the source tree. Prints every survivor as FILE:LINE with the line before and after; exit code 1 when
there is one that tests/mutation/explained.txt does not name.
"""
import argparse
import concurrent.futures
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SWAPS = [(" == ", " != "), (" != ", " == "), (" < ", " <= "), (" > ", " >= "), (" <= ", " < "), (" >= ", " > "),
         (" && ", " || "), (" || ", " && "), (" + ", " - "), (" - ", " + "), (" & ", " | "), (" | ", " & "),
         ("return true;", "return false;"), ("return false;", "return true;"), ("++", "--"), ("if (!", "if (")]
NUMBER = re.compile(r"(?<![\w.'])(0x[0-9A-Fa-f']+|\d+)(?=U?\b)")
STATEMENT = re.compile(r"^\s+[\w.>\-\[\]*()]+(\(.*\)| [+\-|&^]?= .*);\s*$")


def code_of(line):
    """The line with string literals and comments blanked, same length."""
    blanked = re.sub(r'"(\\.|[^"\\])*"|\'(\\.|[^\'\\])\'', lambda m: "~" * len(m.group()), line)
    comment = blanked.find("//")
    return blanked if comment < 0 else blanked[:comment] + "~" * (len(blanked) - comment)


def mutations_of(path):
    """All (line number, mutated line) of a file."""
    out = []
    for number, line in enumerate(path.read_text().split("\n")):
        code = code_of(line)
        if code.lstrip().startswith(("#", "///", "static_assert", "using", "namespace", "}")):
            continue
        for old, new in SWAPS:
            for found in re.finditer(re.escape(old), code):
                out.append((number, line[:found.start()] + new + line[found.end():]))
        for found in NUMBER.finditer(code):
            text = found.group().replace("'", "")
            value = int(text, 16 if text.startswith("0x") else 10) + 1
            out.append((number, line[:found.start()] + (hex(value) if text.startswith("0x") else str(value)) + line[found.end():]))
        if STATEMENT.match(code) and "return" not in code:
            out.append((number, re.match(r"\s*", line).group() + ";"))
    return out


class Tree:
    """A copy of the source with a build folder of its own."""

    def __init__(self, folder, layers):
        self.source = folder / "source"
        self.build = folder / "build"
        self.layers = layers
        shutil.copytree(ROOT, self.source, ignore=shutil.ignore_patterns("build", ".git"))
        self.run("cmake", "-S", self.source, "-B", self.build, "-DSERVOCTL_TESTS=ON", "-DCMAKE_BUILD_TYPE=Debug",
                 "-DCMAKE_CXX_FLAGS=-O0 -w", "-DCMAKE_CXX_FLAGS_DEBUG=")
        for layer in layers:
            if self.test(layer) != "survived":
                sys.exit(f"mutate: the tests of {layer} fail without a mutation")

    @staticmethod
    def run(*command, timeout=600):
        return subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              timeout=timeout, check=False).returncode

    def test(self, layer):
        target = f"{layer}_tests"
        if self.run("cmake", "--build", self.build, "--target", target) != 0:
            return "stillborn"
        try:
            code = self.run(self.build / "tests" / target, "--gtest_brief=1", timeout=60)
        except subprocess.TimeoutExpired:
            return "killed"
        return "survived" if code == 0 else "killed"

    def mutate(self, layer, path, number, line):
        file = self.source / path
        original = file.read_text()
        lines = original.split("\n")
        lines[number] = line
        file.write_text("\n".join(lines))
        try:
            return self.test(layer)
        finally:
            file.write_text(original)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("layers", nargs="+")
    arguments.add_argument("--count", type=int, default=100)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--jobs", type=int, default=1)
    options = arguments.parse_args()
    every = [(layer, path.relative_to(ROOT), number, line) for layer in options.layers
             for path in sorted((ROOT / "src" / layer).glob("*.cpp")) for number, line in mutations_of(path)]
    chosen = random.Random(options.seed).sample(every, min(options.count, len(every)))
    explained = (ROOT / "tests/mutation/explained.txt").read_text()
    counts = {"killed": 0, "stillborn": 0, "survived": 0, "explained": 0}
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        trees = list(pool.map(lambda i: Tree(pathlib.Path(folder) / str(i), options.layers), range(options.jobs)))

        def work(share):
            out = []
            for mutation in chosen[share::options.jobs]:
                out.append((mutation, trees[share].mutate(*mutation)))
            return out

        for results in pool.map(work, range(options.jobs)):
            for (_, path, number, line), outcome in results:
                before = (ROOT / path).read_text().split("\n")[number].strip()
                if outcome == "survived" and f"{path}: {before} => {line.strip()}" in explained:
                    outcome = "explained"
                counts[outcome] += 1
                if outcome == "survived":
                    print(f"{path}:{number + 1}: {before}  =>  {line.strip()}", flush=True)
    print(f"{len(every)} possible, {len(chosen)} tried: " + ", ".join(f"{n} {k}" for k, n in counts.items()))
    return 1 if counts["survived"] else 0


if __name__ == "__main__":
    sys.exit(main())
