// What a case of a stranger names is looked at before anything of it is opened: with --untrusted a file must lie in the
// folder of the case (no .., no absolute path, no link on the way), be regular, and be no script of gmsh.

#include "io/untrusted.hpp"

#include "io/case/fields.hpp"
#include "io/case/named_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace kerf {

namespace {

namespace fs = std::filesystem;

class OwnFiles {
 public:
  explicit OwnFiles(fs::path root) : root_(std::move(root)) {}

  /// `folder`: of the document, from the root.
  void look_at(Node& document, const fs::path& folder) {
    constexpr int deepest = 8;  // designs that name designs
    if (++depth_ > deepest) fail(document.position, "designs name designs too deeply for --untrusted");
    for_each_file(document, [&](Node& name) { look_at(name, name.text, folder); });
    for (const Entry& table : document.entries)
      if (table.key == "solver")
        for (const Entry& entry : table.value.entries)
          if (entry.key == "petsc") refuse(entry.value, "solver.petsc is not for cases of strangers");
    --depth_;
  }

 private:
  void look_at(const Node& name, const std::string& text, const fs::path& folder) {
    const fs::path given = text;
    fs::path from_root = folder;
    for (const fs::path& part : given) {
      if (part == ".." || part.is_absolute()) refuse(name, "\"" + text + "\" leads out of the folder of the case");
      from_root /= part;
      std::error_code none;
      if (fs::is_symlink(fs::symlink_status(root_ / from_root, none)))
        refuse(name, "\"" + text + "\" is a link, or beneath one");
    }
    const fs::path file = root_ / from_root;
    std::error_code none;
    if (fs::exists(file, none) && !fs::is_regular_file(file, none)) refuse(name, "\"" + text + "\" is no regular file");
    std::string ending = file.extension().string();
    std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (ending == ".geo" || ending.starts_with(".geo_")) refuse(name, "\"" + text + "\" is a script of gmsh");
    if (ending != ".toml" || !fs::exists(file, none)) return;
    Node design = read_document(file);
    look_at(design, from_root.parent_path());
  }
  [[noreturn]] static void refuse(const Node& at, const std::string& what) {
    fail(at.position, what + "; leave --untrusted out if you know the case");
  }

  const fs::path root_;
  int depth_ = 0;
};

}  // namespace

void require_own_files(const fs::path& case_file, std::span<const std::string> overrides) {
  std::error_code none;
  if (fs::is_symlink(fs::symlink_status(case_file, none)))
    throw Error(Fault::Usage, fmt::format("{} is a link; give the file itself, or leave --untrusted out if you know it",
                                          case_file.string()));
  Node document = read_document(case_file);
  for (const std::string& assignment : overrides) override_value(document, assignment);
  OwnFiles(case_file.parent_path()).look_at(document, {});
}

}  // namespace kerf
