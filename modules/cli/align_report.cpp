#include "cli/align_report.hpp"

#include <cmath>
#include <cstdio>

#include "cli/numbers.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

std::string percent(double share) { return format_number(100.0 * share, 1) + " %"; }

/// One standard deviation of the shift along x, y and z, metres.
std::array<double, 3> shift_sigmas(const Alignment& evidence) {
  std::array<double, 3> out{};
  for (int i = 0; i < 3; ++i) out[i] = std::sqrt(std::max(0.0, evidence.covariance(i + 3, i + 3)));
  return out;
}

std::vector<double> row_by_row(const Eigen::Matrix<double, 6, 6>& matrix) {
  const Eigen::Matrix<double, 6, 6> by_rows = matrix.transpose();
  return {by_rows.data(), by_rows.data() + by_rows.size()};
}

std::string transform_words(const Transform& transform) {
  std::string out;
  for (const double number : to_numbers(transform)) out += (out.empty() ? "" : " ") + format_number(number, 6);
  return out;
}

std::string rival_words(const Alignment& evidence) {
  std::string out;
  for (const Transform& rival : evidence.T_target_source_rivals) {
    out += "\nor by         --guess \"" + transform_words(rival) + "\"";
  }
  return out;
}

}  // namespace

nlohmann::json to_json(const Alignment& evidence) {
  nlohmann::json rivals = nlohmann::json::array();
  for (const Transform& rival : evidence.T_target_source_rivals) rivals.push_back(to_numbers(rival));
  return {{"accepted", evidence.accepted()},
          {"reason", name(evidence.reason)},
          {"message", evidence.message},
          {"T_target_source", to_numbers(evidence.T_target_source)},
          {"overlap", evidence.overlap()},
          {"overlap_source", evidence.overlap_source},
          {"overlap_target", evidence.overlap_target},
          {"rms_m", evidence.rms},
          {"covariance", row_by_row(evidence.covariance)},
          {"centre", {evidence.p_target_centre.x(), evidence.p_target_centre.y(), evidence.p_target_centre.z()}},
          {"rivals", rivals},
          {"sigma_m", shift_sigmas(evidence)},
          {"degenerate", evidence.loose},
          {"against_walls", evidence.against_upright},
          {"against_floors", evidence.against_level},
          {"free_space_violation", evidence.free_space_violation},
          {"iterations", evidence.iterations},
          {"hypotheses", evidence.hypotheses},
          {"ms", evidence.ms}};
}

std::string to_words(const Alignment& evidence) {
  const auto sigma = shift_sigmas(evidence);
  return std::string(evidence.accepted() ? "accepted" : "refused") + "      " + name(evidence.reason) + ": " +
         evidence.message + "\nT_target_source " + transform_words(evidence.T_target_source) + "\noverlap       " +
         percent(evidence.overlap_source) + " of the source, " + percent(evidence.overlap_target) +
         " of the target\nrms           " + format_number(1000.0 * evidence.rms, 0) +
         " mm across the surface; shift known to " + format_number(1000.0 * sigma[0], 0) + ", " +
         format_number(1000.0 * sigma[1], 0) + ", " + format_number(1000.0 * sigma[2], 0) +
         " mm along x, y, z\nagainst       " + percent(evidence.against_upright) + " of walls, " +
         percent(evidence.against_level) + " of floors, " + percent(evidence.free_space_violation) +
         " stands in free space\ntook          " + format_number(evidence.ms, 0) + " ms, " +
         std::to_string(evidence.hypotheses) + " places, " + std::to_string(evidence.iterations) + " iterations" +
         rival_words(evidence);
}

nlohmann::json to_json(const AlignResult& result) {
  const auto used = [](const AlignResult::Used& layer) {
    return nlohmann::json{{"agent", layer.agent}, {"frame", layer.frame_id}, {"revision", layer.revision}};
  };
  nlohmann::json layers = nlohmann::json::array();
  for (const AlignResult::Used& layer : result.layers) layers.push_back(used(layer));
  nlohmann::json out = to_json(result.evidence);
  out.update({{"id", result.id},
              {"author", result.author},
              {"source", used(result.source)},
              {"target", result.target.empty() ? nlohmann::json() : nlohmann::json(result.target)},
              {"layers", layers},
              {"open", result.open},
              {"slip_m", result.slip},
              {"slip_rad", result.slip_angle}});
  return out;
}

Exit say_undrawn(const Failure& failure, Exit verdict) {
  std::fprintf(stderr, "concord: no picture: %s (%s)\n", failure.message.c_str(), failure.code.c_str());
  return verdict == Exit::kDone ? failure.exit : verdict;
}

std::string pair_of(const AlignResult& result) {
  return result.source.agent + " in " + (result.target.empty() ? "the map" : result.target);
}

std::string to_words(const AlignResult& result) {
  std::string words =
      pair_of(result) + ", " + result.source.agent + " as of revision " + format_count(result.source.revision);
  for (const AlignResult::Used& layer : result.layers) {
    words += ", " + layer.agent + " " + format_count(layer.revision);
  }
  return words + "\n" + to_words(result.evidence);
}

}  // namespace concord
