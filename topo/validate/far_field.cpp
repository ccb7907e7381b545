// What changes in balls do outside them, for all radii of all balls at once [theory: V.6]. A column is one radius of
// one ball: the change on the balls and on the contact rows, extended to the skeleton of the whole by one backward
// substitution of many columns, then to the interiors triangle by triangle. Each term gets
//   int_outside j'(z) w  exactly, by the derivative, and  j(z + w) - j(z) - j'(z) w  at the centroids of triangles,
// which is right where w is small and smooth; within 2.5 radii of the ball the plain difference by a rule for quintics
// takes the place of both. Sums leave out the triangles of the ball itself. docs/theory/validation.md, section "The
// difference problem".

#include "topo/validate/far_field.hpp"

#include "base/parallel.hpp"
#include "topo/functional/edge_crack_norm.hpp"

namespace kerf {

namespace {

// A change: one radius of one ball.
struct Column {
  ChangedBall* of;
  Index first, end;    // triangles of its ball
  Eigen::Index begin;  // of its ball's boundary among the kept rows
};
// A ball, and its columns.
struct Disc {
  Vec2 center;
  double radius;
  Eigen::Index at, count;
};

// Numbers all radii of all balls as columns.
class Outside {
 public:
  Outside(const BallsInBody& in, const BodyOperator& body, std::vector<std::vector<ChangedBall>>& changed)
      : in_(in), m_(*in.a.model), o_(body.operators()) {
    for (std::size_t b = 0; b < changed.size(); ++b) add_ball(b, changed[b]);
    count_ = static_cast<Eigen::Index>(columns_.size());
    terms_ = static_cast<Eigen::Index>(in.j.terms.size());
  }

  FarField solve() {
    FarField far;
    if (columns_.empty()) return far;
    far.rows = skeleton();
    for (const Term& term : in_.j.terms)
      far.derivative.push_back(term.energy || term.measured ? Sensitivity{} : derivative(term, m_, *in_.a.state));
    share_out(densities(far));
    return far;
  }

 private:
  // Center and radius by the box of the ball's contour.
  void add_ball(std::size_t b, std::vector<ChangedBall>& radii) {
    Vec2 low = Vec2::Constant(infinity), high = -low;
    for (const Index e : in_.filled.contour[b][0])
      for (const Index v : m_.mesh.edges[e])
        low = low.cwiseMin(m_.mesh.points[v]), high = high.cwiseMax(m_.mesh.points[v]);
    balls_.push_back({0.5 * (low + high), 0.5 * (high - low).maxCoeff(), static_cast<Eigen::Index>(columns_.size()),
                      static_cast<Eigen::Index>(radii.size())});
    for (std::size_t k = 0; k < radii.size(); ++k) {
      radii[k].column = static_cast<Eigen::Index>(columns_.size());
      columns_.push_back({&radii[k], in_.filled.first_triangle[b], in_.filled.first_triangle[b + 1],
                          static_cast<Eigen::Index>(b) * radii[k].changes[0].ball.size()});
    }
  }

  // From what is known on the balls and on the rows in contact.
  Eigen::MatrixXd skeleton() const {
    const Inner& inner = *o_.inner;
    Eigen::MatrixXd tail(inner.ordering.interface_rows + inner.ordering.contact_rows, count_),
        y = Eigen::MatrixXd::Zero(inner.ordering.size, count_);
    for (Eigen::Index k = 0; k < count_; ++k) {
      const Column& c = columns_[static_cast<std::size_t>(k)];
      const Eigen::VectorXd& rest = c.of->others;
      const BallChange& change = c.of->changes[0];
      tail.col(k) << rest.head(c.begin), change.ball, rest.tail(rest.size() - c.begin), change.contact;
    }
    y.bottomRows(tail.rows()) = inner.factor->interface_factor().triangularView<Eigen::Lower>().transpose() * tail;
    return inner.factor->backward(y);
  }

