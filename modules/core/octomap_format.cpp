#include "core/octomap_format.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "core/decimal.hpp"

namespace concord {
namespace {

constexpr std::string_view kBinaryTitle = "# Octomap OcTree binary file";
constexpr std::string_view kFullTitle = "# Octomap OcTree file";
constexpr std::size_t kMaxHeaderBytes = 65'536;

/// Takes one line and its end off the front of `text`; nullopt when there is no line end.
std::optional<std::string_view> take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

template <class Number>
std::optional<Number> parse(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

tl::unexpected<Error> malformed(const std::string& what) {
  return refuse(Code::kMalformed, "OctoMap header: " + what + "; is it a .bt or .ot file written by OctoMap?");
}

/// The start of a text from outside, fit for a log.
std::string quoted(std::string_view text) {
  std::string quote(text.substr(0, 40));
  std::replace_if(
      quote.begin(), quote.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + quote + "'";
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// What has been read of the header so far; each key once.
struct Fields {
  std::optional<std::string_view> id;
  std::optional<std::uint64_t> nodes;
  std::optional<double> resolution;

  /// False when the line is not a known key with a value that it may have.
  bool take(std::string_view key, std::string_view value) {
    if (key == "id" && !id) return !(id = value)->empty();
    if (key == "size" && !nodes) return (nodes = parse<std::uint64_t>(value)).has_value();
    if (key == "res" && !resolution) return (resolution = parse<double>(value)).has_value();
    return false;
  }
};

Result<OctomapHeader> checked(OctomapFormat format, const Fields& fields) {
  if (!fields.id || !fields.nodes || !fields.resolution) return malformed("id, size or res is missing");
  if (*fields.id != "OcTree") {
    return refuse(Code::kMalformed,
                  "OctoMap file holds a tree of type " + quoted(*fields.id) + "; only OcTree is read, save it as one");
  }
  const Result<double> resolution = checked_resolution(*fields.resolution);
  if (!resolution) return tl::unexpected(resolution.error());
  return OctomapHeader{format, *fields.nodes, *resolution};
}

}  // namespace

Result<double> checked_resolution(double resolution) {
  if (!std::isfinite(resolution)) return refuse(Code::kNotFinite, "resolution is not a finite number");
  if (resolution < kMinResolution || resolution > kMaxResolution) {
    return refuse(Code::kBadResolution,
                  "resolution " + decimal(resolution) + " m is not in [0.0001, 100]; is it in metres?");
  }
  return resolution;
}

Result<OctomapHeader> read_octomap_header(ByteSpan& in) {
  const std::size_t limit = std::min(in.size(), kMaxHeaderBytes);
  std::string_view text(reinterpret_cast<const char*>(in.data()), limit);

  const std::optional<std::string_view> title = take_line(text);
  if (!title) return malformed("no first line");
  const bool binary = title->starts_with(kBinaryTitle);
  if (!binary && !title->starts_with(kFullTitle)) return malformed("the first line is another");

  Fields fields;
  while (const std::optional<std::string_view> line = take_line(text)) {
    if (line->starts_with('#')) continue;
    if (trimmed(*line) == "data") {
      auto header = checked(binary ? OctomapFormat::kBinary : OctomapFormat::kFull, fields);
      if (header) in = in.subspan(limit - text.size());
      return header;
    }
    const std::size_t space = std::min(line->find(' '), line->size());
    if (!fields.take(line->substr(0, space), trimmed(line->substr(space)))) {
      return malformed("cannot read the line " + quoted(*line));
    }
  }
  return malformed("no line 'data'");
}

void append_octomap_header(Bytes& out, const OctomapHeader& header) {
  std::string text(header.format == OctomapFormat::kBinary ? kBinaryTitle : kFullTitle);
  text += "\nid OcTree\nsize " + std::to_string(header.nodes) + "\nres " + decimal(header.resolution) + "\ndata\n";
  out.insert(out.end(), text.begin(), text.end());
}

}  // namespace concord
