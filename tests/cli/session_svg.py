"""A recorded session as one SVG file: text as text, moved by CSS alone. And back again."""
import xml.etree.ElementTree
from xml.sax.saxutils import escape

from terminal_screen import BLANK, COLUMNS, ROWS, width

CELL, LINE, EDGE = 8.4, 18, 12
INNER = ROWS * LINE
SIZE = (round(COLUMNS * CELL) + 2 * EDGE, INNER + 2 * EDGE)
FONT = "ui-monospace,'DejaVu Sans Mono',Menlo,Consolas,'Liberation Mono',monospace"
END = 2  # Seconds of the last picture before the first comes again.
NAMESPACE = "{http://www.w3.org/2000/svg}"


def number(value):
    return f"{value:.3f}".rstrip("0").rstrip(".")


def runs(row):
    """Column, text, its width and whether it is red: of one colour, of characters of one width, and without two blanks in
    succession, which would be taken for one."""
    out = []
    for column, (character, red) in enumerate(row):
        if character in ("", " "):
            continue
        size = width(character)
        last = out[-1] if out else None
        gap = column - last[0] - last[2] if last else COLUMNS
        if last and gap <= (size == 1) and last[3] == red and width(last[1][0]) == size:
            last[1] += " " * gap + character
            last[2] += gap + size
        else:
            out.append([column, character, size, red])
    return out


def text_element(run):
    """Held to its columns in whatever font there is: by its length, wide characters each by its place."""
    column, text, columns, red = run
    places = [number((column + 2 * i) * CELL) for i in range(len(text))] if width(text[0]) == 2 else [number(column * CELL)]
    length = f' textLength="{number(columns * CELL)}"' if len(places) == 1 else ""
    colour = ' class="r"' if red else ""
    return f'<text x="{" ".join(places)}"{length}{colour}>{escape(text)}</text>'


class Film:
    """Frames below each other; rows and groups of rows that come again are written once."""

    def __init__(self):
        self.names = {}
        self.definitions = []

    def name(self, key, make):
        if key not in self.names:
            body = make()  # Names what it uses first.
            self.names[key] = f"d{len(self.names)}"
            self.definitions.append(f'<g id="{self.names[key]}">{body}</g>')
        return self.names[key]

    def row(self, row, y):
        if all(cell == BLANK for cell in row):
            return ""
        name = self.name(row, lambda: "".join(map(text_element, runs(row))))
        return f'<use href="#{name}" y="{y}"/>'

    def rows(self, rows, y):
        return "".join(self.row(row, y + i * LINE) for i, row in enumerate(rows))

    def frame(self, frame, top):
        row, column = frame.cursor
        above = frame.rows[:row]
        out = ""
        if above:
            out += f'<use href="#{self.name(above, lambda: self.rows(above, 0))}" y="{top}"/>'
        out += self.rows(frame.rows[row:], top + row * LINE)
        out += f'<use href="#c" x="{number(column * CELL)}" y="{top + row * LINE}"/>'
        return f"<g>{out}</g>" if frame.settled else f'<g class="w">{out}</g>'


def usable(frames):
    """Without what was to be seen for less than a fiftieth of a second on the way to something else."""
    return [f for i, f in enumerate(frames) if f.settled or i + 1 == len(frames) or frames[i + 1].time - f.time > 0.02]


def svg(frames, title):
    frames = usable(frames)
    seconds = frames[-1].time - frames[0].time + END
    film = Film()
    body = "\n".join(film.frame(frame, i * INNER) for i, frame in enumerate(frames))
    parts = [100 * (frame.time - frames[0].time) / seconds for frame in frames]
    steps = "".join(f"{number(part)}%{{transform:translateY({-i * INNER}px)}}" for i, part in enumerate(parts))
    last = -(len(frames) - 1) * INNER
    return f"""<svg xmlns="http://www.w3.org/2000/svg" width="{SIZE[0]}" height="{SIZE[1]}" viewBox="0 0 {SIZE[0]} {SIZE[1]}" role="img">
<title>{escape(title)}</title>
<style>
text{{font:14px {FONT};fill:#d4d4d4}}
.r{{fill:#ff6b68;font-weight:bold}}
#f{{transform:translateY({last}px);animation:f {number(seconds)}s step-end infinite}}
@media (prefers-reduced-motion:reduce){{#f{{animation:none}}}}
@keyframes f{{{steps}100%{{transform:translateY({last}px)}}}}
</style>
<defs>
<rect id="c" y="-13.5" width="{number(CELL)}" height="{LINE}" fill="#d4d4d4" opacity=".6"/>
{chr(10).join(film.definitions)}
</defs>
<rect width="100%" height="100%" rx="6" fill="#1e1e1e"/>
<svg x="{EDGE}" y="{EDGE}" width="{SIZE[0] - 2 * EDGE}" height="{INNER}"><g transform="translate(0 13.5)"><g id="f">
{body}
</g></g></svg>
</svg>
"""


class Reader:
    def __init__(self, text):
        root = xml.etree.ElementTree.fromstring(text)
        self.definitions = {g.get("id"): g for g in root.iter(NAMESPACE + "g") if g.get("id")}
        self.strip = self.definitions["f"]

    def paint(self, element, y, rows):
        for part in element:
            top = y + int(part.get("y", "0"))
            if part.tag == NAMESPACE + "use" and part.get("href") == "#c":
                continue
            if part.tag == NAMESPACE + "use":
                self.paint(self.definitions[part.get("href")[1:]], top, rows)
                continue
            column = round(float(part.get("x").split()[0]) / CELL)
            for character in part.text:
                rows[top // LINE][column] = (character, part.get("class") == "r") if character != " " else BLANK
                if width(character) == 2:
                    rows[top // LINE][column + 1] = ("", part.get("class") == "r")
                column += width(character)

    def frames(self):
        """The rows of every picture that is settled."""
        for i, frame in enumerate(self.strip):
            rows = [[BLANK] * COLUMNS for _ in range(ROWS)]
            self.paint(frame, -i * INNER, rows)
            if frame.get("class") != "w":
                yield tuple(tuple(row) for row in rows)


def settled_rows(text):
    return list(Reader(text).frames())
