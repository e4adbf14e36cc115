#!/usr/bin/env python3
"""The texts of the sources and their Chinese.

  catalogue.py ROOT                checks: every text for people stands in src/report/zh.po with its Chinese, or in
                                   src/report/not_for_people.po; no entry is in no source any more; placeholders with their formats, and
                                   what stands in backticks, are the same in both languages
  catalogue.py ROOT update         adds what is missing, without Chinese, and drops what is in no source
  catalogue.py ROOT merge FILE...  takes the Chinese, and `#. not for people: WHY`, of other PO files

A text for people is a literal with a blank and two letters. Words without a blank stand in zh.po where people see them: column
heads, states. What stands in no literal, because it is put together (`comm test`), has the remark `#. made of: WHAT`; `#. names: 0, 2` says at
which placeholders (from 0) names of commands, files or axes stand, which stay as they are although they look like words.
Sources have no Chinese, but for the few that are listed below with the reason.
"""
import glob
import os
import re
import sys

CATALOGUE = 'src/report/zh.po'
OTHERS = 'src/report/not_for_people.po'
# Chinese in sources: below the layer of the catalogue, or what is recognised and not said.
CHINESE_SOURCES = {
    'src/can/log_column_names.cpp': 'headings that are recognised',
    'src/can/log_fields.cpp': 'words that are recognised',
    'src/drive/foreign_faults.cpp': 'headings that are recognised',
    'src/drive/foreign_heading.cpp': 'cells that say nothing',
    'src/drive/foreign_parameter_headings.cpp': 'headings that are recognised',
    'src/drive/foreign_cells.cpp': 'words and marks that are recognised',
    'src/drive/foreign_words.cpp': 'words that are recognised',
    'src/drive/cia402.cpp': 'names of states, in both languages as the data of the families are',
    'src/od/esi_entry.cpp': 'notes of entries made from a file, in both languages as those of the data are',
    'src/od/esi_pdos.cpp': 'notes and names of entries made from a file, likewise',
    'src/od/table_row.cpp': 'an example of a column that is in Chinese',
    'src/session/online_dictionary.cpp': 'notes of entries that a slave tells, in both languages as those of the data are',
    'src/cli/terminal/colour.cpp': 'words whose colour means something',
    'src/report/chinese_marks.cpp': 'marks',
    'src/report/chinese_marks.hpp': 'marks',
    'src/report/translation.cpp': 'words and marks between the parts of a list',
    'src/base/message.cpp': 'what is before the number of a node',
    'src/show/axis_names.cpp': 'what is before the number of a node',
    'src/show/lead_words.cpp': 'words that people type',
    'src/show/topic_query.cpp': 'words that people type',
}
NOT_FOR_PEOPLE = 'not for people'
MADE_OF = 'made of'
TOKEN = re.compile(r'R"\((?P<raw>.*?)\)"|"(?P<text>(?:[^"\\\n]|\\.)*)"|//[^\n]*|/\*.*?\*/|\'(?:[^\'\\]|\\(?:x[0-9A-Fa-f]+|[0-7]{1,3}|.))\'|\s+|.', re.S)
ESCAPE = re.compile(r'\\(x[0-9A-Fa-f]+|u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8}|[0-7]{1,3}|.)', re.S)
PLACE = re.compile(r'\{(\d*)(:(?:[^{}\n]|\{\d*\})*)?\}')
PLAIN = {'n': '\n', 't': '\t', 'r': '\r', 'a': '\a', 'b': '\b', 'e': '\x1b', 'f': '\f', 'v': '\v'}


def unescaped(text):
    def one(match):
        code = match.group(1)
        if code[0] in 'xuU' and len(code) > 1:
            return chr(int(code[1:], 16))
        if code[0] in '01234567':
            return chr(int(code, 8))
        return PLAIN.get(code, code)
    return ESCAPE.sub(one, text)


def escaped(text):
    return text.replace('\\', '\\\\').replace('"', '\\"').replace('\n', '\\n').replace('\t', '\\t').replace('\r', '\\r')


def literals(root):
    """{text: [files]}; neighbours without anything between them are one."""
    out = {}
    files = sorted(glob.glob(root + '/src/**/*.[ch]pp', recursive=True)) + sorted(glob.glob(root + '/commands/*.[ch]pp'))
    for path in files:
        with open(path, encoding='utf-8') as file:
            source = re.sub(r'^[ \t]*#.*$', '', file.read(), flags=re.M)
        name = os.path.relpath(path, root)
        current = None
        for token in TOKEN.finditer(source):
            raw, text, whole = token.group('raw'), token.group('text'), token.group(0)
            if raw is not None or text is not None:
                current = (current or '') + (unescaped(text) if raw is None else raw)
            elif not whole.isspace() and not whole.startswith(('//', '/*')) and current is not None:
                places = out.setdefault(current, [])
                if name not in places:
                    places.append(name)
                current = None
    return out


def is_for_people(text):
    words = PLACE.sub('', text)
    return ' ' in text.strip() and re.search('[A-Za-z]{2}', words) and not re.search('[\u4e00-\u9fff]', text)


class Entry:
    def __init__(self, text='', chinese='', remarks=(), files=()):
        self.text, self.chinese, self.remarks, self.files = text, chinese, list(remarks), list(files)

    def says(self, remark):
        return any(line.startswith(remark) for line in self.remarks)


