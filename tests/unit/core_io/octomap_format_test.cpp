#include "core/octomap_format.hpp"

#include <gtest/gtest.h>

#include <string>

namespace concord {
namespace {

Bytes text(const std::string& s) { return {s.begin(), s.end()}; }

Code refusal(const std::string& s) {
  const Bytes bytes = text(s);
  ByteSpan in = bytes;
  const auto header = read_octomap_header(in);
  EXPECT_FALSE(header.has_value()) << s;
  EXPECT_EQ(in.size(), bytes.size()) << "a refusal takes nothing";
  return header ? Code::kIo : header.error().code;
}

const std::string kTitle = "# Octomap OcTree binary file\n";

TEST(OctomapHeader, ComesBackWithItsResolutionExact) {
  const OctomapHeader header{OctomapFormat::kFull, 123456789012, 0.1 / 3};
  Bytes bytes;
  append_octomap_header(bytes, header);
  bytes.push_back(7);
  ByteSpan in = bytes;
  const auto read = read_octomap_header(in);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->format, header.format);
  EXPECT_EQ(read->nodes, header.nodes);
  EXPECT_EQ(read->resolution, header.resolution);
  EXPECT_EQ(in.size(), 1u);
}

TEST(OctomapHeader, TakesCommentsAnyOrderAndWindowsLineEnds) {
  const Bytes bytes = text(kTitle + "# by hand\r\nres 0.05\r\n#\nsize  7 \nid OcTree\ndata\n");
  ByteSpan in = bytes;
  const auto read = read_octomap_header(in);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(read->format, OctomapFormat::kBinary);
  EXPECT_EQ(read->nodes, 7u);
  EXPECT_EQ(read->resolution, 0.05);
  EXPECT_TRUE(in.empty());
}

TEST(OctomapHeader, RefusesWhatIsMissingTwiceOrUnknown) {
  EXPECT_EQ(refusal(""), Code::kMalformed);
  EXPECT_EQ(refusal("ply\nformat ascii 1.0\n"), Code::kMalformed);
  EXPECT_EQ(refusal(kTitle), Code::kMalformed);
  EXPECT_EQ(refusal(kTitle + "id OcTree\nsize 1\ndata\n"), Code::kMalformed);
  EXPECT_EQ(refusal(kTitle + "id OcTree\nsize 1\nres 0.1\n"), Code::kMalformed);
  EXPECT_EQ(refusal(kTitle + "id OcTree\nsize 1\nsize 1\nres 0.1\ndata\n"), Code::kMalformed);
  EXPECT_EQ(refusal(kTitle + "id OcTree\nsize 1\nres 0.1\ncolour red\ndata\n"), Code::kMalformed);
  EXPECT_EQ(refusal(kTitle + "id OcTree\nsize -1\nres 0.1\ndata\n"), Code::kMalformed);
  EXPECT_EQ(refusal(kTitle + "id OcTree\nsize 1\nres 0.1x\ndata\n"), Code::kMalformed);
  EXPECT_EQ(refusal(kTitle + "#" + std::string(100'000, ' ') + "\nid OcTree\nsize 1\nres 0.1\ndata\n"),
            Code::kMalformed);
}

TEST(OctomapHeader, RefusesOtherTreesAndNamesThem) {
  const Bytes bytes = text("# Octomap OcTree file\nid ColorOcTree\nsize 1\nres 0.1\ndata\n");
  ByteSpan in = bytes;
  const auto read = read_octomap_header(in);
  ASSERT_FALSE(read.has_value());
  EXPECT_NE(read.error().message.find("'ColorOcTree'"), std::string::npos);
}

TEST(OctomapHeader, RefusesResolutionsThatAreNone) {
  for (const char* res : {"0", "-0.1", "1e-9", "1e9"}) {
    EXPECT_EQ(refusal(kTitle + "id OcTree\nsize 1\nres " + res + "\ndata\n"), Code::kBadResolution) << res;
  }
  EXPECT_EQ(refusal(kTitle + "id OcTree\nsize 1\nres nan\ndata\n"), Code::kNotFinite);
  EXPECT_EQ(refusal(kTitle + "id OcTree\nsize 1\nres inf\ndata\n"), Code::kNotFinite);
}

}  // namespace
}  // namespace concord
