#pragma once

#include <optional>
#include <string>

#include <CLI/App.hpp>

#include "core/corrections.hpp"

namespace concord {

/// What `edit`, `zone` and `lease` take to say where: one shape, and the frame it is drawn in.
struct SelectionOptions {
  std::string line, area, box, oriented_box, prism, voxels;
  std::optional<double> low, high;  ///< of the prism
  double thickness = 0.0;           ///< of a line or an area, metres
  WorkFrame frame;
};

/// Options for any shape, at most one of which is given.
void add_shape_options(CLI::App& command, SelectionOptions& options);
/// Options for a volume: box, oriented box or prism.
void add_volume_options(CLI::App& command, SelectionOptions& options);

/// Refused: none given, what is no shape (core/shape.hpp: check), a voxel file that cannot be taken whole, a frame that
/// is no name. `resolution` is the map's: voxel files count in it.
[[nodiscard]] Result<Shape> shape_of(const SelectionOptions& options, double resolution);
[[nodiscard]] Result<Volume> volume_of(const SelectionOptions& options);
[[nodiscard]] bool is_given(const SelectionOptions& options);

}  // namespace concord
