// The examples of hmd_bridge/protocol/golden, which the TypeScript side reads too.

#include <gtest/gtest.h>

#include <fstream>

#include "protocol/control.hpp"
#include "protocol/frame.hpp"

namespace concord::hmd {
namespace {

Json read_golden(const std::string& name) {
  std::ifstream in(std::string(CONCORD_GOLDEN) + "/" + name);
  return Json::parse(in);
}

Bytes from_hex(const std::string& hex) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

/// The body as it is written again, null if it is none.
Json reread(const std::string& what, const std::string& name, const Json& body, Problem& problem) {
  const auto written = [](const auto& variant) {
    return std::visit([](const auto& value) { return write_value(value); }, variant);
  };
  if (what == "request") {
    RequestBody out;
    return read_request(name, body, out, problem).value() ? written(out) : Json();
  }
  if (what == "notice") {
    NoticeBody out;
    return read_notice(name, body, out, problem).value() ? written(out) : Json();
  }
  if (what == "event") {
    EventBody out;
    return read_event(name, body, out, problem).value() ? written(out) : Json();
  }
  return reread_answer(name, body, problem);
}

TEST(Golden, GoodMessagesAreReadAndWrittenAgainAsTheyWere) {
  int good = 0;
  for (const Json& row : read_golden("messages.json")) {
    if (!row["good"].get<bool>()) continue;
    Problem problem;
    const Json again = reread(row["what"], row["name"], row["body"], problem);
    EXPECT_EQ(again, row["body"]) << row["what"] << " " << row["name"] << problem.text;
    ++good;
  }
  EXPECT_GT(good, 200);
}

TEST(Golden, BadMessagesAreRefusedWithAReason) {
  int bad = 0;
  for (const Json& row : read_golden("messages.json")) {
    if (row["good"].get<bool>()) continue;
    Problem problem;
    const Json again = reread(row["what"], row["name"], row["body"], problem);
    EXPECT_TRUE(again.is_null()) << row;
    EXPECT_FALSE(problem.text.empty()) << row;
    ++bad;
  }
  EXPECT_GT(bad, 500);
}

TEST(Golden, FramesAreReadAsWritten) {
  for (const Json& row : read_golden("frames.json")) {
    if (!row["good"].get<bool>()) continue;
    const auto frame = read_frame(from_hex(row["hex"]));
    ASSERT_TRUE(frame) << row["name"] << frame.error().message;
    EXPECT_EQ(static_cast<int>(frame->head.kind), row["kind"]);
    EXPECT_EQ(frame->head.level, row["level"]);
    EXPECT_EQ(frame->head.stream, row["stream"]);
    EXPECT_EQ(frame->head.count, row["count"]);
    EXPECT_EQ(frame->head.revision, row["revision"]);
    EXPECT_EQ(frame->payload, from_hex(row["payload"])) << row["name"];
    // What we write of it reads the same.
    const auto again = read_frame(make_frame(frame->head, frame->payload));
    ASSERT_TRUE(again);
    EXPECT_EQ(again->payload, frame->payload);
    EXPECT_EQ(again->head.whole, frame->head.whole);
    switch (frame->head.kind) {
      case FrameKind::kBlock: EXPECT_EQ(block_payload(read_block(*frame).value()), frame->payload); break;
      case FrameKind::kForget: EXPECT_EQ(forget_payload(read_forget(*frame).value()), frame->payload); break;
      case FrameKind::kLabels: EXPECT_EQ(labels_payload(read_labels(*frame).value()), frame->payload); break;
      case FrameKind::kMesh: EXPECT_EQ(mesh_payload(read_mesh(*frame).value()), frame->payload); break;
      case FrameKind::kVoxels: EXPECT_EQ(voxels_payload(read_voxels(*frame).value()), frame->payload); break;
      default: break;
    }
  }
}

TEST(Golden, BadFramesAreRefused) {
  for (const Json& row : read_golden("frames.json")) {
    if (row["good"].get<bool>()) continue;
    const auto frame = read_frame(from_hex(row["hex"]));
    if (!frame) continue;
    const bool fine = frame->head.kind == FrameKind::kBlock    ? read_block(*frame).has_value()
                      : frame->head.kind == FrameKind::kForget ? read_forget(*frame).has_value()
                      : frame->head.kind == FrameKind::kLabels ? read_labels(*frame).has_value()
                      : frame->head.kind == FrameKind::kMesh   ? read_mesh(*frame).has_value()
                                                               : read_voxels(*frame).has_value();
    EXPECT_FALSE(fine) << row["name"];
  }
}

TEST(ControlText, EnvelopesAreReadStrictly) {
  const auto good = read_client_text(R"({"id": 7, "request": "clock", "body": {"t0": 1.5}})");
  ASSERT_TRUE(good);
  EXPECT_EQ(std::get<ClientRequest>(*good).id, 7);
  for (const char* text :
       {"", "[]", "{", "null", R"({"id":0,"request":"clock","body":{"t0":1}})",
        R"({"id":1,"request":"clock","body":{"t0":1},"more":1})", R"({"id":1,"request":"no_such","body":{}})",
        R"({"id":1.5,"request":"clock","body":{"t0":1}})", R"({"notice":"credit","body":{"bytes":-1}})",
        R"({"id":1,"notice":"credit","body":{"bytes":1}})", R"({"id":4294967296,"request":"agents","body":{}})",
        R"({"id":1,"request":"clock","body":{"t0":1e999}})"}) {
    EXPECT_FALSE(read_client_text(text)) << text;
  }
  EXPECT_EQ(read_client_text(R"({"id":9,"request":"clock","body":{}})").error().id, 9)
      << "the refusal reaches its asker";
}

TEST(ControlText, DepthAndSizeAreBoundedBeforeParsing) {
  EXPECT_FALSE(read_client_text(std::string(200'000, '[')));
  EXPECT_FALSE(
      read_client_text(R"({"id":1,"request":"clock","body":)" + std::string(100, '[') + std::string(100, ']') + "}"));
  EXPECT_FALSE(read_client_text("\"" + std::string(kMaxTextBytes, 'x') + "\""));
  EXPECT_TRUE(nests_at_most(R"({"a": "[[[[[[[\"[["})", 1)) << "brackets in texts do not nest";
}

}  // namespace
}  // namespace concord::hmd
