#include "cloud_file.hpp"

#include <stdexcept>

#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

namespace concord::bench {
namespace {

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

std::vector<Eigen::Vector3f> finite_points(const pcl::PointCloud<pcl::PointXYZ>& cloud) {
  std::vector<Eigen::Vector3f> out;
  for (const pcl::PointXYZ& p : cloud) {
    if (p.getVector3fMap().allFinite()) out.push_back(p.getVector3fMap());
  }
  return out;
}

}  // namespace

std::vector<Eigen::Vector3f> read_cloud(const std::filesystem::path& file, double spacing) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  if (file.extension() == ".pcd") {
    if (pcl::io::loadPCDFile(file.string(), cloud) != 0) throw std::runtime_error(file.string() + ": cannot be read");
    return finite_points(cloud);
  }
  pcl::PolygonMesh mesh;
  if (pcl::io::loadPLYFile(file.string(), mesh) < 0) throw std::runtime_error(file.string() + ": cannot be read");
  pcl::fromPCLPointCloud2(mesh.cloud, cloud);
  if (mesh.polygons.empty()) return finite_points(cloud);
  std::vector<Eigen::Vector3f> out;
  for (const pcl::Vertices& face : mesh.polygons) {
    for (std::size_t i = 2; i < face.vertices.size(); ++i) {
      sample_triangle(cloud.at(face.vertices[0]).getVector3fMap(), cloud.at(face.vertices[i - 1]).getVector3fMap(),
                      cloud.at(face.vertices[i]).getVector3fMap(), spacing, out);
    }
  }
  return out;
}

}  // namespace concord::bench
