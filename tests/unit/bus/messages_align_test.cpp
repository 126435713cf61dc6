#include <concord/align_decision_t.hpp>
#include <concord/align_request_t.hpp>
#include <concord/align_result_t.hpp>

#include <gtest/gtest.h>

#include "message_checks.hpp"

namespace concord::test {
namespace {

AlignRequest a_request() { return {"a", "eva", "robot1", "", "", "", Transform::Identity(), 5}; }
AlignDecision a_decision() { return {"d", "eva", AlignDecision::Op::kAccept, "a", 5}; }
AlignResult a_result() {
  AlignResult out;
  out.id = "a";
  out.source = {"robot1", "odom", 1};
  out.evidence.reason = AlignReason::kAccepted;
  return out;
}

/// The message as a program could write it that does not heed what our values cannot hold.
template <class Lcm, class Value, class Change>
Decoded<Value> tampered(const Value& value, Change change) {
  const Bytes bytes = encode(value);
  Lcm message;
  EXPECT_EQ(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  change(message);
  Bytes out(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(out.data(), 0, static_cast<int>(out.size()));
  return decode<Value>(out);
}

TEST(AlignRequestMessage, RefusesWhatNoAgentCanHave) {
  const auto refused = [](auto change, Code code) {
    expect_refused(tampered<align_request_t>(a_request(), change), code, "a");
  };
  refused([](auto& m) { m.source = ""; }, Code::kBadName);
  refused([](auto& m) { m.source = "../x"; }, Code::kBadName);
  refused([](auto& m) { m.target = "a b"; }, Code::kBadName);
  refused([](auto& m) { m.source_frame_id = "a/b"; }, Code::kBadFrame);
  refused([](auto& m) { m.target_frame_id = " "; }, Code::kBadFrame);
  refused([](auto& m) { m.utime = -1; }, Code::kBadRequest);
  refused([](auto& m) { m.author = "\x01"; }, Code::kBadRequest);
  refused([](auto& m) { m.T_target_source.position[1] = kNaN; }, Code::kNotFinite);
  refused([](auto& m) { m.T_target_source.quaternion[3] = 0; }, Code::kBadTransform);
}

TEST(AlignRequestMessage, DoesNotHeedATransformThatIsNoGuess) {
  const auto read = tampered<align_request_t>(a_request(), [](auto& m) {
    m.has_guess = 0;
    m.T_target_source.position[0] = kNaN;
  });
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->T_target_source);
}

TEST(AlignRequestMessage, WithoutAnIdReachesNobody) {
  expect_refused(tampered<align_request_t>(a_request(), [](auto& m) { m.request_id = ""; }), Code::kBadRequest, "");
}

TEST(AlignDecisionMessage, RefusesAnOpOrIdThatIsNone) {
  expect_refused(tampered<align_decision_t>(a_decision(), [](auto& m) { m.op = 0; }), Code::kBadRequest, "d");
  expect_refused(tampered<align_decision_t>(a_decision(), [](auto& m) { m.op = 3; }), Code::kBadRequest, "d");
  expect_refused(tampered<align_decision_t>(a_decision(), [](auto& m) { m.align_id = ""; }), Code::kBadRequest, "d");
}

TEST(AlignResultMessage, RefusesFiguresThatAreNone) {
  const auto refused = [](auto change, Code code) {
    expect_refused(tampered<align_result_t>(a_result(), change), code, "");
  };
  refused([](auto& m) { m.overlap_source = 1.5; }, Code::kBadRequest);
  refused([](auto& m) { m.against_walls = kNaN; }, Code::kBadRequest);
  refused([](auto& m) { m.rms = -1; }, Code::kNotFinite);
  refused([](auto& m) { m.covariance[35] = kNaN; }, Code::kNotFinite);
  refused([](auto& m) { m.centre[2] = kNaN; }, Code::kNotFinite);
  refused([](auto& m) { m.rivals.emplace_back(), m.rival_count = 1; }, Code::kBadTransform);
  refused([](auto& m) { m.reason = "PERHAPS"; }, Code::kBadRequest);
  refused([](auto& m) { m.hypotheses = -1; }, Code::kBadRequest);
  refused([](auto& m) { m.reason = ""; }, Code::kBadRequest);
  refused([](auto& m) { m.source.agent = ""; }, Code::kBadName);
  refused([](auto& m) { m.T_target_source.quaternion[0] = 7; }, Code::kBadTransform);
}

TEST(AlignResultMessage, RefusesCountsBeyondTheLimit) {
  const auto many = tampered<align_result_t>(a_result(), [](auto& m) {
    m.count = 1001;
    m.layers.resize(1001);
  });
  expect_refused(many, Code::kTooLarge, "");
  const auto loose = tampered<align_result_t>(a_result(), [](auto& m) {
    m.loose_count = 7;
    m.loose.resize(7);
  });
  expect_refused(loose, Code::kTooLarge, "");
}

}  // namespace
}  // namespace concord::test
