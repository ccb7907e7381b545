// A locale that writes 0,5: not one bit of a result may follow it.

#include "tests/faults/faults.hpp"

#include <cstdlib>

namespace kerf::fuzz {
namespace {

namespace fs = std::filesystem;

TEST_F(Faults, ResultsAreTheSameBitsInGermany) {
  // Made here, so that no machine without it skips the test: needs localedef (libc-bin) and its sources (locales).
  const std::string made = (folder / "de_DE.UTF-8").string(),
                    line = "localedef -i de_DE -f UTF-8 '" + made + "' >'" + (folder / "log").string() + "' 2>&1";
  ASSERT_TRUE(std::system(line.c_str()) == 0 || fs::exists(fs::path(made) / "LC_NUMERIC"))
      << "localedef cannot make de_DE.UTF-8; install the package locales";
  const std::string comma = "LOCPATH='" + folder.string() + "' LC_ALL=de_DE.UTF-8 locale decimal_point | grep -qx ,";
  ASSERT_EQ(std::system(comma.c_str()), 0);
  Input plain = input("run", small_case_with_files(), {"--set", "mesh.size=0.4", "--set", "optimize.max_iterations=1"});
  plain.arguments.erase(plain.arguments.begin() + 6, plain.arguments.begin() + 8);  // the log too
  Input german = plain;
  german.environment = {"LOCPATH=" + folder.string(), "LC_ALL=de_DE.UTF-8", "LANG=de_DE.UTF-8",
                        "LC_NUMERIC=de_DE.UTF-8"};
  const Outcome a = run(plain), b = run(german);
  ASSERT_EQ(a.code, 0) << a.error;
  ASSERT_EQ(b.code, 0) << b.error;
  EXPECT_EQ(numbers_of(a), numbers_of(b));
  for (const auto& [name, bytes] : a.files) {
    ASSERT_TRUE(b.files.contains(name)) << name;
    const bool timed = name.ends_with("result.json") || name.ends_with("report.html") || name.ends_with(".step") ||
                       name.ends_with("history.csv") || name.ends_with(".bin");
    EXPECT_TRUE(timed || bytes == b.files.at(name)) << name;
  }
  for (const auto& [name, bytes] : b.files) {
    const bool table = name.ends_with(".csv") || name.ends_with(".step");
    EXPECT_TRUE(!table || bytes.find('.') != std::string::npos) << name;
  }
}

}  // namespace
}  // namespace kerf::fuzz