  // Row i * columns + k: change k of the domain integral of term i; a column per triangle.
  // terms x columns numbers per triangle, summed afterwards in the order of the triangles: the same for any number of
  // threads.
  Eigen::MatrixXd densities(const FarField& far) {
    const Index triangles = static_cast<Index>(m_.mesh.triangles.size());
    std::vector<std::unique_ptr<EdgeCrackRest>> cracks(in_.j.terms.size());
    for (std::size_t i = 0; i < cracks.size(); ++i)
      if (const auto& norm = in_.j.terms[i].edge_cracks)
        cracks[i] = std::make_unique<EdgeCrackRest>(*norm, m_, *in_.a.state, count_);
    Eigen::MatrixXd part = Eigen::MatrixXd::Zero(terms_ * count_, triangles);
    parallel_for(triangles, m_.threads, [&](Index from, Index to) {
      Eigen::MatrixXd traces(skeleton_count(m_.element), count_);
      for (Index t = from; t < to; ++t) {
        const Eigen::MatrixXd w = changes_in(t, far, traces);
        for (Eigen::Index i = 0; i < terms_; ++i) {
          const Sensitivity& d = far.derivative[static_cast<std::size_t>(i)];
          if (d.interior.size() == 0) continue;
          if (EdgeCrackRest* rest = cracks[static_cast<std::size_t>(i)].get()) rest->add(t, w);
          auto sum = part.col(t).segment(i * count_, count_);
          sum = w.transpose() * d.interior.col(t);
          if (const Term& term = in_.j.terms[static_cast<std::size_t>(i)]; !term.work) add_rest(term, t, w, sum);
        }
      }
    });
    rest_.setZero(terms_, count_);
    for (Eigen::Index i = 0; i < terms_; ++i)
      if (const auto& rest = cracks[static_cast<std::size_t>(i)]) rest_.row(i) = rest->rest().transpose();
    return part;
  }

  // Interior coefficients, a column per change.
  Eigen::MatrixXd changes_in(Index t, const FarField& far, Eigen::MatrixXd& traces) const {
    const Inner& inner = *o_.inner;
    const Seen view = seen(o_.mesh, inner.skeleton, t);
    traces.setZero();
    for (int i = 0; i < view.count; ++i)
      for (const Index unknown : {view.base[i], view.jump[i]})
        if (unknown != none && inner.ordering.row[unknown] != none)
          traces.row(i) += far.rows.row(inner.ordering.row[unknown]);
    return interiors(inner.kernel, triangle(o_, t), material_of(o_.mesh, o_.scene, t), traces);
  }

  // What the derivative leaves; close to a ball the change is not small.
  void add_rest(const Term& term, Index t, const Eigen::MatrixXd& w, Eigen::Ref<Eigen::VectorXd> sum) const {
    if (!term.density) return;
    constexpr double close = 2.5;
    sum += second_order(term, m_, *in_.a.state, t, w);
    for (const Disc& b : balls_)
      if (b.count > 0 && (centroid(m_.mesh, t) - b.center).norm() < close * b.radius)
        sum.segment(b.at, b.count) = changes_on(term, m_, *in_.a.state, t, w.middleCols(b.at, b.count));
  }

  // Each change without the triangles of its own ball.
  void share_out(const Eigen::MatrixXd& part) const {
    for (Eigen::Index k = 0; k < count_; ++k) {
      const Column& c = columns_[static_cast<std::size_t>(k)];
      c.of->far = rest_.col(k);
      for (Index t = 0; t < static_cast<Index>(part.cols()); ++t)
        if (t < c.first || t >= c.end)
          for (Eigen::Index i = 0; i < terms_; ++i) c.of->far[i] += part(i * count_ + k, t);
    }
  }

  const BallsInBody& in_;
  const Model &m_, &o_;  // of the analysis; with the factor
  std::vector<Column> columns_;
  std::vector<Disc> balls_;
  Eigen::Index count_ = 0, terms_ = 0;
  Eigen::MatrixXd rest_;  // of edge cracks, a row per term and a column per change
};

}  // namespace

FarField far_field(const BallsInBody& in, const BodyOperator& body, std::vector<std::vector<ChangedBall>>& changed) {
  return Outside(in, body, changed).solve();
}

}  // namespace kerf
