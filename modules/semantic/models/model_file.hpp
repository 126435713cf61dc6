#pragma once

#include <filesystem>

#include "semantic/models/triangle_mesh.hpp"

namespace concord {

/// Reads a model file in a process of its own, so that a hostile one can neither crash nor fill this one: what it
/// is given is kMaxModelMemory of memory and kMaxModelSeconds of processor time. Siblings that the model names are
/// read from its own folder and those below it only.
/// Refused: kNotFound, kIo, kTooLarge (file size, triangles, or the memory or time it took), and read_model.
[[nodiscard]] Result<TriangleMesh> read_model_file(const std::filesystem::path& file);

inline constexpr std::uint64_t kMaxModelMemory = 6'000'000'000;
inline constexpr unsigned kMaxModelSeconds = 60;

}  // namespace concord
