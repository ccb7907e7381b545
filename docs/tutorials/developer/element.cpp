// Rates of the new element beside those of afw and bdms: a field with a known stress, on meshes of half the size.
#include <kerf/kerf.hpp>

#include <cmath>
#include <cstdio>

using namespace kerf;

// u is the gradient of exp(x) cos(y): without divergence, in equilibrium without a body force.
Vec2 displacement(const Vec2& x, const Vec2&) {
  return std::exp(x.x()) * Vec2(std::cos(x.y()), -std::sin(x.y()));
}
Mat2 stress(const Material& m, const Vec2& x) {
  const double a = 2 * m.mu * std::exp(x.x()) * std::cos(x.y()), b = -2 * m.mu * std::exp(x.x()) * std::sin(x.y());
  return (Mat2() << a, b, b, -a).finished();
}

// Relative, in L2, by the values at the middles of the edges of each triangle.
double error(const Element& e, double size) {
  Shape shape;
  shape.labels = {"rim"};
  shape.outline.sides = {{{0, 0}, 0}, {{1, 0}, 0}, {{1, 1}, 0}, {{0, 1}, 0}};
  Scene scene;
  scene.material = plane_strain(1, 0.3);
  scene.supports = {{.label = 0, .value = displacement}};
  const Model model = prepare(triangulate(shape, {.size = size}), e, scene, 1);
  const State state = solve(model);
  double off = 0, all = 0;
  for (Index t = 0; t < static_cast<Index>(model.mesh.triangles.size()); ++t) {
    Points middles(2, 3);
    for (int i = 0; i < 3; ++i)
      middles.col(i) =
          (model.mesh.points[model.mesh.triangles[t][i]] + model.mesh.points[model.mesh.triangles[t][(i + 1) % 3]]) / 2;
    const Eigen::Matrix4Xd found = evaluate(model, state, t, middles).stress;  // s11, s12, s21, s22
    for (int i = 0; i < 3; ++i) {
      const Mat2 exact = stress(scene.material, middles.col(i));
      const Eigen::Vector4d numbers(exact(0, 0), exact(0, 1), exact(1, 0), exact(1, 1));
      off += area(model.mesh, t) * (found.col(i) - numbers).squaredNorm();
      all += area(model.mesh, t) * numbers.squaredNorm();
    }
  }
  return std::sqrt(off / all);
}

int main() try {
  bool as_expected = true;
  for (const Element& e : {element("afw"), element("afw-b"), element("bdms")}) {
    const double coarse = error(e, 0.1), fine = error(e, 0.05), rate = std::log2(coarse / fine);
    std::printf("%-6.*s %8.2e %8.2e rate %.2f\n", int(e.name.size()), e.name.data(), coarse, fine, rate);
    as_expected &= rate > e.order - 0.3;
  }
  return as_expected ? 0 : 1;
} catch (const kerf::Error& e) {
  return std::fprintf(stderr, "%s\n", e.what()), 1;
}
