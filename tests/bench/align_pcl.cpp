#include "align_speed.hpp"

#include <pcl/features/normal_3d.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>

namespace concord::bench {
namespace {

constexpr float kLeaf = 0.25F;              // metres, as the peers' own default and our middle level
constexpr double kMaxCorrespondence = 1.0;  // metres
constexpr int kIterations = 50;

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using CloudN = pcl::PointCloud<pcl::PointNormal>;

Cloud::Ptr downsampled(const Points& points) {
  Cloud::Ptr cloud(new Cloud);
  for (const Eigen::Vector3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  pcl::VoxelGrid<pcl::PointXYZ> filter;
  filter.setLeafSize(kLeaf, kLeaf, kLeaf);
  filter.setInputCloud(cloud);
  Cloud::Ptr out(new Cloud);
  filter.filter(*out);
  return out;
}

CloudN::Ptr with_normals(const Points& points) {
  const Cloud::Ptr cloud = downsampled(points);
  pcl::NormalEstimation<pcl::PointXYZ, pcl::PointNormal> estimate;
  estimate.setInputCloud(cloud);
  estimate.setKSearch(10);
  CloudN::Ptr out(new CloudN);
  estimate.compute(*out);
  for (std::size_t i = 0; i < cloud->size(); ++i) (*out)[i].getVector3fMap() = (*cloud)[i].getVector3fMap();
  return out;
}

template <class Icp, class CloudPtr>
Transform run(Icp& icp, const CloudPtr& target, const CloudPtr& source, const Transform& guess) {
  icp.setInputTarget(target);
  icp.setInputSource(source);
  icp.setMaxCorrespondenceDistance(kMaxCorrespondence);
  icp.setMaximumIterations(kIterations);
  icp.setTransformationEpsilon(1e-8);
  typename std::remove_reference_t<decltype(*source)> aligned;
  icp.align(aligned, guess.matrix().cast<float>());
  Transform T;
  T.matrix() = icp.getFinalTransformation().template cast<double>();
  return T;
}

Transform point_to_point(const Points& target, const Points& source, const Transform& guess, int /*threads*/) {
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  return run(icp, downsampled(target), downsampled(source), guess);
}

Transform point_to_plane(const Points& target, const Points& source, const Transform& guess, int /*threads*/) {
  pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> icp;
  return run(icp, with_normals(target), with_normals(source), guess);
}

Transform generalised(const Points& target, const Points& source, const Transform& guess, int /*threads*/) {
  pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  return run(icp, downsampled(target), downsampled(source), guess);
}

}  // namespace

std::vector<Method> pcl_methods() {
  return {{"PCL ICP", point_to_point}, {"PCL ICP, planes", point_to_plane}, {"PCL GICP", generalised}};
}

}  // namespace concord::bench
