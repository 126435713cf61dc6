#include "semantic/models/model_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "sample_meshes.hpp"
#include "semantic/models/gltf.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

class ModelFile : public testing::Test {
 protected:
  ModelFile() : folder_(fs::path(testing::TempDir()) / ("models-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~ModelFile() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  /// @param first the first number; its lowest byte in the file is the first of the data.
  static std::string binary_ply(float first) {
    std::string text =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const auto put = [&](const auto& value) { text.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
    for (const float c : {first, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) put(c);
    put(static_cast<unsigned char>(3));
    for (const int i : {0, 1, 2}) put(i);
    return text;
  }

  fs::path folder_;
};

constexpr const char* kQuad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

TEST_F(ModelFile, ReadsPolygonsAsTriangles) {
  const auto mesh = read_model_file(write("quad.obj", kQuad));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), 2U);
}

TEST_F(ModelFile, ReadsBinaryDataThatBeginsWithALineEnd) {
  float first = 0.F;
  const std::uint32_t bits = 0x3F00000A;  // 0.5 and a little
  std::memcpy(&first, &bits, sizeof(first));
  const auto mesh = read_model_file(write("three.ply", binary_ply(first)));
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->vertices.size(), 3U);
  EXPECT_EQ(mesh->vertices[0], Eigen::Vector3d(first, 0, 0));
  EXPECT_EQ(mesh->vertices[1], Eigen::Vector3d(1, 0, 0));
}

TEST_F(ModelFile, AGlbThatIsWrittenIsReadAsItWas) {
  const TriangleMesh mesh = joined(box_mesh({-1, 0, 0.125}, {1, 2, 3}), box_mesh({4, 0, 0}, {5, 1, 1}));
  const Bytes bytes = write_glb(mesh, 0.5);
  const auto read = read_model_file(write("boxes.glb", std::string(bytes.begin(), bytes.end())));
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->triangles.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto k = static_cast<std::size_t>(corner);
      EXPECT_EQ(read->vertices[read->triangles[i][k]], 0.5 * mesh.vertices[mesh.triangles[i][k]]);
    }
  }
}

TEST_F(ModelFile, RefusesWhatIsNoModel) {
  EXPECT_EQ(read_model_file(folder_ / "none.obj").error().code, Code::kNotFound);
  EXPECT_EQ(read_model_file(write("model.fbx", kQuad)).error().code, Code::kBadName);
  EXPECT_EQ(read_model_file(write("empty.obj", "")).error().code, Code::kMalformed);
  EXPECT_EQ(read_model_file(write("noise.glb", "glTF not really")).error().code, Code::kMalformed);
  EXPECT_EQ(read_model_file(write("noise.stl", std::string(200, '\x7f'))).error().code, Code::kMalformed);
}

TEST_F(ModelFile, RefusesNumbersThatAreNone) {
  EXPECT_EQ(read_model_file(write("nan.ply", binary_ply(std::nanf("")))).error().code, Code::kNotFinite);
}

TEST_F(ModelFile, RefusesABillionTrianglesAndLivesOn) {
  const auto huge =
      read_model_file(write("huge.ply",
                            "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\n"
                            "property float x\nproperty float y\nproperty float z\nelement face 1000000000\n"
                            "property list uchar int vertex_indices\nend_header\n"));
  ASSERT_FALSE(huge);
  std::string stl(84, '\0');
  stl[83] = '\x40';  // says a billion
  EXPECT_FALSE(read_model_file(write("huge.stl", stl)));
  EXPECT_TRUE(read_model_file(write("quad.obj", kQuad)));
}

TEST_F(ModelFile, ReadsNoFileOutsideOfItsFolder) {
  const std::string gltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":")";
  const std::string rest = R"(","byteLength":36}]})";
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string data(reinterpret_cast<const char*>(corners), sizeof(corners));
  fs::create_directories(folder_ / "models");
  write("secret.bin", data);
  write("models/near.bin", data);
  const auto near = read_model_file(write("models/a.gltf", gltf + "near.bin" + rest));
  ASSERT_TRUE(near) << near.error().message;
  EXPECT_EQ(near->triangles.size(), 1U);
  EXPECT_FALSE(read_model_file(write("models/b.gltf", gltf + "../secret.bin" + rest)));
  fs::create_symlink(folder_ / "secret.bin", folder_ / "models" / "link.bin");
  EXPECT_FALSE(read_model_file(write("models/c.gltf", gltf + "link.bin" + rest)));
}

TEST(MeshBytes, ComeBackAsTheyWere) {
  for (const SampleMesh& sample : sample_meshes()) {
    const auto again = mesh_from_bytes(to_bytes(sample.mesh));
    ASSERT_TRUE(again);
    EXPECT_EQ(again->vertices, sample.mesh.vertices);
    EXPECT_EQ(again->triangles, sample.mesh.triangles);
  }
  const Bytes bytes = to_bytes(sample_meshes()[0].mesh);
  for (std::size_t n = 0; n < bytes.size(); n += 7) EXPECT_FALSE(mesh_from_bytes(ByteSpan(bytes).first(n)));
}

}  // namespace
}  // namespace concord
