// `kerf --version`: what it was built of, the BLAS that is in use, the modules that are found.

#include "app/command/version.hpp"

#include "io/module.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <system_error>

namespace kerf {

namespace {

/// The BLAS is chosen when the program is loaded: by Debian's alternatives, not by the build.
std::string blas_in_use() {
  void* const product = dlsym(RTLD_DEFAULT, "dgemm_");
  Dl_info where{};
  if (!product || dladdr(product, &where) == 0 || !where.dli_fname) return "none";
  std::error_code failed;
  const std::filesystem::path file = std::filesystem::canonical(where.dli_fname, failed);
  std::string text = failed ? where.dli_fname : file.string();
  if (void* const kernels = dlsym(RTLD_DEFAULT, "openblas_get_config"))
    text += fmt::format(" ({})", reinterpret_cast<const char* (*)()>(kernels)());
  return text;
}

std::string modules_found() {
  struct Row {
    const char *name, *library, *version;
  };
  std::string text;
  for (const Row& row : {Row{"kerf_vtk.so", "VTK", KERF_VTK_VERSION}, Row{"kerf_gmsh.so", "gmsh", KERF_GMSH_VERSION},
                         Row{"kerf_petsc.so", "PETSc", KERF_PETSC_VERSION}}) {
    if (!find_beside(row.name, KERF_MODULE_FOLDER).empty())
      text += fmt::format("{}{} ({} {})", text.empty() ? "" : ", ", row.name, row.library, row.version);
  }
  return text.empty() ? "none" : text;
}

}  // namespace

std::string version_text() {
  return fmt::format("kerf {}\ncompiler   {}\nlibraries  {}\nBLAS       {}\nmodules    {}", KERF_VERSION, KERF_COMPILER,
                     KERF_LIBRARIES, blas_in_use(), modules_found());
}

}  // namespace kerf
