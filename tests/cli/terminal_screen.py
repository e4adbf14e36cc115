"""What a terminal of 80 columns and 24 rows shows of what a program writes. An escape sequence it does not know is an error."""
import codecs
import re
import unicodedata

COLUMNS, ROWS = 80, 24
BLANK = (" ", False)
CONTROL = re.compile(r"\x1b\[(\??)([0-9;]*)([A-Za-z])")


def width(character):
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


class Screen:
    """Rows of cells: a character (empty behind a wide one) and whether it is red."""

    def __init__(self):
        self.columns = COLUMNS
        self.rows = [[BLANK] * COLUMNS for _ in range(ROWS)]
        self.broken = [False] * ROWS  # The text of a row was too long for it, and goes on in the next.
        self.row = self.column = 0
        self.red = False
        self.decoder = codecs.getincrementaldecoder("utf-8")()
        self.rest = ""

    def take(self, data):
        text = self.rest + self.decoder.decode(data)
        self.rest = ""
        at = 0
        while at < len(text):
            if text[at] == "\x1b":
                found = CONTROL.match(text, at)
                if not found:
                    if len(text) - at > 20:
                        raise ValueError(f"no escape sequence: {text[at:at + 20]!r}")
                    self.rest = text[at:]
                    return
                self.control(*found.groups())
                at = found.end()
                continue
            self.put(text[at])
            at += 1

    def control(self, private, numbers, letter):
        first = int(numbers.split(";")[0] or 0)
        if private:
            if numbers != "2004":  # Marks of pastes.
                raise ValueError(f"mode {numbers} is not known")
        elif letter == "A":
            self.row = max(0, self.row - max(1, first))
        elif letter == "C":
            self.column = min(self.columns - 1, self.column + max(1, first))
        elif letter == "J" and first == 0:
            self.clear_row()
            for row in range(self.row + 1, ROWS):
                self.rows[row] = [BLANK] * self.columns
                self.broken[row] = False
        elif letter == "K" and first == 0:
            self.clear_row()
        elif letter == "m" and numbers in ("31", "32", "33"):
            pass  # Words with a meaning; the picture has the red of the prompt alone.
        elif letter == "m" and numbers in ("", "0", "1;31"):
            self.red = numbers == "1;31"
        else:
            raise ValueError(f"the control {numbers}{letter} is not known")

    def clear_row(self):
        self.rows[self.row][self.column:] = [BLANK] * (self.columns - min(self.column, self.columns))
        self.broken[self.row] = False

    def feed(self):
        if self.row < ROWS - 1:
            self.row += 1
            return
        self.rows.append([BLANK] * self.columns)
        self.broken.append(False)
        del self.rows[0], self.broken[0]

    def resize(self, columns):
        """Another width: text is broken anew, as most terminals do."""
        lines, cursor = [[]], (0, 0)
        for row, cells in enumerate(self.rows):
            cells = list(cells)
            while cells and cells[-1] == BLANK and not self.broken[row]:
                cells.pop()
            if row == self.row:
                before = cells[:self.column] + [BLANK] * (self.column - len(cells))
                cursor = len(lines) - 1, len(lines[-1]) + sum(1 for cell in before if cell[0])
            lines[-1] += [cell for cell in cells if cell[0]]
            if not self.broken[row]:
                lines.append([])
        self.columns = columns
        rows, broken, self.row, self.column = [], [], 0, 0
        for number, line in enumerate(lines[:-1]):
            rows.append([])
            broken.append(False)
            for at, cell in enumerate(line + [BLANK] * (cursor[1] + 1 - len(line) if number == cursor[0] else 0)):
                if len(rows[-1]) + width(cell[0]) > columns:
                    broken[-1] = True
                    rows.append([])
                    broken.append(False)
                if (number, at) == cursor:
                    self.row, self.column = len(rows) - 1, len(rows[-1])
                rows[-1] += [cell, ("", cell[1])] if width(cell[0]) == 2 else [cell]
        while len(rows) > ROWS and self.row < len(rows) - 1 and not rows[-1]:
            del rows[-1], broken[-1]
        gone = max(0, len(rows) - ROWS)
        lacking = ROWS - len(rows) + gone
        self.row -= gone
        rows, self.broken = rows[gone:] + [[]] * lacking, broken[gone:] + [False] * lacking
        self.rows = [row + [("", False) if goes_on else BLANK] * (columns - len(row)) for row, goes_on in zip(rows, self.broken)]

    def put(self, character):
        if character == "\r":
            self.column = 0
        elif character == "\n":
            self.feed()
        elif character == "\a":
            pass
        elif character < " ":
            raise ValueError(f"the control character {character!r} is not known")
        else:
            size = width(character)
            if self.column + size > self.columns:
                self.broken[self.row] = True
                self.rows[self.row][self.column:] = [("", False)] * (self.columns - self.column)
                self.column = 0
                self.feed()
            self.rows[self.row][self.column] = (character, self.red) if character != " " else BLANK
            if size == 2:
                self.rows[self.row][self.column + 1] = ("", self.red)
            self.column += size

    def text(self):
        """The rows up to the cursor."""
        lines = ["".join(cell[0] for cell in row).rstrip() for row in self.rows[:self.row]]
        return "\n".join(lines + ["".join(cell[0] for cell in self.rows[self.row][:self.column])])

    def below(self):
        """The rows below that of the cursor: what is offered for what has been typed."""
        return "\n".join("".join(cell[0] for cell in row).rstrip() for row in self.rows[self.row + 1:])

    def typed(self):
        """The same without breaks between rows: a line that goes on in the next row."""
        return "".join(cell[0] for row in self.rows[:self.row] for cell in row) + self.text().rsplit("\n", 1)[-1]

    def picture(self):
        """Rows and cursor as they are, unchangeable."""
        return tuple(tuple(row) for row in self.rows), (self.row, min(self.column, self.columns - 1))
