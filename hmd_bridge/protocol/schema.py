"""hmd.v1.toml, read and checked."""

import pathlib
import re
import sys
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
SCALARS = {"bool": "Bool", "i32": "I32", "f64": "F64", "count": "Count", "name": "Name"}
GENERATED = "// Made from hmd.v1.toml by generate.py: do not edit."
SECTIONS = {"enum", "struct", "union", "request", "notice", "event"}


def camel(name):
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


class Type:
    """A type as a field names it: `kind` is one of the scalars, text, array, list, or declared."""

    def __init__(self, text, declared):
        self.optional = text.endswith("?")
        text = text.removesuffix("?").strip()
        self.item, self.size, self.name = None, 0, text
        if match := re.fullmatch(r"(.+)\[(\d+)\]", text):
            self.kind, self.item, self.size = "array", Type(match[1], declared), int(match[2])
        elif match := re.fullmatch(r"list<(.+), *(\d+)>", text):
            self.kind, self.item, self.size = "list", Type(match[1], declared), int(match[2])
        elif match := re.fullmatch(r"text<(\d+)>", text):
            self.kind, self.size = "text", int(match[1])
        elif text in SCALARS:
            self.kind = text
        elif text in declared:
            self.kind = "declared"
        else:
            sys.exit(f"hmd.v1.toml: no type is called {text}")

    def cpp(self):
        """Its descriptor in json_types.hpp."""
        if self.kind in SCALARS:
            return SCALARS[self.kind]
        if self.kind == "text":
            return f"Text<{self.size}>"
        if self.kind == "declared":
            return f"Declared<{self.name}>"
        return f"{self.kind.capitalize()}<{self.item.cpp()}, {self.size}>"

    def cpp_value(self):
        plain = {"bool": "bool", "i32": "std::int32_t", "f64": "double", "count": "std::int64_t",
                 "name": "std::string", "text": "std::string"}
        if self.kind in plain:
            value = plain[self.kind]
        elif self.kind == "declared":
            value = self.name
        elif self.kind == "array":
            value = f"std::array<{self.item.cpp_value()}, {self.size}>"
        else:
            value = f"std::vector<{self.item.cpp_value()}>"
        return f"std::optional<{value}>" if self.optional else value

    def ts(self):
        plain = {"bool": "boolean", "i32": "number", "f64": "number", "count": "number", "name": "string",
                 "text": "string"}
        if self.kind in plain:
            return plain[self.kind]
        if self.kind == "declared":
            return self.name
        if self.kind == "array":
            return "[" + ", ".join([self.item.ts()] * self.size) + "]"
        return f"{self.item.ts()}[]"

    def ts_table(self):
        if self.kind in SCALARS:
            return f'"{self.kind}"'
        if self.kind == "declared":
            return f'{{ ref: "{self.name}" }}'
        if self.kind == "text":
            return f"{{ text: {self.size} }}"
        return f"{{ {self.kind}: {self.item.ts_table()}, size: {self.size} }}"


class Field:
    def __init__(self, row, declared):
        self.name, self.type, self.doc = row[0], Type(row[1], declared), row[2]


class Schema:
    def __init__(self, file):
        with open(file, "rb") as text:
            data = tomllib.load(text)
        self.version = data.pop("version")
        if not set(data) <= SECTIONS:
            sys.exit(f"hmd.v1.toml: unknown sections {set(data) - SECTIONS}")
        self.enums, self.unions = data["enum"], data["union"]
        declared = set(self.enums) | set(data["struct"]) | set(self.unions)
        fields = lambda rows: [Field(row, declared) for row in rows]
        self.structs = {name: (spec["doc"], fields(spec["fields"])) for name, spec in data["struct"].items()}
        self.requests, self.notices, self.events = {}, {}, {}
        codes = set(self.enums["Code"]["values"])
        for name, spec in data["request"].items():
            if unknown := set(spec["failures"]) - codes:
                sys.exit(f"hmd.v1.toml: {name} fails with {unknown}, which are no codes")
            self.requests[name] = spec | {"fields": fields(spec["fields"]), "answer": fields(spec["answer"])}
        for name, spec in data["notice"].items():
            self.notices[name] = spec | {"fields": fields(spec["fields"])}
        for name, spec in data["event"].items():
            self.events[name] = spec | {"fields": fields(spec["fields"])}

    def spoken(self):
        """The requests that are said as text."""
        return {name: spec for name, spec in self.requests.items() if not spec.get("binary")}

    def records(self):
        """Every object with members: (C++ name, doc, fields), each after what it holds."""
        done, out = set(self.enums) | set(self.unions), []

        def add(name):
            if name in done:
                return
            done.add(name)
            doc, fields = self.structs[name]
            for field in fields:
                kind = field.type
                while kind.item:
                    kind = kind.item
                if kind.kind == "declared":
                    for part in self.unions.get(kind.name, {"kinds": {"": kind.name}})["kinds"].values():
                        add(part)
            out.append((name, doc, fields))

        for name in self.structs:
            add(name)
        return out

    def messages(self):
        """(C++ name, doc, fields, name on the wire) of each body."""
        for name, spec in self.requests.items():
            if not spec.get("binary"):
                yield camel(name) + "Request", spec["doc"], spec["fields"], name
            yield camel(name) + "Answer", f"Of {camel(name)}Request.", spec["answer"], name
        for name, spec in self.notices.items():
            yield camel(name) + "Notice", spec["doc"], spec["fields"], name
        for name, spec in self.events.items():
            yield camel(name) + "Event", spec["doc"], spec["fields"], name
