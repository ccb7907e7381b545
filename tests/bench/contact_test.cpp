// `kerf bench contact` as a whole, on tiny bodies.

#include "bench/measure/contact.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace kerf::contact_test {
namespace {

TEST(ContactBenchTest, WritesItsFiles) {
  const auto folder = std::filesystem::temp_directory_path() / "kerf_contact_bench_test";
  std::filesystem::remove_all(folder);
  const ContactBench bench = run_contact_bench({.folder = folder, .quick = true});
  ASSERT_EQ(bench.rows.size(), 2 * contact_case_names().size());
  for (const ContactRow& r : bench.rows) {
    EXPECT_TRUE(r.certified) << r.family << " " << r.friction << " " << r.refused;
    EXPECT_GT(r.unknowns, 0);
    EXPECT_GT(r.ratio(), 0);
  }
  for (const char* name : {"contact.csv", "contact.json", "contact.md"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  EXPECT_NE(summary(bench).find("bending"), std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(ContactBenchTest, StopsWhenAsked) {
  const auto folder = std::filesystem::temp_directory_path() / "kerf_contact_bench_stop_test";
  const ContactBench bench =
      run_contact_bench({.folder = folder, .cases = {"depth"}, .quick = true, .stop_asked = [] { return true; }});
  EXPECT_TRUE(bench.stopped);
  EXPECT_TRUE(bench.rows.empty());
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace kerf::contact_test
