#include "optimize/level_set/starts.hpp"

#include "optimize/level_set/start.hpp"

#include <cstdlib>
#include <fstream>

namespace kerf {

LevelSetStart given_start(const Ground& g) {
  const BackgroundMesh& b = g.background;
  LevelSetStart start{"the full body",
                      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(b.mesh.points.size()), -1e3 * g.size), true};
  if (!g.r.level_set.start) return start;
  start.name = "the holes given";
  Vec2 low = b.mesh.points[0], high = low;
  for (const Vec2& x : b.mesh.points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  cut_discs(b, start_discs(*g.r.level_set.start, low, high), start.phi);
  return start;
}

LevelSetStart best_start(const Ground& g) {
  if (const char* file = std::getenv("KERF_START")) {
    std::ifstream in(file);
    std::string hash;
    int ny, nx;
    double x0, y0, h;
    in >> hash >> ny >> nx >> x0 >> y0 >> h;
    std::vector<double> v(static_cast<std::size_t>(nx * ny));
    for (double& a : v) in >> a;
    LevelSetStart s{"density", Eigen::VectorXd(static_cast<Eigen::Index>(g.background.mesh.points.size())), false};
    for (std::size_t k = 0; k < g.background.mesh.points.size(); ++k) {
      const Vec2 q = (g.background.mesh.points[k] - Vec2(x0, y0)) / h;
      const int i = std::clamp(int(q.x()), 0, nx - 2), j = std::clamp(int(q.y()), 0, ny - 2);
      const double a = q.x() - i, c = q.y() - j;
      const auto at = [&](int ii, int jj) { return v[static_cast<std::size_t>(jj * nx + ii)]; };
      s.phi[Eigen::Index(k)] = (1 - a) * (1 - c) * at(i, j) + a * (1 - c) * at(i + 1, j) + (1 - a) * c * at(i, j + 1) +
                               a * c * at(i + 1, j + 1);
    }
    s.phi = with_area(g.background, s.phi, g.target);
    return s;
  }
  return given_start(g);
}

}  // namespace kerf
