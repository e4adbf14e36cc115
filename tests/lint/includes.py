#!/usr/bin/env python3
"""What a file names of another folder, a header that it includes declares, itself or through others.

  includes.py ROOT

Where headers are precompiled, or several files compiled as one, a file is built with what others included, and fails alone. Checked are
names with their namespace, `settings::refuse_energised`, and classes of the file's own namespace. Names of `std::` need their header
(std_headers.txt) in the file or in one of ours that it includes: which header of the library includes which others changes with each
version of it.
"""
import functools
import os
import re
import sys

SOURCES = ('src', 'commands', 'tests')
COMMENT = re.compile(r'//[^\n]*|/\*.*?\*/', re.S)
STRING = re.compile(r'R"(\w*)\(.*?\)\1"|"(?:[^"\\\n]|\\.)*"', re.S)
INCLUDE = re.compile(r'^#include "([^"]+)"', re.M)
SCOPE = re.compile(r'\bnamespace (?:\w+::)*(\w+) \{')
CLASS = re.compile(r'^(?:template <[^>]*>\s*)?(?:struct|class|enum class|enum) (?:\[\[\w+\]\] )?(\w+)', re.M)
ALIAS = re.compile(r'^using (\w+) =', re.M)
VALUE = re.compile(r'^(?:inline |extern )?(?:constexpr|const) [^;=(]*?\b(k[A-Z]\w*)', re.M)
FUNCTION = re.compile(r'^(?:template <[^>]*>\s*)?[A-Za-z_:<][\w:<>,&* ]*[ &*>](\w+)\(', re.M)
SYSTEM_INCLUDE = re.compile(r'^#include <([^>]+)>', re.M)
STANDARD = re.compile(r'\bstd::(?:ranges::(?=\w))?(\w+)')
INNER = re.compile(r'\b(?:enum class|enum|struct|class|using) (\w+)')
QUALIFIED = re.compile(r'(?<![\w:])(?:\w+::)*?(\w+)::(\w+)\b')
PLAIN_CLASS = re.compile(r'(?<![\w:.>])([A-Z][a-z]\w+)\b')


def read(path):
    with open(path, encoding='utf-8') as file:
        return file.read()


def standard_headers():
    """The headers that have a name of namespace std, any of which will do."""
    out, headers = {}, ()
    for line in read(os.path.join(os.path.dirname(os.path.abspath(__file__)), 'std_headers.txt')).splitlines():
        if line.startswith('#'):
            continue
        if not line.startswith(' '):
            left, line = line.split(':')
            headers = left.split()
        out.update({name: headers for name in line.split()})
    return out


class Tree:
    def __init__(self, root):
        self.root = root
        self.texts = {}
        for top in SOURCES:
            for folder, _, names in os.walk(os.path.join(root, top)):
                for name in names:
                    if name.endswith(('.cpp', '.hpp')):
                        path = os.path.relpath(os.path.join(folder, name), root)
                        self.texts[path] = read(os.path.join(root, path))
        self.includes = {path: self.included(path) for path in self.texts}
        self.code = {path: STRING.sub('""', COMMENT.sub('', text)) for path, text in self.texts.items()}
        self.inner = {path: set(INNER.findall(code)) for path, code in self.code.items()}
        self.standard = standard_headers()
        self.system = {path: set(SYSTEM_INCLUDE.findall(text)) for path, text in self.texts.items()}
        self.declared = {}  # (namespace, name): the headers
        for path, code in self.code.items():
            if path.endswith('.hpp'):
                for name in self.names_in(code):
                    self.declared.setdefault(name, set()).add(path)

    def included(self, path):
        out = set()
        for name in INCLUDE.findall(self.texts[path]):
            for place in (name, 'src/' + name, os.path.normpath(os.path.join(os.path.dirname(path), name))):
                if place in self.texts:
                    out.add(place)
                    break
        return out

    @staticmethod
    def names_in(code):
        """Names at the left edge of the lines of a namespace; what stands in classes is indented."""
        scopes = list(SCOPE.finditer(code))
        for scope, following in zip(scopes, scopes[1:] + [None]):
            part = code[scope.end():following.start() if following else len(code)]
            for rule in (CLASS, ALIAS, VALUE, FUNCTION):
                for found in rule.finditer(part):
                    yield scope.group(1), found.group(1)

    @functools.lru_cache(maxsize=None)
    def reached(self, path):
        out, todo = {path}, [path]
        while todo:
            for each in self.includes[todo.pop()] - out:
                out.add(each)
                todo.append(each)
        return frozenset(out)

    def missing(self, path):
        """Names of the file that no header it reaches declares, with the header that does."""
        code = self.code[path]
        used = {(found.group(1), found.group(2)) for found in QUALIFIED.finditer(code)}
        for scope in set(SCOPE.findall(code)):
            used |= {(scope, name) for name in PLAIN_CLASS.findall(code)}
        own = {name for each in self.reached(path) for name in self.inner[each]}
        for scope, name in sorted(used):
            headers = self.declared.get((scope, name), set())
            if headers and name not in own and not headers & self.reached(path):
                yield f'{scope}::{name}', sorted(headers)[0]
        system = set().union(*(self.system[each] for each in self.reached(path)))
        for name in sorted(set(STANDARD.findall(code))):
            if name not in self.standard:
                yield f'std::{name}', 'no header that std_headers.txt names for it'
            elif system.isdisjoint(self.standard[name]):
                yield f'std::{name}', f'<{self.standard[name][0]}>'
        if 'fmt::' in code and not any('#include <fmt/' in self.texts[each] for each in self.reached(path)):
            yield 'fmt', '<fmt/format.h>'


def main():
    tree = Tree(sys.argv[1])
    bad = 0
    for path in sorted(tree.texts):
        for name, header in tree.missing(path):
            print(f'{path}: names {name}, and includes {header} neither itself nor through others')
            bad += 1
    names = len(tree.declared)
    if names < 1000:
        sys.exit(f'only {names} names were found in headers: the rules of this script no longer fit them')
    print(f'checked {len(tree.texts)} files for {names} names')
    return 1 if bad else 0


sys.exit(main())
