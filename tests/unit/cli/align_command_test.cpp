#include <unistd.h>

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "../align/rooms.hpp"
#include "cli/cloud_file.hpp"
#include "cli/command.hpp"
#include "cli/map_file.hpp"

namespace concord::test {
namespace {

namespace fs = std::filesystem;

std::string pcd(const Points& points, const std::string& claimed = "") {
  const std::string count = claimed.empty() ? std::to_string(points.size()) : claimed;
  std::ostringstream out;
  out << "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " << count
      << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << count << "\nDATA ascii\n";
  for (const auto& p : points) out << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  return out.str();
}

std::string ply(const Points& points, const std::string& faces = "") {
  std::ostringstream out;
  const auto lines = std::count(faces.begin(), faces.end(), '\n');
  out << "ply\nformat ascii 1.0\nelement vertex " << points.size()
      << "\nproperty float x\nproperty float y\nproperty float z\n";
  if (lines > 0) out << "element face " << lines << "\nproperty list uchar int vertex_indices\n";
  out << "end_header\n";
  for (const auto& p : points) out << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  out << faces;
  return out.str();
}

/// Files in a folder of its own.
class AlignFilesTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::string write(const std::string& name, const BrickMap& map) {
    EXPECT_TRUE(save_map(folder_ / name, map, kResolution));
    return folder_ / name;
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  /// Its exit code; what it printed is in `said_`.
  int align(std::vector<std::string> arguments) {
    Program program;
    add_align(program);
    arguments.insert(arguments.begin(), {"align"});
    arguments.emplace_back("--json");
    std::vector<const char*> argv = {"concord"};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    testing::internal::CaptureStdout();
    const int code = program.run(static_cast<int>(argv.size()), argv.data());
    said_ = nlohmann::json::parse(testing::internal::GetCapturedStdout());
    return code;
  }
  void expect_found() {
    EXPECT_EQ(said_["accepted"], true);
    EXPECT_EQ(said_["reason"], "ACCEPTED");
    const auto T = said_["T_target_source"].get<std::vector<double>>();
    ASSERT_EQ(T.size(), 7U);
    EXPECT_LT((Eigen::Vector3d(T[0], T[1], T[2]) - kT_left_right.translation()).norm(), 0.1);
    const Eigen::Quaterniond turned(T[6], T[3], T[4], T[5]);
    EXPECT_LT(turned.angularDistance(Eigen::Quaterniond(kT_left_right.linear())), degrees(1.0));
    EXPECT_GT(said_["overlap"].get<double>(), 0.4);
    EXPECT_LT(said_["rms_m"].get<double>(), 0.03);
    EXPECT_GT(said_["ms"].get<double>(), 0.0);
  }
  void expect_unusable(const std::string& file, const std::string& code) {
    EXPECT_EQ(align({file, file}), 2) << said_;
    EXPECT_EQ(said_["error"]["code"], code) << said_;
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("align" + std::to_string(getpid()));
  nlohmann::json said_;
};

TEST_F(AlignFilesTest, FindsOneInTheOtherWhateverTheyAreKeptIn) {
  const std::string targets[] = {write("left.ot", voxels_of(left_part())), write("left.pcd", pcd(left_part())),
                                 write("left.ply", ply(left_part()))};
  const std::string source = write("right.pcd", pcd(right_part()));
  for (const std::string& target : targets) {
    EXPECT_EQ(align({source, target}), 0) << target;
    expect_found();
  }
}

TEST_F(AlignFilesTest, TakesAGuessAndDrawsBeforeAndAfter) {
  const std::string target = write("left.pcd", pcd(left_part())), source = write("right.bt", voxels_of(right_part()));
  EXPECT_EQ(align({source, target, "--guess", "3.4 -0.6 0.2 0 0 0.2 0.98", "--picture", path("out.png")}), 0);
  expect_found();
  EXPECT_GT(fs::file_size(path("out.png")), 10'000U);
}

/// What was found is printed whatever becomes of the picture, and in JSON there is nothing else.
TEST_F(AlignFilesTest, APictureThatFailsTakesNothingFromWhatWasFound) {
  const std::string target = write("left.pcd", pcd(left_part())), source = write("right.pcd", pcd(right_part()));
  fs::create_directory(path("taken.png"));
  EXPECT_EQ(align({source, target, "--picture", path("taken.png")}), 2);
  expect_found();
  const std::string one = write("one.pcd", pcd({{0, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(align({one, target, "--picture", path("out.png")}), 3) << "nothing to draw";
  EXPECT_EQ(said_["reason"], "NO_MAP");
}

TEST_F(AlignFilesTest, APictureIntoNoFolderIsRefusedBeforeAnythingIsRead) {
  EXPECT_EQ(align({path("none.pcd"), path("none.pcd"), "--picture", path("none/out.png")}), 2);
  EXPECT_EQ(said_["error"]["code"], "NOT_FOUND");
  EXPECT_NE(said_["error"]["message"].get<std::string>().find("picture"), std::string::npos) << said_;
}

TEST_F(AlignFilesTest, AnotherRoomIsRefusedWithTheFigures) {
  const std::string target = write("left.ply", ply(left_part())), source = write("other.ply", ply(other_room()));
  EXPECT_EQ(align({source, target}), 3);
  EXPECT_EQ(said_["accepted"], false);
  EXPECT_NE(said_["reason"], "ACCEPTED");
  for (const char* key : {"T_target_source", "overlap", "rms_m", "ms", "degenerate", "free_space_violation"}) {
    EXPECT_TRUE(said_.contains(key)) << key;
  }
}

TEST_F(AlignFilesTest, TooLittleIsNoMap) {
  const std::string one = write("one.pcd", pcd({{0, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(align({one, one}), 3);
  EXPECT_EQ(said_["reason"], "NO_MAP");
}

TEST_F(AlignFilesTest, AMeshIsSampled) {
  const std::string mesh = write("mesh.ply", ply({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}, "4 0 1 2 3\n"));
  const auto points = read_cloud(mesh, 0.05);
  ASSERT_TRUE(points);
  EXPECT_GT(points->size(), 2.0 / 0.05 / 0.05);
  for (const Eigen::Vector3f& p : *points) {
    EXPECT_TRUE(p.x() >= 0 && p.x() <= 2 && p.y() >= 0 && p.y() <= 1 && p.z() == 0) << p.transpose();
  }
}

TEST_F(AlignFilesTest, PointsThatAreNotFiniteAreLeftOut) {
  const std::string file = write("nan.pcd", pcd({{0, 0, 0}, {NAN, 0, 0}, {1, 2, 3}}));
  const auto points = read_cloud(file, 0.05);
  ASSERT_TRUE(points);
  EXPECT_EQ(points->size(), 2U);
}

TEST_F(AlignFilesTest, DoublesAreReadAsSuch) {
  const std::string pcd =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n1.5 -2.25 3.125\n0.5 0 0\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\n"
      "end_header\n1.5 -2.25 3.125\n0.5 0 0\n";
  for (const std::string& file : {write("doubles.pcd", pcd), write("doubles.ply", ply)}) {
    const auto points = read_cloud(file, 0.05);
    ASSERT_TRUE(points) << points.error().message;
    ASSERT_EQ(points->size(), 2U);
    EXPECT_TRUE(points->front().isApprox(Eigen::Vector3f(1.5F, -2.25F, 3.125F))) << file;
  }
}

TEST_F(AlignFilesTest, BadFilesAreRefusedInWords) {
  expect_unusable(write("flat.pcd",
                        "VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n"
                        "DATA ascii\n1 2\n"),
                  "MALFORMED");
  expect_unusable(path("none.pcd"), "NOT_FOUND");
  expect_unusable(write("empty.pcd", pcd({})), "EMPTY");
  expect_unusable(write("headless.pcd", "VERSION 0.7\nFIELDS x y z\n"), "MALFORMED");
  expect_unusable(write("huge.pcd", pcd({{0, 0, 0}}, "4000000000000")), "TOO_LARGE");
  expect_unusable(write("claims.pcd", pcd({{0, 0, 0}}, "1000000")), "MALFORMED");
  expect_unusable(write("noise.ply", "ply\n\x01\x02\x03"), "MALFORMED");
  expect_unusable(write("noise.bt", "# Octomap OcTree binary file\n\xff"), "MALFORMED");
  expect_unusable(write("far.pcd", pcd({{1e6F, 0, 0}})), "OUT_OF_BOUNDS");
  expect_unusable(write("corner.ply", ply({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, "3 0 1 7\n")), "MALFORMED");
  expect_unusable(write("negative.ply", ply({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, "3 0 1 -1\n")), "MALFORMED");
}

/// The library that reads them takes WIDTHX for WIDTH, and memory for what it claims: so must whoever checks the claim.
TEST_F(AlignFilesTest, ClaimsOfAHeaderAreHeardByWhateverWordIsTakenForThem) {
  const std::string honest = pcd({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const auto with_line = [&](const std::string& name, const std::string& line) {
    std::string text = honest;
    return write(name, text.insert(text.find("VIEWPOINT"), line + "\n"));
  };
  expect_unusable(with_line("widthx.pcd", "WIDTHX 4000000000"), "TOO_LARGE");
  expect_unusable(with_line("heights.pcd", "HEIGHTS 4000000000"), "TOO_LARGE");
  expect_unusable(with_line("pointsx.pcd", "POINTSX 4000000000"), "TOO_LARGE");
  expect_unusable(with_line("sizes.pcd", "SIZES 4 4 4000000"), "TOO_LARGE");
  EXPECT_TRUE(read_cloud(with_line("other.pcd", "# a WIDTH 4000000000"), 0.05)) << "that is a remark";
}

TEST_F(AlignFilesTest, CutAnywhereAFileIsReadOrRefused) {
  for (const auto& [name, text] : {std::pair("cut.pcd", pcd({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})),
                                   std::pair("cut.ply", ply({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, "3 0 1 2\n"))}) {
    for (std::size_t bytes = 0; bytes < text.size(); bytes += 3) {
      const auto points = read_cloud(write(name, text.substr(0, bytes)), 0.05);
      EXPECT_TRUE(points || !points.error().message.empty());
    }
  }
}

TEST_F(AlignFilesTest, AWrongUseIsToldSo) {
  const std::string file = write("right.pcd", pcd(right_part()));
  EXPECT_EQ(align({file}), 2);
  EXPECT_EQ(align({file, file, "--accept"}), 2);
  EXPECT_EQ(align({file, file, "--guess", "1 2 3"}), 2);
  EXPECT_EQ(align({file, file, "--guess", ""}), 2) << "a script whose variable is unset asks for no search everywhere";
  EXPECT_EQ(align({"a", "b", "--from-files"}), 2);
}

}  // namespace
}  // namespace concord::test
