// Rates of the new element beside those of afw and bdms: a field with a known stress, on meshes of half the size.
#include <kerf/kerf.hpp>

#include <cmath>
#include <complex>
#include <cstdio>

using namespace kerf;

// The solution of plane strain with Kolosov's functions exp(z) and 0: in equilibrium without a body force, and it
// rotates.
const Material rubber = plane_strain(1, 0.3);

Vec2 displacement(const Vec2& x, const Vec2&) {
  const std::complex<double> z(x.x(), x.y()), w = (3 - 4 * 0.3) * std::exp(z) - z * std::conj(std::exp(z));
  return Vec2(w.real(), w.imag()) / (2 * rubber.mu);
}
/// s11, s12, s21, s22.
Eigen::Vector4d stress(const Vec2& x) {
  const std::complex<double> z(x.x(), x.y()), difference = 2.0 * std::conj(z) * std::exp(z);
  const double sum = 4 * std::exp(z).real(), s12 = difference.imag() / 2;
  return {(sum - difference.real()) / 2, s12, s12, (sum + difference.real()) / 2};
}

// Relative, in L2, by the values at the middles of the edges of each triangle.
double error(const Element& e, double size) {
  Shape shape;
  shape.labels = {"rim"};
  shape.outline.sides = {{{0, 0}, 0}, {{1, 0}, 0}, {{1, 1}, 0}, {{0, 1}, 0}};
  Scene scene;
  scene.material = rubber;
  scene.supports = {{.label = 0, .value = displacement}};
  const Model model = prepare(triangulate(shape, {.size = size}), e, scene, 1);
  const State state = solve(model);
  double off = 0, all = 0;
  for (Index t = 0; t < static_cast<Index>(model.mesh.triangles.size()); ++t) {
    Points middles(2, 3);
    for (int i = 0; i < 3; ++i)
      middles.col(i) =
          (model.mesh.points[model.mesh.triangles[t][i]] + model.mesh.points[model.mesh.triangles[t][(i + 1) % 3]]) / 2;
    const Eigen::Matrix4Xd found = evaluate(model, state, t, middles).stress;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector4d exact = stress(middles.col(i));
      off += area(model.mesh, t) * (found.col(i) - exact).squaredNorm();
      all += area(model.mesh, t) * exact.squaredNorm();
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
