#include "semantic/models/model_reader.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <string_view>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>

namespace concord {
namespace {

constexpr std::array<const char*, 5> kKinds{"glb", "gltf", "obj", "stl", "ply"};
constexpr const char* kModelName = "model.";

class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(Bytes bytes) : owned_(std::move(bytes)), bytes_(owned_) {}
  explicit MemoryStream(ByteSpan bytes) : bytes_(bytes) {}

  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    const std::size_t whole = size == 0 ? 0 : std::min(count, (bytes_.size() - at_) / size);
    if (whole > 0) std::memcpy(to, bytes_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
    if (offset > bytes_.size() - from) return aiReturn_FAILURE;
    at_ = from + offset;
    return aiReturn_SUCCESS;
  }
  [[nodiscard]] std::size_t Tell() const override { return at_; }
  [[nodiscard]] std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  Bytes owned_;
  ByteSpan bytes_;
  std::size_t at_ = 0;
};

/// Gives the library the model and what lies beside it, and no other file.
class ModelFiles : public Assimp::IOSystem {
 public:
  ModelFiles(ByteSpan model, std::string name, const SiblingReader& siblings)
      : model_(model), name_(std::move(name)), siblings_(siblings) {}

  [[nodiscard]] bool Exists(const char* file) const override {
    return is_model(file) || siblings_(plain(file)).has_value();
  }
  [[nodiscard]] char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char*) override {
    if (is_model(file)) return std::make_unique<MemoryStream>(model_).release();
    auto bytes = siblings_(plain(file));
    return bytes ? std::make_unique<MemoryStream>(std::move(*bytes)).release() : nullptr;
  }
  void Close(Assimp::IOStream* stream) override { std::unique_ptr<Assimp::IOStream>{stream}; }

 private:
  [[nodiscard]] bool is_model(const char* file) const { return plain(file) == name_; }
  [[nodiscard]] static std::string plain(std::string file) { return file.starts_with("./") ? file.substr(2) : file; }
  ByteSpan model_;
  std::string name_;
  const SiblingReader& siblings_;
};

Eigen::Matrix4d matrix_of(const aiMatrix4x4& m) {
  Eigen::Matrix4d out;
  out << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
  return out;
}

/// Release 5.2 takes one line end off the front of a binary .ply's data, in case the header ended with two bytes: where
/// the first number begins with that byte, all numbers would be read one byte late. One more in front makes up for it.
Bytes with_spare_line_end(ByteSpan bytes) {
  constexpr std::string_view kEnd = "\nend_header\n", kBinary = "\nformat binary";
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  Bytes out(bytes.begin(), bytes.end());
  const std::size_t end = text.find(kEnd);
  if (end == std::string_view::npos || text.substr(0, end).find(kBinary) == std::string_view::npos) return out;
  const std::size_t data = end + kEnd.size();
  if (data < out.size() && out[data] == '\n') out.insert(out.begin() + static_cast<std::ptrdiff_t>(data), '\n');
  return out;
}

bool has_polygons(const aiScene& scene) {
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[i];
    for (unsigned j = 0; j < mesh.mNumFaces; ++j) {
      if (mesh.mFaces[j].mNumIndices > 3) return true;
    }
  }
  return false;
}

/// Walks the parts of a scene: each places its meshes, and the parts below it.
class Gatherer {
 public:
  explicit Gatherer(const aiScene& scene) : scene_(scene) {}

  Result<TriangleMesh> all() && {
    if (const auto done = part(*scene_.mRootNode, Eigen::Matrix4d::Identity()); !done) {
      return tl::unexpected(done.error());
    }
    if (const auto fine = check(out_); !fine) return tl::unexpected(fine.error());
    return std::move(out_);
  }

 private:
  Result<void> part(const aiNode& node, const Eigen::Matrix4d& above) {
    const Eigen::Matrix4d T = above * matrix_of(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      if (const auto done = mesh(*scene_.mMeshes[node.mMeshes[i]], T); !done) return done;
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
      if (const auto done = part(*node.mChildren[i], T); !done) return done;
    }
    return {};
  }

  /// Counted before memory is taken: a small file may place one mesh a million times.
  Result<void> mesh(const aiMesh& mesh, const Eigen::Matrix4d& T) {
    if (mesh.mNumFaces > kMaxModelTriangles - out_.triangles.size() ||
        mesh.mNumVertices > 3 * kMaxModelTriangles - out_.vertices.size()) {
      return refuse(Code::kTooLarge,
                    "the model has over " + std::to_string(kMaxModelTriangles) + " triangles; simplify it");
    }
    const auto base = static_cast<std::uint32_t>(out_.vertices.size());
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& p = mesh.mVertices[i];
      out_.vertices.emplace_back((T * Eigen::Vector4d(p.x, p.y, p.z, 1.0)).head<3>());
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines enclose nothing
      out_.triangles.push_back({base + face.mIndices[0], base + face.mIndices[1], base + face.mIndices[2]});
    }
    return {};
  }

  const aiScene& scene_;
  TriangleMesh out_;
};

}  // namespace

bool is_model_kind(const std::string& kind) { return std::ranges::find(kKinds, kind) != kKinds.end(); }

Result<TriangleMesh> read_model(ByteSpan bytes, const std::string& kind, const SiblingReader& siblings) {
  if (!is_model_kind(kind)) return refuse(Code::kBadName, "a model must be .glb, .gltf, .obj, .stl or .ply");
  if (bytes.size() > kMaxModelBytes) return refuse(Code::kTooLarge, "the model's file is too large; simplify it");
  const Bytes mended = kind == "ply" ? with_spare_line_end(bytes) : Bytes{};
  const ByteSpan model = kind == "ply" ? ByteSpan(mended) : bytes;
  Assimp::Importer importer;
  const std::string name = kModelName + kind;
  importer.SetIOHandler(std::make_unique<ModelFiles>(model, name, siblings).release());  // the importer's from now on
  // Only shapes count. Joining corners would move them: equal ones are found where it matters (is_watertight).
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                                          aiComponent_COLORS | aiComponent_TEXCOORDS |
                                                          aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                                          aiComponent_TEXTURES | aiComponent_LIGHTS |
                                                          aiComponent_CAMERAS | aiComponent_MATERIALS);
  const aiScene* scene = importer.ReadFile(name, aiProcess_RemoveComponent);
  // Asked to divide what is triangles already, release 5.2 may abort.
  if (scene != nullptr && has_polygons(*scene)) scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    const std::string why = importer.GetErrorString();
    if (why.find("bad_alloc") != std::string::npos) {
      return refuse(Code::kTooLarge,
                    "the model asks for more memory than a model may have; it is broken, or to be simplified");
    }
    return refuse(Code::kMalformed, "the model cannot be read: " + why);
  }
  return Gatherer(*scene).all();
}

}  // namespace concord
