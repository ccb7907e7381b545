// I = int w(D) max(K, 0)^p ds along parts of the boundary, with K of a crack of length a that begins there, normal to
// it [theory: M.8]: with the unit tangent t, the body to its left, n = t turned by +90 degrees and the curvature k,
//   K = sqrt(pi a) sum_k (c_k + k a h_k) N_k,   N_k = t . s(x + d_k n) t,
// at four Gauss points per edge. Stresses are the element's own, so that the derivative by the state is exact. D is the
// distance to the next corner or other place where the stress may be infinite. When vertices move by theta, an edge
// from A to B of length l turns by alpha = n.(theta_B - theta_A)/l and
//   dN = alpha [n.(s + s')t - d grad N.t] + grad N.(dx - theta(y)) + t.(s G')t - N div theta,   y = x + d n,
//   dk = 2 d(turns)/L - k dL/L,   L = before + 2 l + behind, the turns those of the edges behind and before:
// grad N within the triangle that y lies in. What a crack meets besides (other cracks, borders of materials) is not
// seen.

#include "topo/functional/edge_crack_norm.hpp"

#include "geometry/boundary_walk.hpp"
#include "kerf/recover.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"
#include "topo/shape/moving.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double far_from_corners = 5, near_corners = 2.5;  // lengths

/// 0 up to near_corners, 1 from far_from_corners on; and its slope per length.
std::array<double, 2> fade(double lengths) {
  const double width = far_from_corners - near_corners, t = std::clamp((lengths - near_corners) / width, 0., 1.);
  return {t * t * (3 - 2 * t), 6 * t * (1 - t) / width};
}

/// Vertices that cracks keep away from.
std::vector<Index> corners_of(const Model& model, const std::vector<BoundaryRun>& runs) {
  std::vector<Index> all = singular_vertices(model);
  for (const BoundaryRun& run : runs)
    if (run.before == none || std::abs(run.turn_before) > corner_turn) all.push_back(run.from);
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  return all;
}

/// A crack that counts.
struct CountedCrack {
  const BoundaryRun* run = nullptr;
  double share = 0;   // where on the run
  double weight = 0;  // of the Gauss point
  RunPoint at;
  Index corner = none;  // the next one, at this distance
  double distance = infinity;
  std::array<Index, 3> triangle{};  // per depth
  std::array<double, 3> stress{};   // N
  double K = 0;
};

class CountedCracks {
 public:
  CountedCracks(const EdgeCrackNorm& norm, const Model& model, const Field& state)
      : norm_(norm),
        m_(model),
        s_(state),
        runs_(boundary_runs(model.mesh)),
        corners_(corners_of(model, runs_)),
        locator_(make_locator(model.mesh)) {
    constexpr int points = 4;
    const EdgeRule rule = gauss(points);
    for (const BoundaryRun& run : runs_) {
      if (std::ranges::find(norm.labels, m_.mesh.label[run.edge]) == norm.labels.end()) continue;
      for (Eigen::Index q = 0; q < rule.s.size(); ++q) add(run, rule.s[q], rule.w[q]);
    }
  }

  const std::vector<CountedCrack>& all() const {
    return all_;
  }
  const std::vector<BoundaryRun>& runs() const {
    return runs_;
  }
  Vec2 place(const CountedCrack& crack, std::size_t k) const {
    return crack.at.x + norm_.depth[k] * norm_.length * crack.at.inward;
  }
  /// dK/dN_k.
  double factor(const CountedCrack& crack, std::size_t k) const {
    return root() * (norm_.weight[k] + crack.at.curvature * norm_.length * norm_.bend[k]);
  }
  double root() const {
    return std::sqrt(pi * norm_.length);
  }
  std::array<double, 2> faded(const CountedCrack& crack) const {
    return fade(crack.distance / norm_.length);
  }
  /// Of the integral.
  double share(const CountedCrack& crack) const {
    return crack.weight * crack.at.speed * faded(crack)[0];
  }
  /// dN_k by the interior coefficients of its triangle.
  Eigen::VectorXd row(const CountedCrack& crack, std::size_t k) const {
    const Vec2& t = crack.at.tangent;
    Fields by{Eigen::Matrix4Xd::Zero(4, 1), Points::Zero(2, 1), Eigen::RowVectorXd::Zero(1)};
    by.stress.col(0) << t.x() * t.x(), t.x() * t.y(), t.x() * t.y(), t.y() * t.y();
    return weigh(m_, crack.triangle[k], place(crack, k), by);
  }

