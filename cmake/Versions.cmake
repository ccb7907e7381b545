# What `kerf --version` says for bug reports: the compiler, and the versions of the libraries that this build found.

# header_version(VARIABLE HEADER NAME...): what a header defines under these names, with dots between.
function(header_version variable header)
  set(numbers "")
  if(EXISTS "${header}")
    file(READ "${header}" text)
    foreach(name ${ARGN})
      string(REGEX MATCH "#define[ \t]+${name}[ \t]+\"?([0-9.]+)" found "${text}")
      if(found)
        list(APPEND numbers ${CMAKE_MATCH_1})
      endif()
    endforeach()
  endif()
  list(JOIN numbers "." numbers)
  set(${variable} "${numbers}" PARENT_SCOPE)
endfunction()

header_version(SuiteSparse_VERSION "${SuiteSparse_INCLUDE_DIR}/SuiteSparse_config.h"
  SUITESPARSE_MAIN_VERSION SUITESPARSE_SUB_VERSION SUITESPARSE_SUBSUB_VERSION)
header_version(Cairo_VERSION "${CAIRO_INCLUDE_DIR}/cairo-version.h" CAIRO_VERSION_MAJOR CAIRO_VERSION_MINOR CAIRO_VERSION_MICRO)
find_file(KERF_CGAL_VERSION_FILE CGAL/version.h)
mark_as_advanced(KERF_CGAL_VERSION_FILE)
header_version(CGAL_VERSION "${KERF_CGAL_VERSION_FILE}" CGAL_VERSION)
set(libraries "")
foreach(row "Eigen Eigen3" "SuiteSparse SuiteSparse" "CGAL CGAL" "NLopt NLopt" "Cairo Cairo" "toml++ tomlplusplus"
    "muParser muparser" "CLI11 CLI11" "fmt fmt" "spdlog spdlog" "nlohmann-json nlohmann_json")
  string(REGEX MATCH "^(.*) (.*)$" row "${row}")
  list(APPEND libraries "${CMAKE_MATCH_1} ${${CMAKE_MATCH_2}_VERSION}")
endforeach()
list(JOIN libraries ", " libraries)

header_version(VTK_VERSION "${VTKIO_INCLUDE_DIR}/vtkVersionMacros.h" VTK_MAJOR_VERSION VTK_MINOR_VERSION VTK_BUILD_VERSION)
header_version(GMSH_VERSION "${GMSH_INCLUDE_DIR}/gmsh.h" GMSH_API_VERSION)
set_source_files_properties(app/command/version.cpp PROPERTIES COMPILE_DEFINITIONS
  "KERF_COMPILER=\"${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}, ${CMAKE_BUILD_TYPE}, -march=${KERF_ARCH}\";\
KERF_LIBRARIES=\"${libraries}\";KERF_VTK_VERSION=\"${VTK_VERSION}\";KERF_GMSH_VERSION=\"${GMSH_VERSION}\";\
KERF_PETSC_VERSION=\"${PETSC_VERSION}\";KERF_MODULE_FOLDER=\"${module_folder}\"")
