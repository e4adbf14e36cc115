#!/usr/bin/env python3
"""Every error of the cabinet is shown whole somewhere: in tests/cli/cabinet/said.txt or in a golden case.

  cabinet_errors.py ROOT

Reads the literals in calls that make an error, in src/cabinet, commands/cabinet_*.cpp and src/cli/shell_axes.cpp.
"""
import glob
import re
import sys

import catalogue

CALL = re.compile(r'\b(fail|make_error|drive_error|cabinet_error|file_error|fail_at|at_place|refuse|other_drive)\(')
# What stands for an axis that a Ctrl-C left out: no line of a golden case ends itself.
ELSEWHERE = ('not read', 'not looked at', 'it was done on the buses above, and not on the others')


def calls(source):
    """The text of each call, without those inside it counted twice."""
    at = 0
    while match := CALL.search(source, at):
        depth, at = 1, match.end()
        while depth:
            token = catalogue.TOKEN.match(source, at)
            depth += {'(': 1, ')': -1}.get(token.group(0), 0)
            at = token.end()
        yield source[match.end():at - 1]


def literals(text):
    current = None
    for token in catalogue.TOKEN.finditer(text + ';'):
        if token.group('text') is not None:
            current = (current or '') + catalogue.unescaped(token.group('text'))
        elif not token.group(0).isspace() and current is not None:
            yield current
            current = None


def pieces(text):
    """What stands between the placeholders."""
    text = text.replace('{{', '\1').replace('}}', '\2')
    parts = catalogue.PLACE.sub('\0', text.strip()).split('\0')
    return [re.sub(r'\s+', ' ', part).replace('\1', '{').replace('\2', '}') for part in parts if part.strip()]


def main(root):
    files = (glob.glob(root + '/src/cabinet/*.cpp') + glob.glob(root + '/commands/cabinet_*.cpp') +
             [root + '/src/cli/shell_axes.cpp'])
    # Commands in hints have the place of their line behind them: as they stand in the source.
    shown = ''
    for path in glob.glob(root + '/tests/cli/golden/*.txt') + [root + '/tests/cli/cabinet/said.txt']:
        with open(path, encoding='utf-8', errors='replace') as file:
            text = re.sub(r'\s+', ' ', file.read().replace('\\"', '"'))
            shown += text + re.sub(r'`([a-z ]+?)( (-[bnd]|--cabinet) [^ `]+)+`', r'`\1`', text)
    bad = number = 0
    for path in sorted(files):
        with open(path, encoding='utf-8') as file:
            source = file.read()
        for text in dict.fromkeys(one for call in calls(source) for one in literals(call)):
            if not catalogue.is_for_people(text) or text in ELSEWHERE:
                continue
            number += 1
            if all(piece in shown for piece in pieces(text)):
                continue
            bad += 1
            print(f'{path}: shown nowhere: "{text}"')
    if number < 80:
        print(f'only {number} texts of errors were found: the check itself is broken')
        return 1
    if bad:
        print('add a case to tests/cli/cabinet/errors.txt, and write the outputs anew: ./dev golden')
    return 1 if bad else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else '.'))