 private:
  void add(const BoundaryRun& run, double share, double weight) {
    CountedCrack crack{.run = &run, .share = share, .weight = weight, .at = point_on(m_.mesh, runs_, run, share)};
    for (const Index v : corners_)
      if (const double d = (m_.mesh.points[v] - crack.at.x).norm(); d < crack.distance)
        crack.distance = d, crack.corner = v;
    if (faded(crack)[0] == 0) return;
    for (std::size_t k = 0; k < norm_.depth.size(); ++k) {
      const Vec2 x = place(crack, k);
      crack.triangle[k] = norm_.depth[k] == 0 ? run.triangle : locate(m_.mesh, locator_, x);
      if (crack.triangle[k] == none)
        throw Error(Fault::Geometry, fmt::format("a crack of length {:.4g} that begins at ({:.6g}, {:.6g}) leaves the "
                                                 "body through its other side: worst_edge_crack needs a shorter one, "
                                                 "or a thicker body",
                                                 norm_.length, crack.at.x.x(), crack.at.x.y()));
      const Eigen::Vector4d s = evaluate(m_, s_, crack.triangle[k], x).stress.col(0);
      crack.stress[k] = crack.at.tangent.dot(tensor(s) * crack.at.tangent);
      crack.K += factor(crack, k) * crack.stress[k];
    }
    all_.push_back(crack);
  }

  const EdgeCrackNorm& norm_;
  const Model& m_;
  const Field& s_;
  const std::vector<BoundaryRun> runs_;
  const std::vector<Index> corners_;
  const Locator locator_;
  std::vector<CountedCrack> all_;
};

/// max(K, 0)^p, and its derivative.
std::array<double, 2> powers_of(double K, double p) {
  if (!(K > 0)) return {0, 0};
  const double slope = std::pow(K, p - 1);
  return {slope * K, p * slope};
}

/// Derivatives by vertices, of one crack after the other.
class CrackMotion {
 public:
  CrackMotion(const EdgeCrackNorm& norm, const Model& model, const Field& state, Points& gradient)
      : norm_(norm), m_(model), s_(state), cracks_(norm, model, state), gradient_(gradient) {}

  void add_all(double share) {
    for (const CountedCrack& crack : cracks_.all()) {
      const BoundaryRun& run = *crack.run;
      const auto [value, slope] = powers_of(crack.K, norm_.p);
      const auto [fade, fading] = cracks_.faded(crack);
      const double whole = share * crack.weight;
      // The length, and the distance to the corner.
      stretch(run, whole * fade * value);
      if (fading != 0) {
        const Vec2 away = (crack.at.x - m_.mesh.points[crack.corner]) / (crack.distance * norm_.length);
        const Vec2 by = whole * run.length * value * fading * away;
        shift(crack, by);
        gradient_.col(crack.corner) -= by;
      }
      const double by_K = whole * run.length * fade * slope;
      if (by_K == 0) continue;
      double by_curvature = 0;
      for (std::size_t k = 0; k < norm_.depth.size(); ++k) {
        add_stress(crack, k, by_K * cracks_.factor(crack, k));
        by_curvature += by_K * cracks_.root() * norm_.length * norm_.bend[k] * crack.stress[k];
      }
      if (is_bent(run)) bend(crack, by_curvature);
    }
  }

