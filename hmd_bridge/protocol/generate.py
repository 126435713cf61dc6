#!/usr/bin/env python3
"""Makes the types, readers and writers of hmd.v1.toml: C++ (messages.hpp, messages.cpp) and TypeScript (messages.ts).

generate.py --cpp FOLDER     both C++ files
generate.py --ts FILE        the TypeScript file
generate.py --golden FILE    examples of every message, good and bad, which the tests of both sides read
Standard library only.
"""

import argparse
import json
import pathlib
import re
import sys
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
SCALARS = {"bool": "Bool", "i32": "I32", "f64": "F64", "count": "Count", "name": "Name"}
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


GENERATED = "// Made from hmd.v1.toml by generate.py: do not edit."


def enumerator(value):
    return "k" + "".join(part[:1].upper() + part[1:].lower() for part in value.split("_"))


def cpp_struct(name, doc, fields, wire=None):
    lines = [f"/// {doc}"] if doc else []
    lines.append(f"struct {name} {{")
    if wire:
        lines.append(f'  static constexpr const char* kName = "{wire}";')
    for field in fields:
        init = "" if field.type.optional or field.type.kind in ("name", "text", "list") else "{}"
        note = f"  ///< {field.doc}" if field.doc else ""
        lines.append(f"  {field.type.cpp_value()} {field.name}{init};{note}")
    lines.append(f"  bool operator==(const {name}&) const = default;")
    return "\n".join(lines + ["};"])


def declarations(name):
    return (f"[[nodiscard]] bool read_value(const Json& json, {name}& out, Problem& problem);\n"
            f"[[nodiscard]] Json write_value(const {name}& value);")


def cpp_header(schema):
    parts = [GENERATED, "#pragma once\n", "#include <string_view>\n#include <variant>\n",
             '#include "protocol/json_types.hpp"\n', "namespace concord::hmd {\n",
             f'inline constexpr const char* kProtocol = "{schema.version}";\n']
    for name, spec in schema.enums.items():
        values = ", ".join(enumerator(value) for value in spec["values"])
        parts.append((f"/// {spec['doc']}\n" if spec["doc"] else "") + f"enum class {name} {{ {values} }};")
        parts.append(f"[[nodiscard]] const char* text_of({name} value);")
        parts.append(declarations(name) + "\n")
    unions = dict(schema.unions)
    defined = set()
    for name, doc, fields in schema.records():
        for union, spec in list(unions.items()):
            if set(spec["kinds"].values()) <= defined:
                parts.append(f"/// {spec['doc']}\nusing {union} = std::variant<{', '.join(spec['kinds'].values())}>;")
                parts.append(declarations(union) + "\n")
                del unions[union]
        parts.append(cpp_struct(name, doc, fields) + "\n" + declarations(name) + "\n")
        defined.add(name)
    for name, doc, fields, wire in schema.messages():
        parts.append(cpp_struct(name, doc, fields, wire) + "\n" + declarations(name) + "\n")
    of = lambda names, suffix: ",\n    ".join(camel(name) + suffix for name in names)
    parts.append(f"using RequestBody = std::variant<\n    {of(schema.spoken(), 'Request')}>;\n"
                 f"using NoticeBody = std::variant<\n    {of(schema.notices, 'Notice')}>;\n"
                 f"using EventBody = std::variant<\n    {of(schema.events, 'Event')}>;\n")
    parts.append("""/// What the schema says of one request; in the order of RequestBody, then those that are binary.
struct RequestInfo {
  const char* name;
  Role role;  ///< the least that may ask
  std::vector<Code> failures;
};
[[nodiscard]] const std::vector<RequestInfo>& request_infos();

/// The body that a name stands for, read from `json`; nothing if there is no such name.
[[nodiscard]] std::optional<bool> read_request(std::string_view name, const Json& json, RequestBody& out, Problem& problem);
[[nodiscard]] std::optional<bool> read_notice(std::string_view name, const Json& json, NoticeBody& out, Problem& problem);
[[nodiscard]] std::optional<bool> read_event(std::string_view name, const Json& json, EventBody& out, Problem& problem);
/// Reads an answer to the named request and writes it back: for tests of other sides. Null if it is none.
[[nodiscard]] Json reread_answer(std::string_view name, const Json& json, Problem& problem);

}  // namespace concord::hmd
""")
    return "\n".join(parts)


