"""The schemas of docs/schema/, ready to be held against documents; and what of them documents have exercised."""
import json
import os

try:
    import jsonschema
except ImportError:
    raise SystemExit("python3-jsonschema is missing: `./dev deps` installs it") from None

DIALECT = jsonschema.Draft202012Validator
ANNOTATIONS = ("title", "description", "$comment")
# Files that the program writes and reads: their schema, and the key that tells them apart.
FILES = {"backup-file": "servoctl_backup", "restore-journal": "servoctl_journal", "address-journal": "servoctl_address_plan",
         "report-file": "servoctl_report", "witness-file": "servoctl_witness", "pdo-file": "format"}
LEFT_OUT = "a person may leave it out of the file: `pdo apply` leaves it as it is"
# Keys that come and go, and why; every other key of a record is always there. Beside them `axis` stands in each record with `node`
# where the line names axes of a cabinet file, and a frame has the keys of its service.
OPTIONAL = {
    "envelope.schema.json#/properties/error": "exactly where `ok` is false",
    "scan.schema.json#/anyOf/0/items/properties/bus": "where the line is for several buses: nothing else tells the rows apart",
    "scan.schema.json#/anyOf/1/items/properties/bus": "where the line is for several buses: nothing else tells the rows apart",
    "lss-scan.schema.json#/anyOf/0/items/properties/bus": "where the line is for several buses: nothing else tells the rows apart",
    **{f"defs.schema.json#/$defs/{kind}/properties/restart_owed": "only where something waits for a restart"
       for kind in ("status_can", "status_ring", "info_can", "info_ring", "info_line")},
    **{f"defs.schema.json#/$defs/{kind}/properties/other_axes": "only where the node has several axes"
       for kind in ("status_can", "status_ring")},
    "defs.schema.json#/$defs/frame/properties/clock": "only with `--clock`",
    "pdo-file.schema.json#/properties/family": "a person may leave it out of the file",
    **{f"pdo-file.schema.json#/properties/pdo/items/properties/{key}": LEFT_OUT
       for key in ("cob_id", "valid", "type", "inhibit_us", "event_ms", "sync_start", "map")},
}


def no_twins(pairs):
    """A record in which no key appears twice: readers would take the one or the other."""
    out = dict(pairs)
    if len(out) != len(pairs):
        keys = [key for key, _ in pairs]
        raise ValueError("a key appears twice: " + ", ".join(sorted({k for k in keys if keys.count(k) > 1})))
    return out


def read(text):
    return json.loads(text, object_pairs_hook=no_twins)


class Schemas:
    """All files of a folder, with what they refer to in its place, so that any version of jsonschema takes them."""

    def __init__(self, folder):
        self.files = {}
        for name in sorted(os.listdir(folder)):
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                self.files[name] = read(file.read())
        self.whole = {}
        self.used = set()

    def names(self):
        """`read`, `watch.sample`, …"""
        return [name.removesuffix(".schema.json") for name in self.files]

    def check(self):
        """What is wrong with the schemas themselves."""
        out = []
        for name, schema in self.files.items():
            try:
                DIALECT.check_schema(schema)
            except jsonschema.SchemaError as error:
                out.append(f"{name}: {error.message}")
            if schema.get("$id") != name:
                out.append(f"{name}: its $id is {schema.get('$id')}")
            out += [f"{name}: {text}" for text in weaknesses(schema, "")]
        loose = [place for name, schema in self.files.items() for place in loose_keys(name, "", schema)]
        out += [f"{place}: is neither required nor in OPTIONAL" for place in loose if place not in OPTIONAL]
        out += [f"{place}: stands in OPTIONAL, and is none" for place in OPTIONAL if place not in loose]
        return out

    def target(self, file, reference):
        """File, place and content of what a $ref names."""
        name, _, place = reference.partition("#")
        name = name or file
        schema = self.files[name]
        for step in place.split("/")[1:]:
            schema = schema[step]
        return name, place, schema

    def inlined(self, file, place, schema):
        """The schema without $ref. Each part is marked with the places it stands at, so that what was met can be noted."""
        if isinstance(schema, list):
            return [self.inlined(file, f"{place}/{i}", each) for i, each in enumerate(schema)]
        if not isinstance(schema, dict):
            return schema
        own = {key: value for key, value in schema.items() if key not in ("$ref", "$defs")}
        out = {key: self.inlined(file, f"{place}/{key}", value) for key, value in own.items()}
        if "$ref" in schema:
            name, there, target = self.target(file, schema["$ref"])
            out = {**self.inlined(name, there, target), **out}
        out["places"] = [*out.get("places", []), f"{file}#{place}"]
        return out

    def get(self, name):
        file = name + ".schema.json"
        if file not in self.whole:
            schema = self.inlined(file, "", self.files[file])
            schema.pop("$id", None)
            self.whole[file] = DIALECT(schema)
        return self.whole[file]

    def errors(self, name, document):
        """Why the document is none of this kind; notes what of the schema it exercises where it is."""
        validator = self.get(name)
        error = jsonschema.exceptions.best_match(validator.iter_errors(document))
        if error is None:
            self.used.update(validator.schema["places"])
            self.note(validator, validator.schema, document)
            return []
        error = in_the_nearest_form(error)
        where = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in error.absolute_path)
        return [f"{where or 'the document'}: {error.message[:300]}"]

    def note(self, validator, schema, value):
        if "anyOf" in schema:
            fitting = [each for each in schema["anyOf"] if validator.evolve(schema=each).is_valid(value)]
            # An empty list may be anything.
            for each in fitting if value != [] else []:
                self.used.update(each["places"])
            if fitting:
                self.note(validator, fitting[0], value)
        for each in schema.get("allOf", []):
            if validator.evolve(schema=each["if"]).is_valid(value):
                self.note(validator, each["then"], value)
        if isinstance(value, list) and isinstance(schema.get("items"), dict):
            for each in value:
                self.note(validator, schema["items"], each)
        if not isinstance(value, dict):
            return
        properties = schema.get("properties", {})
        for key, each in value.items():
            inner = properties.get(key)
            if inner is None and isinstance(schema.get("additionalProperties"), dict):
                inner = schema["additionalProperties"]
            if isinstance(inner, dict):
                self.used.update(inner.get("places", []))
                self.note(validator, inner, each)

    def never_met(self):
        """Schemas, forms of a result, and fields that are not always there, of which no document was an example."""
        out = [f"{file}#" for file in self.files if file != "defs.schema.json" and f"{file}#" not in self.used]
        for file in self.files:
            out += [place for place in choices(file, "", self.files[file]) if place not in self.used]
        return out