 private:
  /// by . dx
  void shift(const CountedCrack& crack, const Vec2& by) {
    gradient_.col(crack.run->from) += (1 - crack.share) * by;
    gradient_.col(crack.run->to) += crack.share * by;
  }
  Vec2 chord(const BoundaryRun& run) const {
    return (m_.mesh.points[run.to] - m_.mesh.points[run.from]) / run.length;
  }
  /// by . (theta_B - theta_A)
  void pull(const BoundaryRun& run, const Vec2& by) {
    gradient_.col(run.to) += by;
    gradient_.col(run.from) -= by;
  }
  void stretch(const BoundaryRun& run, double by) {
    pull(run, by * chord(run));
  }
  void turn(const BoundaryRun& run, double by) {
    const Vec2 t = chord(run);
    pull(run, by / run.length * Vec2(-t.y(), t.x()));
  }
  void bend(const CountedCrack& crack, double by) {
    const BoundaryRun& run = *crack.run;
    const BoundaryRun &before = cracks_.runs()[static_cast<std::size_t>(run.before)],
                      &behind = cracks_.runs()[static_cast<std::size_t>(run.behind)];
    const double length = before.length + 2 * run.length + behind.length;
    turn(behind, 2 * by / length);
    turn(before, -2 * by / length);
    const double longer = -crack.at.curvature * by / length;
    stretch(before, longer);
    stretch(behind, longer);
    stretch(run, 2 * longer);
  }

  // `by` times dN.
  void add_stress(const CountedCrack& crack, std::size_t k, double by) {
    const Index t = crack.triangle[k];
    const Vec2 y = cracks_.place(crack, k), &along = crack.at.tangent, &n = crack.at.inward;
    const Triangle shape = triangle(m_, t);
    // A polynomial of degree 4 at most: central differences of fourth order are exact.
    const double h = std::sqrt(area(shape)) / 2;
    Points around(2, 9);
    around.col(8) = y;
    const std::array<double, 4> steps{1, -1, 2, -2};
    for (int d = 0; d < 2; ++d)
      for (int i = 0; i < 4; ++i) around.col(4 * d + i) = y + steps[static_cast<std::size_t>(i)] * h * Vec2::Unit(d);
    const Eigen::Matrix4Xd stresses = evaluate(m_, s_, t, around).stress;
    const auto N = [&](Eigen::Index i) { return along.dot(tensor(stresses.col(i)) * along); };
    Vec2 slope;
    for (int d = 0; d < 2; ++d) slope[d] = (8 * (N(4 * d) - N(4 * d + 1)) - (N(4 * d + 2) - N(4 * d + 3))) / (12 * h);
    const Mat2 s = tensor(stresses.col(8));
    turn(*crack.run, by * (n.dot((s + s.transpose()) * along) - norm_.depth[k] * norm_.length * slope.dot(along)));
    shift(crack, by * slope);
    const Mat2 by_gradient = by * (along * (s.transpose() * along).transpose() - N(8) * Mat2::Identity());
    const Eigen::Matrix<double, 2, 3> gradients = barycentric_gradients(shape);
    for (int i = 0; i < 3; ++i) {
      const double coordinate = 1 + gradients.col(i).dot(y - shape.x[i]);
      gradient_.col(m_.mesh.triangles[t][i]) += by_gradient * gradients.col(i) - by * coordinate * slope;
    }
  }

  const EdgeCrackNorm& norm_;
  const Model& m_;
  const Field& s_;
  const CountedCracks cracks_;
  Points& gradient_;
};

}  // namespace

double edge_crack_integral(const EdgeCrackNorm& norm, const Model& model, const Field& state) {
  const CountedCracks cracks(norm, model, state);
  double sum = 0;
  for (const CountedCrack& crack : cracks.all()) sum += cracks.share(crack) * powers_of(crack.K, norm.p)[0];
  return sum;
}

