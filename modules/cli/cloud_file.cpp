#include "cli/cloud_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <sstream>
#include <string>

#include <pcl/PolygonMesh.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include "align/surface.hpp"
#include "cli/extension.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPointBytes = 1024;  ///< of one point with all its fields
constexpr std::size_t kMaxHeaderLines = 200;
constexpr std::size_t kMaxHeaderLine = 4096;
constexpr double kMaxSamples = 8e6;

tl::unexpected<Error> malformed(const fs::path& file, const std::string& why) {
  return refuse(Code::kMalformed, file.string() + ": " + why);
}
tl::unexpected<Error> too_large(const fs::path& file, const std::string& what) {
  return refuse(Code::kTooLarge, file.string() + ": " + what + "; downsample it first");
}

Result<std::size_t> size_of(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return refuse(Code::kNotFound, file.string() + ": there is no such file");
  const auto bytes = fs::file_size(file, error);
  if (error) return refuse(Code::kIo, file.string() + ": " + error.message());
  if (bytes > kMaxCloudFileBytes) return too_large(file, "over 2 GB");
  return static_cast<std::size_t>(bytes);
}

/// What a file claims to hold: PCL takes memory for it before it looks whether it is there.
struct Claims {
  std::size_t points = 0;
  std::size_t point_bytes = 0;
  std::size_t faces = 0;
  bool is_packed = false;
};

std::size_t sum_of(std::istringstream& numbers) {
  std::size_t sum = 0;
  for (std::size_t n = 0; numbers >> n && sum <= kMaxPointBytes;) sum += std::min(n, kMaxPointBytes + 1);
  return sum;
}

/// Of the lines of a header up to the one that begins its data.
Result<Claims> claims_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return refuse(Code::kIo, file.string() + ": cannot be opened");
  Claims claims;
  std::size_t width = 0, height = 1;
  std::array<char, kMaxHeaderLine> line{};
  for (std::size_t i = 0; i < kMaxHeaderLines && in.getline(line.data(), line.size()); ++i) {
    std::istringstream words(line.data());
    std::string key, what;
    words >> key;
    // PCL takes any word that begins so, and the last of several: what is the most that they may claim counts.
    const auto most = [&](std::size_t& claimed) {
      std::size_t here = 0;
      words >> here;
      claimed = std::max(claimed, here);
    };
    if (key.starts_with("POINTS")) {
      most(claims.points);
    } else if (key.starts_with("WIDTH")) {
      most(width);
    } else if (key.starts_with("HEIGHT")) {
      most(height);
    } else if (key.starts_with("SIZE")) {
      claims.point_bytes = std::max(claims.point_bytes, sum_of(words));
    } else if (key.starts_with("COUNT")) {
      claims.point_bytes = std::max(claims.point_bytes, std::min<std::size_t>(8 * sum_of(words), kMaxPointBytes + 1));
    } else if (key == "element") {
      words >> what;
      std::size_t count = 0;
      most(count);
      std::size_t& all = what == "vertex" ? claims.points : claims.faces;
      all += std::min(count, kMaxCloudFilePoints + 1);
    } else if (key.starts_with("DATA") || key == "end_header") {
      words >> what;
      claims.is_packed = what == "binary_compressed";
      if (width > kMaxCloudFilePoints || height > kMaxCloudFilePoints) return too_large(file, "over 20 million points");
      claims.points = std::max(claims.points, width * height);
      return claims;
    }
  }
  return malformed(file, "its header has no end");
}

Result<void> check_claims(const fs::path& file) {
  const auto bytes = size_of(file);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto claims = claims_of(file);
  if (!claims) return tl::unexpected(claims.error());
  if (claims->points > kMaxCloudFilePoints || claims->faces > kMaxCloudFilePoints) {
    return too_large(file, "over 20 million points or faces");
  }
  if (claims->point_bytes > kMaxPointBytes) return too_large(file, "over 1 kB a point");
  // A point or a face takes a byte at least, unless they are packed.
  if (!claims->is_packed && claims->points + claims->faces > *bytes) {
    return malformed(file, "it is shorter than its header says");
  }
  return {};
}

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

double area_of(const Cloud& cloud, const pcl::Vertices& face) {
  double area = 0.0;
  for (std::size_t i = 2; i < face.vertices.size(); ++i) {
    const Eigen::Vector3f a = cloud[face.vertices[0]].getVector3fMap();
    const Eigen::Vector3f b = cloud[face.vertices[i - 1]].getVector3fMap() - a;
    const Eigen::Vector3f c = cloud[face.vertices[i]].getVector3fMap() - a;
    area += 0.5 * b.cross(c).norm();
  }
  return area;
}

void sample_triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, double spacing,
                     std::vector<Eigen::Vector3f>& out) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const int steps = std::max(1, static_cast<int>(std::ceil(longest / spacing)));
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps - i; ++j) {
      const float u = (static_cast<float>(i) + 1.0F / 3) / static_cast<float>(steps);
      const float v = (static_cast<float>(j) + 1.0F / 3) / static_cast<float>(steps);
      out.emplace_back(a + u * (b - a) + v * (c - a));
    }
  }
}

/// @pre every face names points of the cloud, all finite and within reach.
double spacing_for(const Cloud& cloud, const std::vector<pcl::Vertices>& faces, double spacing) {
  double longest = 0.0;
  double area = 0.0;
  for (const pcl::Vertices& face : faces) {
    area += area_of(cloud, face);
    for (std::size_t i = 1; i < face.vertices.size(); ++i) {
      const Eigen::Vector3f edge = cloud[face.vertices[i]].getVector3fMap() - cloud[face.vertices[0]].getVector3fMap();
      longest = std::max(longest, static_cast<double>(edge.norm()));
    }
  }
  // A sliver as long as all else together is sampled as densely as it is long: n^2 / 2 samples of a triangle.
  const double by_area = std::sqrt(2.0 * area / kMaxSamples);
  return std::max({spacing, by_area, longest / 2000.0});
}