def cpp_record_functions(name, fields):
    reads = "".join(f'  members.take<{field.type.cpp()}>("{field.name}", out.{field.name});\n' for field in fields)
    writes = "".join(f'  put<{field.type.cpp()}>(json, "{field.name}", value.{field.name});\n' for field in fields)
    unused_out = "" if fields else "/*out*/"
    unused_value = "" if fields else "/*value*/"
    return (f"bool read_value(const Json& json, {name}& {'out' if fields else unused_out}, Problem& problem) {{\n"
            f"  Members members(json, problem);\n{reads}  return members.done();\n}}\n"
            f"Json write_value(const {name}& {'value' if fields else unused_value}) {{\n"
            f"  Json json = Json::object();\n{writes}  return json;\n}}\n")


def cpp_source(schema):
    parts = [GENERATED, '#include "protocol/messages.hpp"\n', "namespace concord::hmd {\n",
             "using namespace json_types;  // NOLINT: the descriptors below are its names\n"]
    for name, spec in schema.enums.items():
        texts = ", ".join(f'"{value}"' for value in spec["values"])
        parts.append(f"namespace {{\nconstexpr const char* k{name}Texts[] = {{{texts}}};\n}}\n"
                     f"const char* text_of({name} value) {{ return k{name}Texts[static_cast<std::size_t>(value)]; }}\n"
                     f"bool read_value(const Json& json, {name}& out, Problem& problem) {{\n"
                     f"  for (std::size_t i = 0; json.is_string() && i < std::size(k{name}Texts); ++i) {{\n"
                     f"    if (json.get_ref<const std::string&>() != k{name}Texts[i]) continue;\n"
                     f"    out = static_cast<{name}>(i);\n    return true;\n  }}\n"
                     f'  return problem.say(" is no {name}");\n}}\n'
                     f"Json write_value(const {name}& value) {{ return text_of(value); }}\n")
    for name, _, fields in schema.records():
        parts.append(cpp_record_functions(name, fields))
    for union, spec in schema.unions.items():
        cases = "".join(f'  if (kind == "{kind}") return Declared<{name}>::read(rest, out.emplace<{name}>(), problem);\n'
                        for kind, name in spec["kinds"].items())
        kinds = ", ".join(f'"{kind}"' for kind in spec["kinds"])
        parts.append(f"bool read_value(const Json& json, {union}& out, Problem& problem) {{\n"
                     '  if (!json.is_object()) return problem.say(" must be an object");\n'
                     '  const auto it = json.find("kind");\n'
                     '  if (it == json.end() || !it->is_string()) return problem.say(" lacks kind");\n'
                     "  const auto kind = it->get<std::string>();\n"
                     '  Json rest = json;\n  rest.erase("kind");\n' + cases +
                     f'  return problem.say(".kind is no {union}");\n}}\n'
                     f"Json write_value(const {union}& value) {{\n"
                     f"  static constexpr const char* kKinds[] = {{{kinds}}};\n"
                     "  Json json = std::visit([](const auto& part) { return write_value(part); }, value);\n"
                     '  json["kind"] = kKinds[value.index()];\n  return json;\n}\n')
    for name, _, fields, _ in schema.messages():
        parts.append(cpp_record_functions(name, fields))
    parts.append(cpp_lookups(schema))
    return "\n".join(parts)


def cpp_lookups(schema):
    infos = ",\n      ".join(
        f'{{"{name}", Role::{enumerator(spec["role"])}, {{{", ".join("Code::" + enumerator(c) for c in spec["failures"])}}}}}'
        for name, spec in list(schema.spoken().items()) +
        [(n, s) for n, s in schema.requests.items() if s.get("binary")])
    parts = ["const std::vector<RequestInfo>& request_infos() {\n"
             f"  static const std::vector<RequestInfo> kInfos = {{\n      {infos}}};\n  return kInfos;\n}}\n"]
    for what, names in (("request", schema.spoken()), ("notice", schema.notices), ("event", schema.events)):
        cases = "".join(
            f'  if (name == "{n}") return read_value(json, out.emplace<{camel(n)}{what.capitalize()}>(), problem);\n'
            for n in names)
        parts.append(f"std::optional<bool> read_{what}(std::string_view name, const Json& json, "
                     f"{what.capitalize()}Body& out, Problem& problem) {{\n{cases}  return std::nullopt;\n}}\n")
    cases = "".join(f'  if (name == "{n}") {{\n    {camel(n)}Answer out;\n'
                    "    return read_value(json, out, problem) ? write_value(out) : Json();\n  }\n" for n in schema.requests)
    parts.append("Json reread_answer(std::string_view name, const Json& json, Problem& problem) {\n"
                 f'{cases}  problem.say(" is no request");\n  return {{}};\n}}\n')
    return "\n".join(parts + ["}  // namespace concord::hmd\n"])


