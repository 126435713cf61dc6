#include "planner/files/movingai.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

namespace concord {
namespace {

tl::unexpected<Error> malformed(std::size_t line, const std::string& what) {
  return refuse(Code::kMalformed, "line " + std::to_string(line) + ": " + what);
}

/// Lines without their ends, Unix's or DOS's.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number_;
    return line;
  }
  [[nodiscard]] std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// Takes the next word off the front.
std::string_view word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
  line.remove_prefix(begin);
  const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
  const std::string_view found = line.substr(0, end);
  line.remove_prefix(end);
  return found;
}

template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

struct Size {
  std::int64_t width = 0, height = 0;
};

/// The lines up to "map".
Result<Size> read_header(Lines& lines) {
  Size size;
  bool has_type = false;
  while (auto line = lines.next()) {
    const std::string_view key = word(*line);
    const std::string_view value = word(*line);
    if (key == "map" && value.empty()) {
      if (!has_type || size.width < 1 || size.height < 1) {
        return malformed(lines.number(), "before \"map\" there must be \"type octile\", a height and a width");
      }
      return size;
    }
    if (key == "type" && value == "octile") {
      has_type = true;
      continue;
    }
    const auto n = number<std::int64_t>(value);
    if ((key != "width" && key != "height") || !n || *n < 1) {
      return malformed(lines.number(), "not the beginning of a movingai map");
    }
    (key == "width" ? size.width : size.height) = *n;
  }
  return malformed(lines.number(), "the line \"map\" is missing");
}

/// Decimals after the point, which say to how much a length was rounded.
double rounding_of(std::string_view text) {
  const std::size_t point = text.find('.');
  const std::size_t decimals = point == std::string_view::npos ? 0 : text.size() - point - 1;
  return 1e-6 + 0.6 * std::pow(10.0, -static_cast<double>(decimals));
}

}  // namespace

Result<OpenGrid> read_movingai_map(std::string_view text) {
  Lines lines(text);
  const Result<Size> size = read_header(lines);
  if (!size) return tl::unexpected(size.error());
  if (size->width > OpenGrid::kMaxSide || size->height > OpenGrid::kMaxSide ||
      size->width * size->height > OpenGrid::kMaxCells) {
    return refuse(Code::kTooLarge, "the map has " + std::to_string(size->width) + " x " + std::to_string(size->height) +
                                       " cells; " + std::to_string(OpenGrid::kMaxCells / 1'000'000) +
                                       " million are the most");
  }
  // A short text may claim to be a large map: nothing is allocated for what is not there.
  if (static_cast<std::int64_t>(text.size()) < size->width * size->height) {
    return malformed(lines.number(), "there are fewer cells than its height and width say");
  }
  OpenGrid grid(static_cast<int>(size->width), static_cast<int>(size->height));
  for (int y = 0; y < grid.height(); ++y) {
    const auto row = lines.next();
    if (!row || static_cast<std::int64_t>(row->size()) != size->width) {
      return malformed(lines.number(), "a row of " + std::to_string(size->width) + " cells is missing");
    }
    for (int x = 0; x < grid.width(); ++x) {
      const char c = (*row)[static_cast<std::size_t>(x)];
      if (c == '.' || c == 'G' || c == 'S') {
        grid.set({x, y}, true);
      } else if (c != '@' && c != 'O' && c != 'T' && c != 'W') {
        return malformed(lines.number(), "a cell is none of . G S @ O T W");
      }
    }
  }
  return grid;
}

Result<std::vector<ScenarioQuery>> read_movingai_scenario(std::string_view text, int width, int height) {
  Lines lines(text);
  std::optional<std::string_view> line = lines.next();
  if (!line || word(*line) != "version" || number<double>(word(*line)) != 1.0) {
    return malformed(lines.number(), "the first line must be \"version 1\"");
  }
  std::vector<ScenarioQuery> queries;
  while ((line = lines.next())) {
    if (line->find_first_not_of(" \t") == std::string_view::npos) continue;
    if (queries.size() == kMaxQueries) {
      return refuse(Code::kTooLarge, "over " + std::to_string(kMaxQueries) + " queries");
    }
    word(*line);  // bucket
    word(*line);  // map
    std::array<int, 6> n{};
    for (int& value : n) {
      const auto read = number<int>(word(*line));
      if (!read) return malformed(lines.number(), "a query is: bucket map width height x y x y optimum");
      value = *read;
    }
    const std::string_view last = word(*line);
    const auto optimum = number<double>(last);
    if (!optimum || !std::isfinite(*optimum) || *optimum < 0) {
      return malformed(lines.number(), "the optimal length is not a number");
    }
    const ScenarioQuery query{{n[2], n[3]}, {n[4], n[5]}, *optimum, rounding_of(last)};
    const auto fits = [&](Cell c) { return c.x >= 0 && c.y >= 0 && c.x < width && c.y < height; };
    if (n[0] != width || n[1] != height || !fits(query.start) || !fits(query.goal)) {
      return malformed(lines.number(), "the query is for another map: it has " + std::to_string(width) + " x " +
                                           std::to_string(height) + " cells");
    }
    queries.push_back(query);
  }
  return queries;
}

}  // namespace concord