Result<std::vector<Eigen::Vector3f>> sampled(const fs::path& file, const Cloud& cloud,
                                             const std::vector<pcl::Vertices>& faces, double spacing) {
  for (const pcl::Vertices& face : faces) {
    for (const auto index : face.vertices) {
      if (index < 0 || static_cast<std::size_t>(index) >= cloud.size())
        return malformed(file, "a face names a point that is not there");
      const Eigen::Vector3f p = cloud[index].getVector3fMap();
      if (!p.allFinite()) return malformed(file, "a face has a corner that is not finite");
      if (p.cwiseAbs().maxCoeff() > kMaxSurfaceReach) {
        return refuse(Code::kOutOfBounds, file.string() + ": a point is over 10 km from the origin; is it in metres?");
      }
    }
  }
  const double step = spacing_for(cloud, faces, spacing);
  std::vector<Eigen::Vector3f> out;
  for (const pcl::Vertices& face : faces) {
    for (std::size_t i = 2; i < face.vertices.size(); ++i) {
      sample_triangle(cloud[face.vertices[0]].getVector3fMap(), cloud[face.vertices[i - 1]].getVector3fMap(),
                      cloud[face.vertices[i]].getVector3fMap(), step, out);
      if (out.size() > kMaxCloudFilePoints) return too_large(file, "its faces overlap to over 20 million samples");
    }
  }
  return out;
}

Result<std::vector<Eigen::Vector3f>> finite_points(const fs::path& file, const Cloud& cloud) {
  std::vector<Eigen::Vector3f> out;
  for (const pcl::PointXYZ& p : cloud) {
    if (!p.getVector3fMap().allFinite()) continue;  // a sensor's mark of no return
    if (p.getVector3fMap().cwiseAbs().maxCoeff() > kMaxSurfaceReach) {
      return refuse(Code::kOutOfBounds, file.string() + ": a point is over 10 km from the origin; is it in metres?");
    }
    out.push_back(p.getVector3fMap());
  }
  return out;
}

using Field = pcl::PCLPointField;

const Field* field_of(const pcl::PCLPointCloud2& points, const char* name) {
  const auto it =
      std::find_if(points.fields.begin(), points.fields.end(), [&](const Field& f) { return f.name == name; });
  return it == points.fields.end() ? nullptr : &*it;
}

/// PCL's own conversion takes fields of other types for absent ones: many tools write doubles.
Result<Cloud> cloud_of(const fs::path& file, const pcl::PCLPointCloud2& points) {
  const Field* axes[] = {field_of(points, "x"), field_of(points, "y"), field_of(points, "z")};
  Cloud cloud;
  cloud.resize(static_cast<std::size_t>(points.width) * points.height);
  for (int axis = 0; axis < 3; ++axis) {
    const Field* field = axes[axis];
    if (field == nullptr) return malformed(file, "its points have no x, y and z");
    const bool is_double = field->datatype == Field::FLOAT64;
    if (!is_double && field->datatype != Field::FLOAT32) return malformed(file, "x, y and z must be float or double");
    const std::size_t end = field->offset + (is_double ? sizeof(double) : sizeof(float));
    if (end > points.point_step || cloud.size() * points.point_step > points.data.size()) {
      return malformed(file, "it holds less than its header says");
    }
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const std::uint8_t* at = points.data.data() + i * points.point_step + field->offset;
      double wide = 0.0;
      float narrow = 0.0F;
      is_double ? std::memcpy(&wide, at, sizeof wide) : std::memcpy(&narrow, at, sizeof narrow);
      cloud[i].data[axis] = is_double ? static_cast<float>(wide) : narrow;
    }
  }
  return cloud;
}

Result<std::vector<Eigen::Vector3f>> read_pcd(const fs::path& file) {
  pcl::PCLPointCloud2 points;
  if (pcl::io::loadPCDFile(file.string(), points) != 0) return malformed(file, "PCL cannot read it");
  const auto cloud = cloud_of(file, points);
  if (!cloud) return tl::unexpected(cloud.error());
  return finite_points(file, *cloud);
}

Result<std::vector<Eigen::Vector3f>> read_ply(const fs::path& file, double spacing) {
  pcl::PolygonMesh mesh;
  if (pcl::io::loadPLYFile(file.string(), mesh) < 0) return malformed(file, "PCL cannot read it");
  const auto cloud = cloud_of(file, mesh.cloud);
  if (!cloud) return tl::unexpected(cloud.error());
  if (mesh.polygons.empty()) return finite_points(file, *cloud);
  return sampled(file, *cloud, mesh.polygons, spacing);
}

}  // namespace

Result<std::vector<Eigen::Vector3f>> read_cloud(const fs::path& file, double spacing) {
  const std::string extension = extension_of(file);
  const bool is_pcd = extension == ".pcd";
  if (!is_pcd && extension != ".ply") return refuse(Code::kBadName, file.string() + " must end in .pcd or .ply");
  if (const auto fine = check_claims(file); !fine) return tl::unexpected(fine.error());
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // what went wrong is in the refusal
  try {
    auto points = is_pcd ? read_pcd(file) : read_ply(file, spacing);
    if (points && points->empty()) return refuse(Code::kEmpty, file.string() + ": it has no point");
    return points;
  } catch (const std::exception& e) {
    return malformed(file, std::string("PCL cannot read it: ") + e.what());
  }
}

}  // namespace concord
