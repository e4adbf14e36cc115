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
        self.rows = [[BLANK] * COLUMNS for _ in range(ROWS)]
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
            self.column = min(COLUMNS - 1, self.column + max(1, first))
        elif letter == "J" and first == 0:
            self.clear_row()
            for row in range(self.row + 1, ROWS):
                self.rows[row] = [BLANK] * COLUMNS
        elif letter == "K" and first == 0:
            self.clear_row()
        elif letter == "m" and numbers in ("", "0", "1;31"):
            self.red = numbers == "1;31"
        else:
            raise ValueError(f"the control {numbers}{letter} is not known")

    def clear_row(self):
        self.rows[self.row][self.column:] = [BLANK] * (COLUMNS - min(self.column, COLUMNS))

    def feed(self):
        if self.row < ROWS - 1:
            self.row += 1
            return
        self.rows.append([BLANK] * COLUMNS)
        del self.rows[0]

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
            if self.column + size > COLUMNS:
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
        return tuple(tuple(row) for row in self.rows), (self.row, min(self.column, COLUMNS - 1))