void differentiate_edge_cracks(const EdgeCrackNorm& norm, const Model& model, const Field& state, Sensitivity& d) {
  const CountedCracks cracks(norm, model, state);
  if (d.interior.size() == 0)
    d.interior.setZero(interior_count(model.element), static_cast<Eigen::Index>(model.mesh.triangles.size()));
  for (const CountedCrack& crack : cracks.all()) {
    const double by_K = cracks.share(crack) * powers_of(crack.K, norm.p)[1];
    if (by_K == 0) continue;
    for (std::size_t k = 0; k < norm.depth.size(); ++k)
      d.interior.col(crack.triangle[k]) += by_K * cracks.factor(crack, k) * cracks.row(crack, k);
  }
}

struct EdgeCrackRest::Data {
  const EdgeCrackNorm& norm;
  const CountedCracks cracks;
  std::vector<std::vector<std::array<std::size_t, 2>>> in_triangle;  // cracks and depths
  Eigen::MatrixXd stress;                                            // row 3 i + k: changes of N_k of crack i
};

EdgeCrackRest::EdgeCrackRest(const EdgeCrackNorm& norm, const Model& model, const Field& state, Eigen::Index changes)
    : data_(std::make_unique<Data>(Data{norm, CountedCracks(norm, model, state), {}, {}})) {
  data_->in_triangle.resize(model.mesh.triangles.size());
  const std::vector<CountedCrack>& all = data_->cracks.all();
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 0; k < norm.depth.size(); ++k)
      data_->in_triangle[static_cast<std::size_t>(all[i].triangle[k])].push_back({i, k});
  data_->stress.setZero(static_cast<Eigen::Index>(norm.depth.size() * all.size()), changes);
}

EdgeCrackRest::~EdgeCrackRest() = default;

void EdgeCrackRest::add(Index t, const Eigen::MatrixXd& changes) {
  for (const auto& [i, k] : data_->in_triangle[static_cast<std::size_t>(t)])
    data_->stress.row(static_cast<Eigen::Index>(data_->norm.depth.size() * i + k)) =
        data_->cracks.row(data_->cracks.all()[i], k).transpose() * changes;
}

Eigen::VectorXd EdgeCrackRest::rest() const {
  const auto& [norm, cracks, in_triangle, stress] = *data_;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(stress.cols());
  for (std::size_t i = 0; i < cracks.all().size(); ++i) {
    const CountedCrack& crack = cracks.all()[i];
    const auto [value, slope] = powers_of(crack.K, norm.p);
    for (Eigen::Index c = 0; c < sum.size(); ++c) {
      double change = 0;
      for (std::size_t k = 0; k < norm.depth.size(); ++k)
        change += cracks.factor(crack, k) * stress(static_cast<Eigen::Index>(norm.depth.size() * i + k), c);
      sum[c] += cracks.share(crack) * (powers_of(crack.K + change, norm.p)[0] - value - slope * change);
    }
  }
  return sum;
}

void add_edge_crack_motion(const EdgeCrackNorm& norm, double share, const Model& model, const Field& state,
                           Points& gradient) {
  CrackMotion(norm, model, state, gradient).add_all(share);
}

void require_edge_cracks(const EdgeCrackNorm& norm, const Model& model) {
  const auto refuse = [](const std::string& why) {
    throw Error(Fault::Usage, fmt::format("functional \"worst_edge_crack\" {}", why));
  };
  if (!std::ranges::all_of(all_materials(model.scene), isotropic)) refuse("is known in isotropic materials alone");
  if (&whole_mesh(model) != &model.mesh) refuse("needs the whole body: start one process");
  for (const Support& support : model.scene.supports)
    if (std::ranges::find(norm.labels, support.label) != norm.labels.end())
      refuse("counts cracks where no displacement is prescribed: leave sides with supports out of \"on\"");
}

}  // namespace kerf
