#include "align_tables.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace concord::bench {
namespace {

constexpr double kFooledMetres = 0.3;
constexpr double kFooledDegrees = 2.0;
constexpr double kNoise = 0.01;  // metres

double processor_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

void ask(const Pair& pair, const AlignMap& target, const AlignMap& source, const std::optional<Transform>& guess,
         int threads, Tally& tally) {
  const double start = processor_ms();
  const Alignment answer = align(target, source, guess, threads);
  tally.add(pair, answer, processor_ms() - start);
}

/// The same pair with the source in another frame: turned by any yaw, tilted by `tilt`.
Pair replaced(const Pair& pair, double tilt, Random& random) {
  const double about = random.uniform(-M_PI, M_PI);
  Transform T_new_old = Transform::Identity();
  T_new_old.translate(Eigen::Vector3d(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-1, 1)));
  T_new_old.rotate(Eigen::AngleAxisd(tilt, Eigen::Vector3d(std::cos(about), std::sin(about), 0.0)));
  T_new_old.rotate(Eigen::AngleAxisd(random.uniform(-M_PI, M_PI), Eigen::Vector3d::UnitZ()));
  Pair out = pair;
  out.source = moved(pair.source, T_new_old);
  out.T_target_source = pair.T_target_source * T_new_old.inverse();
  return out;
}

/// No transform is right: the truth is put where no answer lies.
Pair without_truth(Pair pair) {
  pair.T_target_source.translation().z() = 1e6;
  return pair;
}

/// Two that have nothing in common, with the source laid over the target, middle over middle and turned by a multiple
/// of 90 degrees beside `T_target_source`: where whoever takes one for the other would put it.
Pair laid_over(Pair pair, Random& random) {
  const double quarters = std::floor(random.uniform(0.0, 4.0));
  Transform T = Transform::Identity();
  T.translate(middle_of(pair.target));
  T.rotate(Eigen::AngleAxisd(0.5 * M_PI * quarters, Eigen::Vector3d::UnitZ()) *
           Eigen::Quaterniond(pair.T_target_source.linear()));
  T.translate(Eigen::Vector3d(-middle_of(pair.source)));
  pair.T_target_source = T;
  return pair;
}

Scene with_outliers(const Scene& scene, double share, Random& random) {
  Eigen::Vector3f low = scene.points.front();
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& p : scene.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Scene out = scene;
  const auto count = static_cast<std::size_t>(share / (1.0 - share) * static_cast<double>(scene.points.size()));
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d u(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
    out.points.push_back(low + u.cast<float>().cwiseProduct(high - low));
  }
  return out;
}

/// One point for each voxel that has any: what is left of a cloud at its resolution.
Scene thinned(const Scene& scene) {
  Scene out = scene;
  out.points.clear();
  CellTable seen;
  for (const Eigen::Vector3f& p : scene.points) {
    const auto before = seen.cells().size();
    seen.insert(voxel_of(p.cast<double>(), scene.resolution));
    if (seen.cells().size() > before) out.points.push_back(p);
  }
  return out;
}

Scene without_ceiling(const Scene& scene) {
  Scene out = scene;
  std::vector<float> heights;
  for (const Eigen::Vector3f& p : scene.points) heights.push_back(p.z());
  std::nth_element(heights.begin(), heights.begin() + heights.size() / 100, heights.end());
  const float floor = heights[heights.size() / 100];
  std::erase_if(out.points, [&](const Eigen::Vector3f& p) { return p.z() > floor + 2.0F; });
  return out;
}

/// A shelf of 0.8 x 0.4 x 1.6 m on the floor, at `p`.
void add_shelf(Scene& scene, const Eigen::Vector3d& p) {
  const double step = 0.5 * scene.resolution;
  for (double z = 0.0; z <= 1.6; z += step) {
    for (double s = 0.0; s <= 1.0; s += step) {
      for (const Eigen::Vector2d& at : {Eigen::Vector2d(0.8 * s, 0.0), Eigen::Vector2d(0.8 * s, 0.4),
                                        Eigen::Vector2d(0.0, 0.4 * s), Eigen::Vector2d(0.8, 0.4 * s)}) {
        scene.points.push_back((p + Eigen::Vector3d(at.x(), at.y(), z)).cast<float>());
      }
    }
  }
}

