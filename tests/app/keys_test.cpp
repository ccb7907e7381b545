// kerf keys, and the files of docs/ that it makes.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace kerf::keys_test {

namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code = -1;
  std::string out;  // and what went to stderr
};

Outcome kerf_keys(const std::string& arguments) {
  Outcome o;
  FILE* pipe = popen((std::string(KERF_PROGRAM) + " keys " + arguments + " 2>&1").c_str(), "r");
  char buffer[4096];
  for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) o.out.append(buffer, n);
  o.code = WEXITSTATUS(pclose(pipe));
  return o;
}

std::string read_all(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

const fs::path docs = fs::path(KERF_CASES) / ".." / "docs";

TEST(KeysCommand, PrintsAllOneOrSaysWhatWasMeant) {
  EXPECT_NE(kerf_keys("").out.find("[mesh]  The mesh of triangles."), std::string::npos);
  const Outcome one = kerf_keys("mesh.size");
  EXPECT_EQ(one.code, 0);
  EXPECT_EQ(one.out,
            "mesh.size\n  Target edge length.\n\n  value      number, positive\n  unit       length\n"
            "  default    1/40 of the body's diagonal; of a mesh from a file its mean\n  example    size = 0.1\n");
  const Outcome wrong = kerf_keys("mehs.size");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_EQ(wrong.out, "kerf: unknown key \"mehs.size\"; did you mean \"mesh.size\"?\n");
  EXPECT_EQ(kerf_keys("--completion fish").code, 2);
  EXPECT_EQ(kerf_keys("--write /nowhere").code, 5);
}

TEST(KeysCommand, TheCommittedFilesAreThoseThatItMakes) {
  const fs::path folder = fs::temp_directory_path() / "kerf-keys-test";
  fs::create_directories(folder);
  fs::copy(docs / "case-files", folder / "case-files",
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  EXPECT_EQ(kerf_keys("--write " + folder.string()).code, 0);
  std::vector<fs::path> made = {"kerf.schema.json", "kerf.bash"};
  for (const auto& entry : fs::directory_iterator(docs / "case-files"))
    made.push_back("case-files" / entry.path().filename());
  for (const fs::path& name : made)
    EXPECT_TRUE(read_all(folder / name) == read_all(docs / name))
        << "docs/" << name << " is not what the table of keys says: kerf keys --write docs makes it anew";
  EXPECT_EQ(std::system(("bash -n " + (folder / "kerf.bash").string()).c_str()), 0);
  EXPECT_TRUE(read_all(folder / "kerf.schema.json") == kerf_keys("--schema").out);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace kerf::keys_test
