// Finds triangles of equal shape and material, so that one elimination serves all of them (element/shared_shape.hpp;
// [theory: E.18] says what is done about the rounding by which they differ). Two edges of a triangle, from the corner
// on at which the leaving edge is largest in lexicographic order, are rounded to integers in units of 2^-42 of the next
// power of two above the longest component; shapes are equal when these integers and the material are. A hash table
// with open addresses files them, in the order of the triangles, so that the result does not depend on threads. A shape
// is shared only where that many triangles have it as its elimination has columns. docs/theory/elements.md, section
// Slender bodies.

#include "solver/system/congruent.hpp"

#include "base/parallel.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace kerf {

namespace {

/// Two edges from a corner on that is chosen by them, in units far above rounding and far below what strains see; and
/// the material.
struct Key {
  std::array<std::int64_t, 4> edges{};
  int scale = 0;  // the unit is 2^scale
  int turn = 0;
  Index region = none;
  bool shares = false;

  bool operator==(const Key& other) const {  // turns may differ
    return edges == other.edges && scale == other.scale && region == other.region;
  }
  std::size_t hash() const {
    std::uint64_t h = static_cast<std::uint64_t>(region) * 31 + static_cast<std::uint64_t>(scale);
    for (const std::int64_t e : edges) {
      h = (h ^ static_cast<std::uint64_t>(e)) * 0x9e3779b97f4a7c15u;
      h ^= h >> 29;
    }
    return h;
  }
};

// 42 digits leave 11 of the 53 for what rounding made of a translation. Shapes on either side of a rounding boundary
// are taken for different ones: that costs an elimination, not accuracy.
Key key_of(const Triangle& t, Index region) {
  Key key;
  key.shares = can_share(t);
  if (!key.shares) return key;
  constexpr int digits = 42;
  std::array<Vec2, 3> edge;  // edge i leaves vertex i
  double longest = 0;
  for (int i = 0; i < 3; ++i) {
    edge[i] = t.x[(i + 1) % 3] - t.x[i];
    longest = std::max(longest, edge[i].cwiseAbs().maxCoeff());
  }
  std::frexp(longest, &key.scale);
  key.scale -= digits;
  std::array<std::array<std::int64_t, 2>, 3> rounded;
  for (int i = 0; i < 3; ++i)
    for (int d = 0; d < 2; ++d) rounded[i][d] = std::llround(std::ldexp(edge[i][d], -key.scale));
  for (int i = 1; i < 3; ++i)
    if (rounded[i] > rounded[key.turn]) key.turn = i;
  const auto &first = rounded[key.turn], &second = rounded[(key.turn + 1) % 3];
  key.edges = {first[0], first[1], second[0], second[1]};
  key.region = region;
  return key;
}

}  // namespace

// The penalty per triangle is that of its material: a shape with its region fixes it.
CongruentTriangles::CongruentTriangles(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Scene& scene,
                                       const SceneData& data, double penalty, int threads)
    : moments_(scene.body ? displacement_count(k.element) : 0) {
  if (!can_share(k) || !data.strain.empty()) return;
  const Index triangles = static_cast<Index>(mesh.triangles.size());
  // A shape costs as many ways back as it has columns.
  const Index least = skeleton_count(k.element) + moments_ + 1;
  if (triangles < 2 * least) return;
  std::vector<Key> keys(static_cast<std::size_t>(triangles));
  parallel_for(triangles, threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) keys[t] = key_of(triangle(mesh, s, t), region_of(mesh, t));
  });
  // The first triangle of each shape, and how many there are, by hashing with open addresses.
  const std::size_t room = std::bit_ceil(2 * keys.size());
  std::vector<Index> first(room, none), count(keys.size(), 0), alike(keys.size(), none);
  for (Index t = 0; t < triangles; ++t) {
    if (!keys[t].shares) continue;
    std::size_t at = keys[t].hash() & (room - 1);
    while (first[at] != none && !(keys[first[at]] == keys[t])) at = (at + 1) & (room - 1);
    if (first[at] == none) first[at] = t;
    alike[t] = first[at];
    ++count[first[at]];
  }
  std::vector<Index> shape(keys.size(), none), made;
  for (Index t = 0; t < triangles; ++t) {
    if (count[t] < least) continue;
    shape[t] = static_cast<Index>(made.size());
    made.push_back(t);
    shared_ += count[t];
  }
  if (made.empty()) return;
  for (const Index t : made) {
    const Material& material = material_of(mesh, scene, t);
    shapes_.emplace_back(k, turned(triangle(mesh, s, t), keys[t].turn), material, penalty / material.mu, moments_ > 0);
  }
  of_.resize(keys.size());
  for (Index t = 0; t < triangles; ++t)
    if (alike[t] != none) of_[t] = {shape[alike[t]], keys[t].turn};
}

void CongruentTriangles::share(Index t, LocalTriangle& local) const {
  if (of_.empty() || of_[t].shape == none || (local.force.size() > 0 && local.force.size() != moments_)) return;
  local.shared = &shapes_[of_[t].shape];
  local.turn = of_[t].turn;
}

}  // namespace kerf
