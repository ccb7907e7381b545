# What cmake --install puts where, in components, and the Debian packages that CPack makes of them:
#   program  kerf, kerf-bench, completion, manual pages, cases, documents     package kerf
#   vtk      the module that writes VTK files                                 package kerf-vtk
#   gmsh     the module that reads gmsh's files, where it is built            package kerf-gmsh
#   python   the Python module, where it is built                             package python3-kerf
#   dev      static libraries, headers, find_package(kerf)                    package libkerf-dev
include(CMakePackageConfigHelpers)
list(TRANSFORM rooms PREPEND kerf_ OUTPUT_VARIABLE libraries)
foreach(room ${rooms})
  set_target_properties(kerf_${room} PROPERTIES EXPORT_NAME ${room})
endforeach()
install(TARGETS ${libraries} kerf_all EXPORT kerfTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
set(headers_left_out none_of_them)
if(NOT KERF_OPTIMIZE)
  list(APPEND headers_left_out design optimize inverse)
endif()
if(NOT KERF_CASE_FILES)
  list(APPEND headers_left_out case_file)
endif()
if(NOT TARGET kerf_vtk)
  list(APPEND headers_left_out vtk)
endif()
list(JOIN headers_left_out "|" headers_left_out)
install(DIRECTORY include/kerf DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev
  FILES_MATCHING PATTERN "*.hpp" REGEX "/(${headers_left_out})\\.hpp$" EXCLUDE)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/kerf)
install(EXPORT kerfTargets NAMESPACE kerf:: DESTINATION ${package} COMPONENT dev)
configure_package_config_file(cmake/kerfConfig.cmake.in kerfConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(kerfConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kerfConfig.cmake ${PROJECT_BINARY_DIR}/kerfConfigVersion.cmake
  cmake/FindSuiteSparse.cmake DESTINATION ${package} COMPONENT dev)
install(FILES examples/map.cpp examples/CMakeLists.txt DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libkerf-dev/examples
  COMPONENT dev)

# Modules lie where the loaders look: ../lib/kerf, seen from the program.
foreach(kind vtk gmsh petsc)
  if(TARGET kerf_${kind}_module)
    install(TARGETS kerf_${kind}_module LIBRARY DESTINATION lib/kerf COMPONENT ${kind})
  endif()
endforeach()

set(programs "")
if(KERF_PROGRAM)
  list(APPEND programs kerf)
  install(FILES docs/kerf.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME kerf
    COMPONENT program)
  install(DIRECTORY cases DESTINATION ${CMAKE_INSTALL_DATADIR}/kerf COMPONENT program)
  install(FILES docs/kerf.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/kerf COMPONENT program)
  install(FILES README.md CHANGELOG.md CITATION.cff docs/command-line.md docs/results.md docs/faq.md
    docs/limits.md docs/install.md
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/kerf COMPONENT program)
  install(DIRECTORY docs/case-files docs/method DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/kerf COMPONENT program)
endif()
if(KERF_BENCH)
  list(APPEND programs kerf-bench)
endif()

# Manual pages are what the programs say of themselves. help2man runs them: without it there are none.
find_program(KERF_HELP2MAN help2man)
foreach(program ${programs})
  install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  if(KERF_HELP2MAN)
    add_custom_command(OUTPUT ${program}.1.gz
      COMMAND bash ${PROJECT_SOURCE_DIR}/cmake/man.sh $<TARGET_FILE:${program}> ${PROJECT_BINARY_DIR}/${program}.1.gz
      DEPENDS ${programs} cmake/man.sh VERBATIM)
    add_custom_target(man-${program} ALL DEPENDS ${PROJECT_BINARY_DIR}/${program}.1.gz)
    install(FILES ${PROJECT_BINARY_DIR}/${program}.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  endif()
endforeach()

# Debian packages: cpack in the build folder, or ./dev package.
if(NOT PROJECT_IS_TOP_LEVEL OR NOT KERF_PROGRAM)
  return()
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME kerf)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "kerf maintainers <kerf@users.noreply.github.com>")
set(CPACK_PACKAGE_VENDOR kerf)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION math)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(same_version "(= ${PROJECT_VERSION})")

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME kerf)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "topological derivatives for plane elastic bodies with cracks
kerf computes how an energy or another functional changes when a small hole,
inclusion or crack appears in a plane elastic body whose cracks may close, and
optimizes shapes with it. Mixed finite elements, unilateral contact.")
# For UMFPACK, faster than the BLAS that would be chosen.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "kerf-vtk ${same_version}, libopenblas0-pthread")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "libkerf-dev ${same_version}, paraview")

set(CPACK_DEBIAN_VTK_PACKAGE_NAME kerf-vtk)
set(CPACK_DEBIAN_VTK_DESCRIPTION "files for ParaView, a module of kerf
Writes the fields that kerf computes on triangles and along cracks as VTK XML
files. kerf does without it, but for those files.")
set(CPACK_DEBIAN_VTK_PACKAGE_DEPENDS "kerf ${same_version}")

set(CPACK_DEBIAN_GMSH_PACKAGE_NAME kerf-gmsh)
set(CPACK_DEBIAN_GMSH_DESCRIPTION "meshes and geometries of gmsh, a module of kerf
Reads .geo, .step and .brep files through the library of gmsh.")
set(CPACK_DEBIAN_GMSH_PACKAGE_DEPENDS "kerf ${same_version}")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-kerf)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "topological derivatives in Python, a module of kerf
Cases as dicts, results as arrays of numpy, sweeps. It holds all that it
computes with: the program is not needed.")
if(KERF_WITH_PYTHON)
  math(EXPR next_python "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_python}), python3-numpy")
endif()
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "kerf ${same_version}, kerf-vtk ${same_version}, libopenblas0-pthread")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, python3-meshio, python3-distributed, snakemake")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libkerf-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_DESCRIPTION "library of kerf: headers and static libraries
Meshes with cracks, mixed finite elements, contact, topological derivatives and
shape optimization in C++20, for find_package(kerf).")
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4), libfmt-dev, libsuitesparse-dev, libgmp-dev, \
libmpfr-dev, libnlopt-dev, libtomlplusplus-dev, libmuparser-dev, g++")

# Every package says whose it is and what has changed.
execute_process(COMMAND date -R -u -d "@$ENV{SOURCE_DATE_EPOCH}" OUTPUT_VARIABLE changed OUTPUT_STRIP_TRAILING_WHITESPACE
  ERROR_QUIET)
if(NOT changed)
  execute_process(COMMAND date -R -u OUTPUT_VARIABLE changed OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
foreach(component PROGRAM VTK GMSH PYTHON DEV)
  set(debian_name ${CPACK_DEBIAN_${component}_PACKAGE_NAME})
  string(TOLOWER ${component} lower)
  if(component STREQUAL GMSH AND NOT TARGET kerf_gmsh_module OR component STREQUAL VTK AND NOT TARGET kerf_vtk_module
      OR component STREQUAL PYTHON AND NOT KERF_WITH_PYTHON)
    continue()
  endif()
  list(APPEND CPACK_COMPONENTS_ALL ${lower})
  set(documents ${PROJECT_BINARY_DIR}/debian/${debian_name})
  configure_file(cmake/changelog.in ${documents}/changelog @ONLY)
  configure_file(cmake/copyright.in ${documents}/copyright @ONLY)
  execute_process(COMMAND gzip -9nf ${documents}/changelog)
  install(FILES ${documents}/changelog.gz ${documents}/copyright
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${debian_name} COMPONENT ${lower})
endforeach()
include(CPack)
