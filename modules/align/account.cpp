#include "align/account.hpp"

namespace concord {

AlignEvidence account_of(const Alignment& alignment, double ms) {
  AlignEvidence out;
  out.reason = name(alignment.reason);
  out.message = words(alignment);
  out.T_target_source = alignment.T_target_source;
  out.overlap_source = alignment.overlap_source;
  out.overlap_target = alignment.overlap_target;
  out.rms = alignment.rms;
  for (int i = 0; i < 36; ++i) out.covariance[static_cast<std::size_t>(i)] = alignment.covariance(i / 6, i % 6);
  out.loose = alignment.loose;
  out.against_upright = alignment.against_upright;
  out.against_level = alignment.against_level;
  out.free_space_violation = alignment.free_space_violation;
  out.iterations = alignment.iterations;
  out.hypotheses = alignment.hypotheses;
  out.ms = ms;
  return out;
}

AlignResult result_of(const AlignTask& task, const Alignment& alignment, double ms, std::int64_t utime) {
  AlignResult out;
  out.id = task.id;
  out.target = task.target_agent;
  out.source = task.used_source;
  out.layers = task.used_layers;
  out.evidence = account_of(alignment, ms);
  out.utime = utime;
  return out;
}

}  // namespace concord
