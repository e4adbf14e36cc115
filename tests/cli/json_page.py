"""The part of docs/json.md that is made from docs/schema/."""
import textwrap

from json_schemas import FILES, Schemas

WIDTH = 140
MOST_VALUES = 20  # The commands are counted out in the overview.
KINDS = {"string": "text", "integer": "integer", "number": "number", "boolean": "true or false", "object": "record", "array": "list"}


def wrapped(text):
    return "\n".join(textwrap.wrap(text, WIDTH, break_long_words=False, break_on_hyphens=False))


def is_null(schema):
    return schema.get("type") == "null"


def types(schema):
    """The types of a schema beside null."""
    found = schema.get("type", [])
    return [each for each in ([found] if isinstance(found, str) else found) if each != "null"]


def code(value):
    return "`" + ("true" if value is True else "false" if value is False else str(value)) + "`"


class Page:
    """Results and records as tables of Markdown."""

    def __init__(self, folder):
        self.schemas = Schemas(folder)
        self.defs = self.schemas.files["defs.schema.json"]["$defs"]
        self.results = [each for each in self.schemas.names() if "." not in each and each not in ("envelope", "defs", *FILES)]
        self.records = []  # Names of the records that tables have named, in that order.

    def resolved(self, file, schema):
        """What a $ref names, with the words of who refers; the name of the record where it has a table of its own."""
        if "$ref" not in schema:
            return file, schema, None
        name, place, target = self.schemas.target(file, schema["$ref"])
        record = place.rpartition("/")[2] if name == "defs.schema.json" else None
        own = {key: value for key, value in schema.items() if key != "$ref"}
        file, inner, deeper = self.resolved(name, {**target, **own})
        return file, inner, deeper or record

    def link(self, record):
        if record not in self.records:
            self.records.append(record)
        return f"[{record.replace('_', ' ')}](#record-{record.replace('_', '-')})"

    def kind(self, file, schema):
        """The type in words: `list of [reading](#reading)`, `text, null`."""
        inner_file, inner, record = self.resolved(file, schema)
        options = [each for each in inner.get("anyOf", []) if not is_null(each)]
        if schema.get("$ref", "").partition("#")[0].removesuffix(".schema.json") in self.results:
            name = schema["$ref"].partition("#")[0].removesuffix(".schema.json")
            return f"[as its `result`](#{name})" if "#" not in schema["$ref"] else f"[record of its `result`](#{name})"
        if "$ref" in schema and not schema["$ref"].startswith(("#", "defs")):
            name = schema["$ref"].removesuffix(".schema.json")
            return f"[sample](#{name.removesuffix('.sample')}-sample)"
        nullable = len(options) < len(inner.get("anyOf", [])) or "null" in inner.get("type", []) or None in inner.get("enum", [])
        if options:
            words = " or ".join(dict.fromkeys(self.kind(inner_file, each) for each in options))
        elif record is not None and "object" in types(inner) and "properties" in inner:
            words = self.link(record)
        elif "array" in types(inner):
            words = "list of " + self.plural(inner_file, inner["items"])
        elif "const" in inner:
            words = code(inner["const"])
        else:
            words = " or ".join(KINDS[each] for each in types(inner)) or "anything"
        words = words.replace("number or text or true or false", "number, text, true or false")
        return words + (", null" if nullable and not words.endswith(", null") else "")

    def plural(self, file, schema):
        words = self.kind(file, schema)
        return {"integer": "integers", "number": "numbers", "text": "texts", "record": "records", "true or false": "true or false",
                "number, null": "numbers or null"}.get(words, words)

    def meaning(self, file, schema):
        """The description, and the values where they are counted out."""
        inner_file, inner, record = self.resolved(file, schema)
        text = schema.get("description") or inner.get("description", "")
        if record is not None and "$ref" in schema and "description" not in schema:
            text = self.defs[record].get("description", text)
        found = inner
        for each in inner.get("anyOf", []):
            _, option, _ = self.resolved(inner_file, each)
            found = option if "enum" in option else found
        values = [value for value in found.get("enum", []) if value is not None]
        if 1 < len(values) <= MOST_VALUES and not all(code(value) in text for value in values):
            text = f"{text} One of {', '.join(map(code, values))}.".strip()
        return text.replace("|", "\\|")

    def rows(self, file, schema, before=""):
        required = schema.get("required", [])
        members = [(key, each, key in required) for key, each in schema.get("properties", {}).items()]
        members += [(key.strip("^$").replace("[0-9]+", "N"), each, False) for key, each in schema.get("patternProperties", {}).items()]
        for key, each, always in members:
            # It may stand in every record with `node`, and is explained once.
            if each.get("$ref", "").endswith("/axis"):
                continue
            kind = self.kind(file, each) + ("" if always else "; optional")
            yield f"| `{before}{key}` | {kind} | {self.meaning(file, each)} |"
            inner_file, inner, record = self.resolved(file, each)
            if record is not None:
                continue
            if "properties" in inner:
                yield from self.rows(inner_file, inner, f"{before}{key}.")
            items = inner.get("items", {})
            if "properties" in items:
                yield from self.rows(inner_file, items, f"{before}{key}[].")

    def table(self, file, schema):
        return "\n".join(["| key | type | meaning |", "|---|---|---|", *self.rows(file, schema)])

    def form(self, file, schema):
        """One form of a result, in words or as a table."""
        title = schema.get("$comment") or schema.get("title")
        plain = {key: value for key, value in schema.items() if key != "title"}
        inner_file, inner, record = self.resolved(file, plain)
        if record is None and "array" in types(inner) and "properties" in inner["items"]:
            return wrapped(f"List: {title}.") + "\n\n" + self.table(inner_file, inner["items"])
        if record is None and "properties" in inner:
            return wrapped(f"Record: {title}.") + "\n\n" + self.table(inner_file, inner)
        if is_null(inner):
            return wrapped(f"Null: {title}.")
        words = self.link(record) if record is not None else self.kind(inner_file, inner)
        if record is not None and "object" in types(inner) and "properties" in inner:
            words = "record " + words
        return wrapped(f"{words[0].upper()}{words[1:]}: {title}.")

    def body(self, name):
        file = name + ".schema.json"
        schema = self.schemas.files[file]
        if "anyOf" not in schema:
            return self.form(file, schema)
        return "\n\n".join(self.form(file, each) for each in schema["anyOf"])

    def sections(self, level, names, title):
        """A section for each; those that are described in the same words share one."""
        bodies = {}
        for name, words in names:
            bodies.setdefault(self.body(name), []).append((name, words))
        out = []
        for body, members in bodies.items():
            files = ", ".join(f"[{name}](schema/{name}.schema.json)" for name, _ in members)
            anchors = "".join(f'<a id="{name.replace(".", "-")}"></a>' for name, _ in members)
            heading = f"{level} {anchors}{', '.join(f'`{words}`' for _, words in members)}"
            out.append(f"{heading}\n\n{body}\n\n{wrapped(f'{title} {files}.')}")
        return "\n\n".join(out)

    def keys(self, file, schema):
        """The keys of a record in short: `node index value si error families[]`."""
        file, inner, _ = self.resolved(file, schema)
        if "properties" in inner:
            out = []
            for key, each in inner["properties"].items():
                if not each.get("$ref", "").endswith("/axis"):
                    out.append(key + ("[]" if "array" in types(self.resolved(file, each)[1]) else ""))
            return "`" + " ".join(out) + "`"
        options = [each for each in inner.get("anyOf", []) if not is_null(each)]
        return " or ".join(dict.fromkeys(self.keys(file, each) or self.kind(file, each) for each in options))

    def short(self, file, schema):
        """One form of a result for the overview."""
        inner_file, inner, record = self.resolved(file, schema)
        if record in ("planned", "axis_plan", "motion_plan", "rules"):
            return self.link(record)
        if is_null(inner):
            return "null"
        if "array" in types(inner):
            return "list: " + (self.keys(inner_file, inner["items"]) or self.plural(inner_file, inner["items"]))
        return self.keys(inner_file, inner) or self.kind(inner_file, inner)

    def overview(self, commands):
        rows = {}
        for command in commands:
            name = command.replace(" ", "-")
            schema = self.schemas.files[name + ".schema.json"]
            forms = [(each.get("title", ""), self.short(name + ".schema.json", each)) for each in schema.get("anyOf", [schema])]
            told = "; ".join(dict.fromkeys(f"{title}: {words}" if "`-" in title else words for title, words in forms))
            rows.setdefault(told, []).append(f"[`{command}`](#{name})")
        return "\n".join(["| command | `result` |", "|---|---|", *(f"| {', '.join(names)} | {told} |" for told, names in rows.items())])

    def record(self, name):
        schema = self.defs[name]
        head = f'### <a id="record-{name.replace("_", "-")}"></a>{name.replace("_", " ")}\n\n' + wrapped(schema["description"])
        if "properties" in schema:
            return head + "\n\n" + self.table("defs.schema.json", schema)
        if "array" in types(schema):
            return head + "\n\n" + wrapped(f"List of {self.plural('defs.schema.json', schema['items'])}.")
        if "object" in types(schema):
            kind = self.kind("defs.schema.json", schema["additionalProperties"])
            return head + "\n\n" + wrapped(f"Record; each value: {kind}.")
        return head

    def text(self, commands):
        """`commands`: paths in the order of the help."""
        samples = [(command.replace(" ", "-") + ".sample", command) for command in commands]
        samples = [each for each in samples if each[0] in self.schemas.names()]
        parts = ["## Document", self.table("envelope.schema.json", self.schemas.files["envelope.schema.json"]), "## Results",
                 self.overview(commands), self.sections("###", [(command.replace(" ", "-"), command) for command in commands], "Schema:"),
                 "## Samples",
                 wrapped("With `-o jsonl` these commands print one record for each sample, and the document, whose `result` does not "
                         "repeat the samples, comes last."),
                 self.sections("###", samples, "Schema:")]
        parts += ["## Files",
                  wrapped("What is written to files that other programs may read. `--tests` of `report` reads documents of `test …`, as they are "
                          "described above."),
                  self.sections("###", [(name, name.replace("-", " ")) for name in FILES], "Schema:")]
        records = []
        for name in self.records:  # Grows while records name others.
            records.append(self.record(name))
        parts += ["## Records", "[Schema of all](schema/defs.schema.json)", *records]
        return "\n\n".join(parts)
