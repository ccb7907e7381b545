# Debian ships SuiteSparse without CMake or pkg-config files. Defines SuiteSparse::cholmod and SuiteSparse::umfpack, and
# the SuiteSparse::lapack and SuiteSparse::blas that they call.
find_path(SuiteSparse_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(SuiteSparse_CHOLMOD cholmod)
find_library(SuiteSparse_UMFPACK umfpack)
find_library(SuiteSparse_LAPACK lapack)
find_library(SuiteSparse_BLAS blas)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparse REQUIRED_VARS SuiteSparse_CHOLMOD SuiteSparse_UMFPACK
                                  SuiteSparse_LAPACK SuiteSparse_BLAS SuiteSparse_INCLUDE_DIR)
foreach(library cholmod umfpack lapack blas)
  string(TOUPPER ${library} name)
  if(SuiteSparse_FOUND AND NOT TARGET SuiteSparse::${library})
    add_library(SuiteSparse::${library} UNKNOWN IMPORTED)
    set_target_properties(SuiteSparse::${library} PROPERTIES
      IMPORTED_LOCATION ${SuiteSparse_${name}}
      INTERFACE_INCLUDE_DIRECTORIES ${SuiteSparse_INCLUDE_DIR})
  endif()
endforeach()