TS_CHECKER = r"""
type Table =
  | "bool" | "i32" | "f64" | "count" | "name"
  | { ref: string } | { text: number }
  | { array: Table; size: number } | { list: Table; size: number };
interface Member { type: Table; optional?: boolean }
type Members = Record<string, Member>;

const encoder = new TextEncoder();
const NAME = /^[A-Za-z0-9][A-Za-z0-9._-]{0,39}$/;
// eslint-disable-next-line no-control-regex
const CONTROL = /[\u0000-\u001f\u007f-\u009f]/;

function isRecord(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function checkMembers(value: unknown, members: Members, place: string, tagged = false): string | null {
  if (!isRecord(value)) return `${place} must be an object`;
  for (const [name, member] of Object.entries(members)) {
    if (!Object.prototype.hasOwnProperty.call(value, name)) {
      if (member.optional) continue;
      return `${place} lacks ${name}`;
    }
    const problem = checkType(value[name], member.type, `${place}.${name}`);
    if (problem) return problem;
  }
  for (const name of Object.keys(value)) {
    if (!(Object.prototype.hasOwnProperty.call(members, name) || (tagged && name === "kind"))) {
      return `${place} has an unknown member ${name.slice(0, 40)}`;
    }
  }
  return null;
}

function checkDeclared(value: unknown, name: string, place: string): string | null {
  const values = ENUMS[name];
  if (values) return typeof value === "string" && values.includes(value) ? null : `${place} is no ${name}`;
  const kinds = UNIONS[name];
  if (!kinds) return checkMembers(value, STRUCTS[name]!, place);
  if (!isRecord(value)) return `${place} must be an object`;
  const kind = value["kind"];
  if (typeof kind !== "string") return `${place} lacks kind`;
  if (!Object.prototype.hasOwnProperty.call(kinds, kind)) return `${place}.kind is no ${name}`;
  return checkMembers(value, STRUCTS[kinds[kind]!]!, place, true);
}

function checkType(value: unknown, type: Table, place: string): string | null {
  if (type === "bool") return typeof value === "boolean" ? null : `${place} must be true or false`;
  if (type === "f64") return typeof value === "number" && Number.isFinite(value) ? null : `${place} must be a number`;
  if (type === "i32") return Number.isInteger(value) && (value as number) === ((value as number) | 0) ? null : `${place} must be a whole number of 32 bits`;
  if (type === "count") return Number.isSafeInteger(value) && (value as number) >= 0 ? null : `${place} must be a whole number from 0 to 2^53 - 1`;
  if (type === "name") return typeof value === "string" && NAME.test(value) ? null : `${place} must be a name`;
  if ("ref" in type) return checkDeclared(value, type.ref, place);
  if ("text" in type) {
    if (typeof value !== "string") return `${place} must be a text`;
    if (encoder.encode(value).length > type.text) return `${place} has over ${type.text} bytes`;
    return CONTROL.test(value) ? `${place} has control characters` : null;
  }
  if (!Array.isArray(value)) return `${place} must be a list`;
  const item = "array" in type ? type.array : type.list;
  if ("array" in type ? value.length !== type.size : value.length > type.size) return `${place} must have ${type.size} items`;
  for (let i = 0; i < value.length; ++i) {
    const problem = checkType(value[i], item, `${place}[${i}]`);
    if (problem) return problem;
  }
  return null;
}

/** Each answers null, or what is wrong. */
export function checkRequest(name: string, body: unknown): string | null {
  const members = Object.prototype.hasOwnProperty.call(REQUESTS, name) ? REQUESTS[name] : undefined;
  return members ? checkMembers(body, members, name) : `no request ${name}`;
}
export function checkNotice(name: string, body: unknown): string | null {
  const members = Object.prototype.hasOwnProperty.call(NOTICES, name) ? NOTICES[name] : undefined;
  return members ? checkMembers(body, members, name) : `no notice ${name}`;
}
export function checkAnswer(name: string, body: unknown): string | null {
  const members = Object.prototype.hasOwnProperty.call(ANSWERS, name) ? ANSWERS[name] : undefined;
  return members ? checkMembers(body, members, name) : `no request ${name}`;
}
export function checkEvent(name: string, body: unknown): string | null {
  const members = Object.prototype.hasOwnProperty.call(EVENTS, name) ? EVENTS[name] : undefined;
  return members ? checkMembers(body, members, name) : `no event ${name}`;
}
export function checkStruct(name: string, value: unknown): string | null {
  return checkDeclared(value, name, name);
}
"""