/// A part of a room as the first, of another (or of its mirror image) as the second, walls along walls.
Pair of_two_rooms(const Scene& first, const Scene& second, Random& random) {
  const Pair a = cut_in_two(first, random.uniform(0.3, 1.0), kNoise, random);
  const Pair b = cut_in_two(second, random.uniform(0.3, 1.0), kNoise, random);
  return laid_over({"", a.target, b.source, b.T_target_source, 0.15, 0.0}, random);
}

/// Walls of a corridor along x, from `begin` to `end` metres, 2 x 2.5 m, with a door frame every `period` metres.
Scene corridor(double begin, double end, double period, Random& random) {
  Scene out{"corridor", 0.05, {}, {}};
  const auto add = [&](double x, double y, double z) {
    out.points.push_back(
        Eigen::Vector3d(x + kNoise * random.normal(), y + kNoise * random.normal(), z + kNoise * random.normal())
            .cast<float>());
  };
  for (double x = begin; x < end; x += 0.025) {
    const bool is_frame = std::fmod(x + 1000.0 * period, period) < 0.1;
    for (double u = 0.0; u < 2.5; u += 0.025) {
      add(x, is_frame ? 0.05 : 0.0, u);
      add(x, is_frame ? 1.95 : 2.0, u);
      if (u < 2.0) add(x, u, 0.0);
      if (u < 2.0) add(x, u, 2.5);
    }
  }
  return out;
}

}  // namespace

void Tally::add(const Pair& pair, const Alignment& answer, double spent_ms) {
  const Miss miss = miss_of(pair, answer.T_target_source);
  const bool is_right = miss.metres <= pair.gate && miss.degrees <= 1.0;
  ++asked;
  found += is_right;
  accepted += answer.accepted();
  accepted_right += is_right && answer.accepted();
  fooled += answer.accepted() && (miss.metres > kFooledMetres || miss.degrees > kFooledDegrees);
  ms.push_back(spent_ms);
  ++reasons[name(answer.reason)];
}

Table success_on_pairs(const std::vector<Pair>& pairs, const Amount& amount) {
  Table out;
  Random random(1);
  for (const Pair& pair : pairs) {
    const AlignMap target = prepared(pair.target, amount.threads);
    const AlignMap source = prepared(pair.source, amount.threads);
    for (int i = 0; i < amount.guesses; ++i) {
      ask(pair, target, source, rough_guess(pair, random), amount.threads, out[pair.name + ", guess"]);
    }
    for (int i = 0; i < amount.placements; ++i) {
      const Pair anew = replaced(pair, 0.0, random);
      ask(anew, target, prepared(anew.source, amount.threads), {}, amount.threads, out[pair.name + ", no guess"]);
      const Pair tilted = replaced(pair, 3.0 * M_PI / 180.0, random);
      ask(tilted, target, prepared(tilted.source, amount.threads), {}, amount.threads,
          out[pair.name + ", no guess, gravity off by 3 degrees"]);
    }
  }
  return out;
}

Table success_on_rooms(const std::vector<Scene>& rooms, const Amount& amount) {
  Table out;
  Random random(2);
  for (const Scene& room : rooms) {
    for (int i = 0; i < amount.guesses; ++i) {
      const Pair pair = cut_in_two(room, random.uniform(0.3, 0.7), kNoise, random);
      const std::string key = room.name + (pair.overlap > 0.4 ? ", overlap 40 to 70 %" : ", overlap 30 to 40 %");
      const AlignMap target = prepared(pair.target, amount.threads);
      const AlignMap source = prepared(pair.source, amount.threads);
      ask(pair, target, source, rough_guess(pair, random), amount.threads, out[key + ", guess"]);
      ask(pair, target, source, {}, amount.threads, out[key + ", no guess"]);
    }
  }
  return out;
}