def read(path):
    """{text: entry} of a PO file whose strings take a line each, or several."""
    entries, entry, part = {}, Entry(), None
    if not os.path.exists(path):
        return entries

    def done():
        if part == 'msgstr' and entry.text:
            entries.setdefault(entry.text, entry)

    with open(path, encoding='utf-8') as file:
        for line in file.read().split('\n') + ['msgid ""']:
            line = line.strip()
            if line.startswith(('#', 'msgid ')) and part == 'msgstr':
                done()
                entry, part = Entry(), None
            if line.startswith('#.'):
                entry.remarks.append(line[2:].strip())
            elif line.startswith('#:'):
                entry.files.append(line[2:].strip())
            elif line.startswith('msgid '):
                part, entry.text = 'msgid', unescaped(line[7:-1])
            elif line.startswith('msgstr '):
                part, entry.chinese = 'msgstr', unescaped(line[8:-1])
            elif line.startswith('"'):
                if part == 'msgid':
                    entry.text += unescaped(line[1:-1])
                else:
                    entry.chinese += unescaped(line[1:-1])
    return entries


def write(path, entries, about):
    ordered = sorted(entries.values(), key=lambda e: (e.files[:1] or [''], e.text))
    with open(path, 'w', encoding='utf-8') as file:
        file.write(f'# {about}\nmsgid ""\nmsgstr "Content-Type: text/plain; charset=UTF-8\\n"\n')
        for entry in ordered:
            file.write('\n' + ''.join(f'#. {line}\n' for line in entry.remarks))
            file.write(''.join(f'#: {name}\n' for name in entry.files))
            file.write(f'msgid "{escaped(entry.text)}"\nmsgstr "{escaped(entry.chinese)}"\n')


def places(text):
    """Which arguments stand in it, from 0, each with its format: a code in hexadecimal is one in both languages."""
    text = text.replace('{{', '').replace('}}', '')
    found = [match.groups() for match in PLACE.finditer(text)]
    return sorted({(int(name) if name else at, form or '') for at, (name, form) in enumerate(found)})


def ticked(text):
    return sorted(PLACE.sub('{}', part) for part in re.findall('`([^`]*)`', text))


def wrong_in(entry):
    if not entry.chinese:
        return 'has no Chinese'
    if places(entry.text) != places(entry.chinese):
        return 'has other placeholders or formats in Chinese'
    if ticked(entry.text) != ticked(entry.chinese):
        return 'has something else in backticks in Chinese'
    return ''


def check(root):
    found, entries, others = literals(root), read(f'{root}/{CATALOGUE}'), read(f'{root}/{OTHERS}')
    wrong = []
    for text, files in found.items():
        if is_for_people(text) and text not in entries and text not in others:
            wrong.append(f'{files[0]}: not in {CATALOGUE}: "{escaped(text)}"')
        for name in files:
            if re.search('[\u4e00-\u9fff]', text) and name not in CHINESE_SOURCES:
                wrong.append(f'{name}: Chinese belongs into {CATALOGUE}: "{escaped(text)}"')
    for path, known in ((CATALOGUE, entries), (OTHERS, others)):
        for entry in known.values():
            if entry.text not in found and not entry.says(MADE_OF):
                wrong.append(f'{path}: in no source: "{escaped(entry.text)}"')
    for entry in entries.values():
        if why := wrong_in(entry):
            wrong.append(f'{CATALOGUE}: {why}: "{escaped(entry.text)}"')
        if entry.text in others:
            wrong.append(f'{CATALOGUE}: is not for people as well: "{escaped(entry.text)}"')
    for entry in others.values():
        if not entry.says(NOT_FOR_PEOPLE):
            wrong.append(f'{OTHERS}: says not why: "{escaped(entry.text)}"')
    return wrong


def update(root, merged=()):
    found, entries, others = literals(root), read(f'{root}/{CATALOGUE}'), read(f'{root}/{OTHERS}')
    for path in merged:
        for entry in read(path).values():
            if entry.says(NOT_FOR_PEOPLE) and entry.text not in entries:
                others[entry.text] = entry
            elif entry.chinese and entry.text not in others:
                entries[entry.text] = entry
    for text in found:
        if is_for_people(text) and text not in entries and text not in others:
            entries[text] = Entry(text)
    for known in (entries, others):
        for text in [text for text, entry in known.items() if text not in found and not entry.says(MADE_OF)]:
            del known[text]
        for entry in known.values():
            entry.files = sorted(found.get(entry.text, []))
    for text in set(others) & set(entries):
        del others[text]
    write(f'{root}/{CATALOGUE}', entries, 'The texts of servoctl in Chinese; tests/lint/catalogue.py checks and updates it (CONTRIBUTING.md).')
    write(f'{root}/{OTHERS}', others, 'Texts that stay as they are, and why; see zh.po.')


def main():
    if len(sys.argv) < 2 or (len(sys.argv) > 2 and sys.argv[2] not in ('update', 'merge')):
        sys.exit(__doc__)
    root = sys.argv[1].rstrip('/')
    if len(sys.argv) > 2:
        update(root, sys.argv[3:])
    wrong = check(root)
    for line in wrong:
        print(line)
    if wrong and len(sys.argv) == 2:
        print(f'`tests/lint/catalogue.py . update` adds and drops entries; the Chinese is written into {CATALOGUE}')
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    main()
