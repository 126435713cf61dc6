"""Examples of every message, good and bad, which the tests of both sides read."""

import json


class Examples:
    """A good value of every type, and what is wrong with its neighbours."""

    def __init__(self, schema):
        self.schema = schema

    def value(self, kind, full):
        plain = {"bool": True, "i32": -7, "f64": 1.25, "count": 2**53 - 1, "name": "robot-1.a_B", "text": "caf\u00e9 4"}
        if kind.kind in plain:
            return plain[kind.kind][:kind.size] if kind.kind == "text" else plain[kind.kind]
        if kind.kind == "array":
            return [self.value(kind.item, full)] * kind.size
        if kind.kind == "list":
            return [self.value(kind.item, full)] * (min(kind.size, 2) if full else 0)
        if kind.name in self.schema.enums:
            return self.schema.enums[kind.name]["values"][-1]
        if kind.name in self.schema.unions:
            tag, part = list(self.schema.unions[kind.name]["kinds"].items())[0 if full else -1]
            return {"kind": tag} | self.record(self.schema.structs[part][1], full)
        return self.record(self.schema.structs[kind.name][1], full)

    def record(self, fields, full):
        return {f.name: self.value(f.type, full) for f in fields if full or not f.type.optional}

    def wrong(self, kind):
        """Values that are not of the type."""
        plain = {"bool": [1, "true", None], "i32": [1.5, 2**31, "1"], "f64": ["1", None, [1]],
                 "count": [-1, 2**53, 0.5], "name": ["", "-a", "a/b", "x" * 41, 3], "text": ["a\u0007b", "x" * (kind.size + 1), 4]}
        if kind.kind in plain:
            return plain[kind.kind]
        if kind.kind == "array":
            return [[self.value(kind.item, True)] * (kind.size + 1), {}, [self.wrong(kind.item)[0]] * kind.size]
        if kind.kind == "list":
            return [{}, [self.wrong(kind.item)[0]]]
        if kind.name in self.schema.enums:
            return ["no such value", 0]
        if kind.name in self.schema.unions:
            return [{"kind": "nothing"}, {}, []]
        return [[], self.record(self.schema.structs[kind.name][1], True) | {"extra": 1}]

    def of(self, what, name, fields):
        good = [self.record(fields, True), self.record(fields, False)]
        bad = [{**good[0], "extra": 1}, []]
        for field in fields:
            if not field.type.optional:
                bad.append({key: value for key, value in good[0].items() if key != field.name})
            bad += [{**good[0], field.name: wrong} for wrong in self.wrong(field.type)]
            bad.append({**good[0], field.name: None})
        rows = [{"what": what, "name": name, "good": True, "body": body} for body in good]
        return rows + [{"what": what, "name": name, "good": False, "body": body} for body in bad]


def golden(schema):
    examples, rows = Examples(schema), []
    for name, spec in schema.spoken().items():
        rows += examples.of("request", name, spec["fields"])
    for name, spec in schema.requests.items():
        rows += examples.of("answer", name, spec["answer"])
    for what, group in (("notice", schema.notices), ("event", schema.events)):
        for name, spec in group.items():
            rows += examples.of(what, name, spec["fields"])
    return "[\n" + ",\n".join(json.dumps(row, ensure_ascii=True) for row in rows) + "\n]\n"
