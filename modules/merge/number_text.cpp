#include "merge/number_text.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "core/decimal.hpp"

namespace concord {
namespace {

constexpr std::size_t kMostNumbers = 2 + 2 * 1024;

void append(std::string& out, double value) {
  if (!out.empty()) out += ' ';
  out += decimal(value);
}

template <class Derived>
void append_all(std::string& out, const Eigen::DenseBase<Derived>& values) {
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    for (Eigen::Index column = 0; column < values.cols(); ++column) append(out, values(row, column));
  }
}

struct VolumeText {
  std::string operator()(const Box& box) const {
    std::string out = "box";
    append_all(out, box.min);
    append_all(out, box.max);
    return out;
  }
  std::string operator()(const OrientedBox& box) const {
    std::string out = "oriented_box";
    append_all(out, box.size);
    append_all(out, box.T_frame_box.translation());
    append_all(out, box.T_frame_box.linear());
    return out;
  }
  std::string operator()(const Prism& prism) const {
    std::string out = "prism";
    append(out, prism.low);
    append(out, prism.high);
    for (const Eigen::Vector2d& p : prism.points) append_all(out, p);
    return out;
  }
};

std::optional<std::vector<double>> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  while (!text.empty() && numbers.size() < kMostNumbers) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
    numbers.push_back(value);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (text.empty()) return numbers;
    if (text.front() != ' ') return std::nullopt;
    text.remove_prefix(1);
  }
  return std::nullopt;
}

Eigen::Vector3d vector_at(const std::vector<double>& n, std::size_t i) { return {n[i], n[i + 1], n[i + 2]}; }

Eigen::Matrix3d matrix_at(const std::vector<double>& n, std::size_t i) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(n.data() + i);
}

std::optional<Volume> volume_of(std::string_view kind, const std::vector<double>& n) {
  if (kind == "box" && n.size() == 6) return Box{vector_at(n, 0), vector_at(n, 3)};
  if (kind == "oriented_box" && n.size() == 15) {
    OrientedBox box;
    box.size = vector_at(n, 0);
    box.T_frame_box.translation() = vector_at(n, 3);
    box.T_frame_box.linear() = matrix_at(n, 6);
    return box;
  }
  if (kind != "prism" || n.size() < 2 || n.size() % 2 != 0) return std::nullopt;
  Prism prism{{}, n[0], n[1]};
  for (std::size_t i = 2; i < n.size(); i += 2) prism.points.emplace_back(n[i], n[i + 1]);
  return prism;
}

}  // namespace

std::string to_text(const Volume& volume) { return std::visit(VolumeText{}, volume); }

Result<Volume> volume_from_text(std::string_view text) {
  const std::size_t space = text.find(' ');
  const auto numbers = space != text.npos ? numbers_in(text.substr(space + 1)) : std::nullopt;
  const auto volume = numbers ? volume_of(text.substr(0, space), *numbers) : std::nullopt;
  if (!volume || !check(*volume)) return refuse(Code::kMalformed, "a volume in the store is none");
  return *volume;
}

std::string to_text(const Eigen::Matrix3d& rotation) {
  std::string out;
  append_all(out, rotation);
  return out;
}

Result<Eigen::Matrix3d> rotation_from_text(std::string_view text) {
  const auto numbers = numbers_in(text);
  if (!numbers || numbers->size() != 9 || !is_rotation(matrix_at(*numbers, 0))) {
    return refuse(Code::kMalformed, "a rotation in the store is none");
  }
  return matrix_at(*numbers, 0);
}

}  // namespace concord