def in_the_nearest_form(error):
    """What is wrong with a document of several forms: said of the form it is nearest to."""
    while error.context:
        forms = {}
        for each in error.context:
            forms.setdefault(each.schema_path[0], []).append(each)
        # A form of another type is far away, however little is wrong.
        far = max(len(each.absolute_path) for each in error.context)
        error = min(forms.values(), key=lambda errors: (far - max(len(e.absolute_path) for e in errors), len(errors)))[0]
    return error


def strays(schema):
    """Whether a record may hold keys that are not named."""
    return schema.get("additionalProperties", True) is True


def weaknesses(schema, place):
    """Records that take any key, and keys without a word on what they mean."""
    out = []
    if isinstance(schema, list):
        for i, each in enumerate(schema):
            out += weaknesses(each, f"{place}/{i}")
    if not isinstance(schema, dict):
        return out
    if schema.get("type") in ("object", ["object", "null"]):
        if strays(schema):
            out.append(f"{place}: takes any key")
        for key, each in schema.get("properties", {}).items():
            if "$ref" not in each and not each.get("description"):
                out.append(f"{place}/properties/{key}: has no description")
    for key, each in schema.items():
        out += weaknesses(each, f"{place}/{key}")
    return out


def loose_keys(file, place, schema):
    """Keys that no record has to have: they are not required, nor where a condition holds."""
    if isinstance(schema, list):
        for i, each in enumerate(schema):
            yield from loose_keys(file, f"{place}/{i}", each)
    if not isinstance(schema, dict):
        return
    if "object" in schema.get("type", []) and "properties" in schema:
        always = set(schema.get("required", []))
        always.update(*(each["then"].get("required", []) for each in schema.get("allOf", [])))
        for key, each in schema["properties"].items():
            if key not in always and not each.get("$ref", "").endswith("/axis"):
                yield f"{file}#{place}/properties/{key}"
    for key, each in schema.items():
        yield from loose_keys(file, f"{place}/{key}", each)


def choices(file, place, schema):
    """Places of what a document may have or not: forms with a title, and keys that are not required."""
    if isinstance(schema, list):
        for i, each in enumerate(schema):
            yield from choices(file, f"{place}/{i}", each)
    if not isinstance(schema, dict):
        return
    forms = [i for i, each in enumerate(schema.get("anyOf", [])) if each != {"type": "null"}]
    for i in forms if len(forms) > 1 else []:
        yield f"{file}#{place}/anyOf/{i}"
    if isinstance(schema.get("properties"), dict) and "required" in schema:
        for key, each in schema["properties"].items():
            # `axis` may stand in any record with `node`, and is tried on some.
            if key not in schema["required"] and not each.get("$ref", "").endswith("/axis"):
                yield f"{file}#{place}/properties/{key}"
    for key, each in schema.items():
        yield from choices(file, f"{place}/{key}", each)


def samples_and_documents(lines):
    """Each document of lines of output, with the name of its schema: samples belong to the document that ends them, and
    those of a line of a batch file to the record of that line."""
    samples = []
    inner = []
    for line in lines:
        if not line.startswith("{"):
            continue
        document = read(line)
        if "servoctl" in document:
            name = file_name(document["command"])
            yield from ((name + ".sample", sample) for sample in samples + inner)
            yield "envelope", document
            samples, inner = [], []
        elif {"line", "text", "ok"} <= set(document):
            yield from ((file_name(document["command"]) + ".sample", sample) for sample in inner)
            inner = []
            samples.append(document)
        else:
            inner.append(document)


def file_name(command):
    return (command or "").replace(" ", "-")