def ts_interface(name, doc, fields, extra=""):
    lines = [f"/** {doc} */"] if doc else []
    if not fields and not extra:
        return "\n".join(lines + [f"export type {name} = Record<string, never>;"])
    lines.append(f"export interface {name} {{" + extra)
    for field in fields:
        note = f"  // {field.doc}" if field.doc else ""
        lines.append(f"  {field.name}{'?' if field.type.optional else ''}: {field.type.ts()};{note}")
    return "\n".join(lines + ["}"])


def ts_members(fields):
    inside = ", ".join(f"{f.name}: {{ type: {f.type.ts_table()}{', optional: true' if f.type.optional else ''} }}" for f in fields)
    return "{ " + inside + " }" if inside else "{}"


def ts_tables(kind, rows):
    return f"const {kind}: Record<string, Members> = {{\n" + "".join(f"  {n}: {ts_members(f)},\n" for n, f in rows) + "};"


def ts_source(schema):
    parts = [GENERATED + "\n", f'export const VERSION = "{schema.version}";\n']
    for name, spec in schema.enums.items():
        doc = f"/** {spec['doc']} */\n" if spec["doc"] else ""
        parts.append(f"{doc}export type {name} = {' | '.join(chr(34) + v + chr(34) for v in spec['values'])};")
    parts += [ts_interface(name, doc, fields) for name, doc, fields in schema.records()]
    for name, spec in schema.unions.items():
        kinds = " | ".join(f'({{ kind: "{kind}" }} & {part})' for kind, part in spec["kinds"].items())
        parts.append(f"/** {spec['doc']} */\nexport type {name} = {kinds};")
    parts += [ts_interface(name, doc, fields) for name, doc, fields, _ in schema.messages()]
    for kind, names, suffix in (("Requests", schema.spoken(), "Request"), ("Answers", schema.requests, "Answer"),
                                ("Notices", schema.notices, "Notice"), ("Events", schema.events, "Event")):
        parts.append(f"export interface {kind} {{\n" + "".join(f"  {n}: {camel(n)}{suffix};\n" for n in names) + "}")
    parts.append("/** The least role that may ask. */\nexport const ROLES: Record<keyof Answers, Role> = {\n" +
                 "".join(f'  {n}: "{s["role"]}",\n' for n, s in schema.requests.items()) + "};")
    parts.append("const ENUMS: Record<string, readonly string[]> = {\n" +
                 "".join(f"  {n}: {json.dumps(s['values'])},\n" for n, s in schema.enums.items()) + "};")
    parts.append("const UNIONS: Record<string, Record<string, string>> = {\n" +
                 "".join(f"  {n}: {json.dumps(s['kinds'])},\n" for n, s in schema.unions.items()) + "};")
    parts.append(ts_tables("STRUCTS", [(n, f) for n, (_, f) in schema.structs.items()]))
    parts.append(ts_tables("REQUESTS", [(n, s["fields"]) for n, s in schema.spoken().items()]))
    parts.append(ts_tables("ANSWERS", [(n, s["answer"]) for n, s in schema.requests.items()]))
    parts.append(ts_tables("NOTICES", [(n, s["fields"]) for n, s in schema.notices.items()]))
    parts.append(ts_tables("EVENTS", [(n, s["fields"]) for n, s in schema.events.items()]))
    return "\n".join(parts) + "\n" + TS_CHECKER


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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cpp", type=pathlib.Path)
    parser.add_argument("--ts", type=pathlib.Path)
    parser.add_argument("--golden", type=pathlib.Path)
    arguments = parser.parse_args()
    schema = Schema(HERE / "hmd.v1.toml")
    if arguments.cpp:
        arguments.cpp.mkdir(parents=True, exist_ok=True)
        (arguments.cpp / "messages.hpp").write_text(cpp_header(schema))
        (arguments.cpp / "messages.cpp").write_text(cpp_source(schema))
    if arguments.ts:
        arguments.ts.parent.mkdir(parents=True, exist_ok=True)
        arguments.ts.write_text(ts_source(schema))
    if arguments.golden:
        arguments.golden.write_text(golden(schema))


if __name__ == "__main__":
    main()
