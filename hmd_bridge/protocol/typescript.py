"""The schema as TypeScript: types and their checks."""

import json

from schema import GENERATED, camel

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
