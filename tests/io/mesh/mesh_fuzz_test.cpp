// Damaged meshes: every one is read or refused, none crashes or takes long. KERF_FUZZ says how many (default 2000).

#include "tests/io/mesh/meshes.hpp"

#include <cstdlib>
#include <ctime>
#include <random>

namespace kerf::mesh_fuzz_test {
namespace {

using namespace meshes;

/// Bytes flipped, cut out, doubled, or numbers replaced by others.
std::string damaged(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::size_t(random() % std::max<std::size_t>(n, 1)); };
  const int times = 1 + int(below(4));
  for (int k = 0; k < times; ++k) {
    const std::size_t at = below(bytes.size());
    switch (below(7)) {
      case 0:
        if (!bytes.empty()) bytes[at] = char(random());
        break;
      case 1:
        if (!bytes.empty()) bytes[at] = char(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes.erase(at, below(40));
        break;
      case 3:
        bytes.insert(at, bytes.substr(below(bytes.size()), below(40)));
        break;
      case 4:
        bytes.resize(at);
        break;
      case 5:
        if (!bytes.empty()) bytes[at] = char('0' + below(10));
        break;
      default: {  // a number of the text by one that is odd
        static const char* const odd[] = {"-1", "0", "99999999999999999999", "2147483648", "1e308", "-0.5", "nan", "1"};
        const std::size_t from = bytes.find_first_of(" \n", at);
        if (from == std::string::npos) break;
        const std::size_t to = bytes.find_first_of(" \n", from + 1);
        if (to != std::string::npos) bytes.replace(from + 1, to - from - 1, odd[below(8)]);
      }
    }
  }
  return bytes;
}

TEST(MeshFuzz, DamagedMeshesAreReadOrRefused) {
  const char* asked = std::getenv("KERF_FUZZ");
  const int count = asked ? std::atoi(asked) : 2000;
  std::mt19937 random(12345);
  std::vector<std::string> seeds{Square().text()};
  for (const std::string& name : committed) seeds.push_back(text(file(name)));
  int read = 0;
  double slowest = 0;
  for (int k = 0; k < count; ++k) {
    const std::string bytes = damaged(seeds[std::size_t(k) % seeds.size()], random);
    const std::clock_t start = std::clock();  // of this process: others may keep the machine busy
    try {
      const MeshFile body = parse_mesh("a.msh", bytes, {.materials = {"stiff"}});
      ++read;
      // What was read is a body like any other.
      ASSERT_FALSE(body.mesh.triangles.empty());
      ASSERT_EQ(body.mesh.cracks.size(), body.shape.cracks.size());
      find_problem(body.shape);
    } catch (const Error& e) {
      ASSERT_TRUE(e.fault == Fault::Geometry) << e.what();
      ASSERT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
    slowest = std::max(slowest, double(std::clock() - start) / CLOCKS_PER_SEC);
  }
  EXPECT_GT(read, count / 50);
  EXPECT_LT(read, count);
  EXPECT_LT(slowest, 5);
}

}  // namespace
}  // namespace kerf::mesh_fuzz_test