Table success_disturbed(const std::vector<Scene>& rooms, const Amount& amount) {
  Table out;
  Random random(3);
  for (const Scene& room : rooms) {
    for (int i = 0; i < std::max(1, amount.guesses / 5); ++i) {
      const auto try_one = [&](const std::string& what, const Pair& pair) {
        const AlignMap target = prepared(pair.target, amount.threads);
        const AlignMap source = prepared(pair.source, amount.threads);
        ask(pair, target, source, rough_guess(pair, random), amount.threads, out[what + ", guess"]);
        ask(pair, target, source, {}, amount.threads, out[what + ", no guess"]);
      };
      const double overlap = random.uniform(0.5, 0.7);
      for (const double sigma : {0.02, 0.03}) {
        try_one("noise of " + std::to_string(static_cast<int>(100.0 * sigma)) + " cm",
                cut_in_two(room, overlap, sigma, random));
      }
      Pair outliers = cut_in_two(room, overlap, kNoise, random);
      outliers.source = with_outliers(thinned(outliers.source), 0.3, random);
      try_one("30 % outliers in one", outliers);
      outliers.target = with_outliers(thinned(outliers.target), 0.3, random);
      try_one("30 % outliers in both", outliers);
      Pair open = cut_in_two(room, overlap, kNoise, random);
      open.source = without_ceiling(open.source);
      try_one("no ceiling in one", open);
      Pair shelf = cut_in_two(room, overlap, kNoise, random);
      add_shelf(shelf.target, {random.uniform(-0.5, 0.0), random.uniform(-0.5, 0.5), 0.05});
      Scene& source = shelf.source;
      Scene moved_shelf{"", source.resolution, {}, {}};
      add_shelf(moved_shelf, {random.uniform(-0.5, 0.0) + 0.3, random.uniform(-0.5, 0.5) + 0.3, 0.05});
      const Scene placed = moved(moved_shelf, shelf.T_target_source.inverse());
      source.points.insert(source.points.end(), placed.points.begin(), placed.points.end());
      try_one("a moved shelf", shelf);
    }
  }
  return out;
}

Table never_fooled(const std::vector<Scene>& rooms, const std::vector<Pair>& pairs, int requests, int threads) {
  Table out;
  Random random(4);
  int asked = 0;
  const auto try_one = [&](const std::string& what, const Pair& guessed, const Pair& judged) {
    const AlignMap target = prepared(guessed.target, threads);
    const AlignMap source = prepared(guessed.source, threads);
    ask(judged, target, source, {}, threads, out[what + ", no guess"]);
    ask(judged, target, source, rough_guess(guessed, random), threads, out[what + ", guess"]);
    asked += 2;
  };
  const auto try_unrelated = [&](const std::string& what, const Pair& pair) {
    try_one(what, pair, without_truth(pair));
  };
  for (std::size_t i = 0; asked < requests; ++i) {
    if (!rooms.empty()) {
      const Scene& room = rooms[i % rooms.size()];
      try_unrelated("wrong room", of_two_rooms(room, rooms[(i + 1 + i / 3 % 2) % rooms.size()], random));
      try_unrelated("mirrored room", of_two_rooms(room, mirrored(room), random));
      const Pair ends = cut_in_two(room, 0.0, kNoise, random);
      try_one("two ends of a room", ends, ends);
    }
    Pair halls{"", corridor(0.0, 12.0, 1e9, random), corridor(random.uniform(2.0, 6.0), 16.0, 1e9, random), {}, 0.15,
               0.6};
    halls.T_target_source = Transform::Identity();
    try_one("plain corridor", halls, halls);
    const double period = random.uniform(1.5, 3.0);
    halls.target = corridor(0.0, 12.0, period, random);
    halls.source = corridor(random.uniform(2.0, 6.0), 16.0, period, random);
    try_one("corridor with door frames", halls, halls);
    if (i % 10 == 0) {
      for (std::size_t p = 0; p + 1 < pairs.size(); ++p) {
        Pair wrong = pairs[p];
        wrong.source = pairs[p + 1].source;
        if (pairs[p].name.substr(0, 4) == pairs[p + 1].name.substr(0, 4)) continue;
        try_unrelated("wrong building", laid_over(wrong, random));
      }
    }
  }
  return out;
}

}  // namespace concord::bench
