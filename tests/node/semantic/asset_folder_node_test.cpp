#include "asset_station.hpp"

namespace concord {
namespace {

using AssetFolderNodeTest = AssetStation;

TEST_F(AssetFolderNodeTest, ABadLineHidesNoOtherAssetAndIsCountedOnce) {
  std::vector<Asset> heard;
  ListReceiver<Asset> list(*bus_, counters_, "out/assets", [&](const std::vector<Asset>& all) { heard = all; });
  std::ofstream(site_.state / "assets/assets.yaml")
      << "cube: {file: cube.obj, class: box, unit: 0.001}\nbad: {file: ../etc}\nworse: {unit: twelve}\nnone: 7\n";
  run(10'000'000);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].name, "cube");
  EXPECT_EQ(counters_.get("refused.assets.BAD_NAME"), 2) << "one file outside, and one that needs one";
  EXPECT_EQ(counters_.get("refused.assets.MALFORMED"), 1);
  std::ofstream(site_.state / "assets/assets.yaml") << "cube: {file: cube.obj";
  run();
  EXPECT_EQ(heard.size(), 1U) << "what it was, until it is one again";
  EXPECT_EQ(counters_.get("refused.assets.MALFORMED"), 2);
}

TEST_F(AssetFolderNodeTest, AGltfIsMadeOnceAndOfWhatTheModelIs) {
  const auto file = site_.state / "assets/gltf/cube.glb";
  const auto assets = site_.state / "assets/assets.yaml";
  ASSERT_TRUE(std::filesystem::exists(file));
  const auto made = std::filesystem::last_write_time(file);
  start();
  run();
  EXPECT_EQ(std::filesystem::last_write_time(file), made) << "it is not made again";
  std::vector<Asset> heard;
  ListReceiver<Asset> list(*bus_, counters_, "out/assets", [&](const std::vector<Asset>& all) { heard = all; });
  run();
  ASSERT_EQ(heard.size(), 2U);
  EXPECT_EQ(heard[0].gltf_bytes, static_cast<std::int64_t>(std::filesystem::file_size(file)));
  EXPECT_NEAR(heard[0].size.x(), 1.0, 1e-9);
  std::ofstream(site_.state / "assets/other.obj") << "v 0 0 0\nv 3000 0 0\nv 0 1000 0\nf 1 2 3\n";
  std::ofstream(assets) << "cube: {file: other.obj, class: box, unit: 0.001}\n";
  run();
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_NEAR(heard[0].size.x(), 3.0, 1e-9);
  std::filesystem::remove(file);
  run();
  EXPECT_TRUE(std::filesystem::exists(file)) << "somebody removed it";
  std::ofstream(assets) << "{}\n";
  run();
  EXPECT_FALSE(std::filesystem::exists(file));
}

void write_triangle(const std::filesystem::path& file, float side) {
  std::ofstream out(file, std::ios::binary);
  for (const float c : {0.F, 0.F, 0.F, side, 0.F, 0.F, 0.F, 1.F, 0.F}) {
    out.write(reinterpret_cast<const char*>(&c), sizeof c);
  }
}

/// Its vertices are those of shape.bin.
constexpr const char* kShape =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"uri":"shape.bin","byteLength":36}],
"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,
"type":"VEC3","min":[0,0,0],"max":[2,1,0]}]})";

TEST_F(AssetFolderNodeTest, AGltfIsMadeOfAModelWhosePartsComeLater) {
  const auto folder = site_.state / "assets";
  std::ofstream(folder / "shape.gltf") << kShape;
  std::ofstream(folder / "assets.yaml") << "shape: {file: shape.gltf}\n";
  run(5'000'000);
  EXPECT_FALSE(std::filesystem::exists(folder / "gltf/shape.glb"));
  EXPECT_EQ(counters_.get("refused.assets.MALFORMED"), 1) << "and is not tried each second";
  std::ofstream(folder / "shape.bin") << "half of it";
  run(5'000'000);
  EXPECT_FALSE(std::filesystem::exists(folder / "gltf/shape.glb"));
  write_triangle(folder / "shape.bin", 2);
  run(5'000'000);
  EXPECT_TRUE(std::filesystem::exists(folder / "gltf/shape.glb"));
}

TEST_F(AssetFolderNodeTest, AGltfIsMadeAgainWhenWhatItsModelNamesChanges) {
  const auto folder = site_.state / "assets";
  write_triangle(folder / "shape.bin", 2);
  std::ofstream(folder / "shape.gltf") << kShape;
  std::ofstream(folder / "assets.yaml") << "shape: {file: shape.gltf}\n";
  std::vector<Asset> heard;
  ListReceiver<Asset> list(*bus_, counters_, "out/assets", [&](const std::vector<Asset>& all) { heard = all; });
  run();
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_NEAR(heard[0].size.x(), 2.0, 1e-6);
  write_triangle(folder / "shape.bin", 4);
  std::filesystem::last_write_time(folder / "shape.bin",
                                   std::filesystem::file_time_type::clock::now() + std::chrono::seconds(5));
  run();
  EXPECT_NEAR(heard.at(0).size.x(), 4.0, 1e-6);
  const auto made = std::filesystem::last_write_time(folder / "gltf/shape.glb");
  start();
  run();
  EXPECT_EQ(std::filesystem::last_write_time(folder / "gltf/shape.glb"), made) << "noted over restarts";
}

TEST_F(AssetFolderNodeTest, AGltfThatCannotBeWrittenKeepsNoOtherFromBeingMade) {
  const auto folder = site_.state / "assets";
  std::filesystem::remove(folder / "gltf/cube.glb");
  std::filesystem::create_directories(folder / "gltf/cube.glb/in the way");
  std::ofstream(folder / "assets.yaml") << "cube: {file: cube.obj, unit: 0.002}\nlater: {file: cube.obj}\n";
  const auto refused = [&] { return counters_.get("refused.assets.IO"); };
  const std::int64_t before = refused();
  run(10'000'000);
  EXPECT_TRUE(std::filesystem::exists(folder / "gltf/later.glb"));
  EXPECT_EQ(refused(), before + 1) << "not each second";
  std::filesystem::remove_all(folder / "gltf/cube.glb");
  run(40'000'000);
  EXPECT_TRUE(std::filesystem::is_regular_file(folder / "gltf/cube.glb"));
}

}  // namespace
}  // namespace concord
