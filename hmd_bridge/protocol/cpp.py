"""The schema as C++: types, readers, writers."""

from schema import GENERATED, camel


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
                     f'  return problem.say("kind is no {union}");\n}}\n'
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
