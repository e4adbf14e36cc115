#!/usr/bin/env python3
"""Every relative link of README, CONTRIBUTING, CHANGELOG and docs/ leads to a file that exists, and its anchor to a heading or a named
place there. Every page of docs/ is reached from README.md by links, and stands in the index docs/README.md (the Chinese pages in
docs/zh/README.md); architecture.md is linked from README.md and CONTRIBUTING.md.

usage: links_test.py SERVOCTL SOURCE_DIR
"""
import glob
import os
import re
import sys

source = os.path.abspath(sys.argv[2])
os.chdir(source)
PAGES = ["README.md", "README.zh.md", "CONTRIBUTING.md", "CHANGELOG.md", *sorted(glob.glob("docs/**/*.md", recursive=True))]


def prose(page):
    """The page without its blocks of code, and without code in sentences but for headings."""
    with open(page, encoding="utf-8") as file:
        return re.sub(r"^```.*?^```", "", file.read(), flags=re.S | re.M)


def anchor(heading):
    """The name that GitHub gives a heading."""
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors(page):
    text = prose(page)
    names = [anchor(each) for each in re.findall(r"^#+ (.*)$", text, flags=re.M)]
    numbered = [name if names[:i].count(name) == 0 else f"{name}-{names[:i].count(name)}" for i, name in enumerate(names)]
    return set(numbered) | set(re.findall(r'<a id="([^"]+)">', text))


def links(page):
    """(target, anchor) of every relative link of a page, as paths below the source folder."""
    text = re.sub(r"`[^`\n]*`", "`", prose(page))
    for target in re.findall(r"\]\(([^()\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, name = target.partition("#")
        yield os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page, name


def main():
    problems, seen = [], 0
    for page in PAGES:
        for target, name in links(page):
            seen += 1
            if not os.path.exists(target):
                problems.append(f"{page}: there is no {target}")
            elif name and target.endswith(".md") and name not in anchors(target):
                problems.append(f"{page}: {target} has no #{name}")
    reached, waiting = set(), ["README.md"]
    while waiting:
        page = waiting.pop()
        if page in reached or not page.endswith(".md") or not os.path.exists(page):
            continue
        reached.add(page)
        waiting += [target for target, _ in links(page)]
    problems += [f"{page}: no link from README.md leads there" for page in PAGES if page not in reached]
    for index in ("docs/README.md", "docs/zh/README.md"):
        if not os.path.exists(index):
            problems.append(f"there is no {index}")
            continue
        listed = {target for target, _ in links(index)}
        problems += [f"{index} does not list {page}" for page in glob.glob(os.path.dirname(index) + "/*.md") if page != index and page not in listed]
    for page in ("README.md", "CONTRIBUTING.md"):
        if "docs/architecture.md" not in {target for target, _ in links(page)}:
            problems.append(f"{page} does not link docs/architecture.md")
    if seen < 150:
        problems.append(f"only {seen} links: the test itself is broken")
    print("\n".join(problems) or f"{seen} links of {len(PAGES)} pages lead somewhere")
    return bool(problems)


sys.exit(main())
