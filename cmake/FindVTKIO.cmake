# The part of VTK that reads and writes XML files, found without VTK's own package file: that one wants all of
# libvtk9-dev, whose dependencies (Java, LLVM, GDAL, Qt ...) are 320 packages and one gigabyte. The headers come from the same
# Debian package, unpacked (./dev does it; KERF_HEADERS_ROOT says where), the libraries from libvtk9.1, libvtk9.3 ... Defines
# VTK::IO.
foreach(minor RANGE 19)  # the newest first
  list(PREPEND folders usr/include/vtk-9.${minor} include/vtk-9.${minor} vtk-9.${minor})
endforeach()
find_path(VTKIO_INCLUDE_DIR vtkXMLUnstructuredGridWriter.h HINTS ${KERF_HEADERS_ROOT} PATH_SUFFIXES ${folders})
string(REGEX MATCH "9\\.[0-9]+$" VTKIO_VERSION "${VTKIO_INCLUDE_DIR}")
set(VTKIO_LIBRARIES "")
set(VTKIO_COMPLETE TRUE)
foreach(name CommonCore CommonDataModel CommonExecutionModel IOXML IOXMLParser sys)  # sys: which the headers themselves use
  # Without the development package there is no libvtk*.so, only the library itself.
  find_library(VTKIO_${name} NAMES vtk${name}-${VTKIO_VERSION} libvtk${name}-${VTKIO_VERSION}.so.1)
  mark_as_advanced(VTKIO_${name})
  if(VTKIO_${name})
    list(APPEND VTKIO_LIBRARIES ${VTKIO_${name}})
  else()
    set(VTKIO_COMPLETE FALSE)
  endif()
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(VTKIO REQUIRED_VARS VTKIO_INCLUDE_DIR VTKIO_LIBRARIES VTKIO_COMPLETE
                                  VERSION_VAR VTKIO_VERSION)
if(VTKIO_FOUND AND NOT TARGET VTK::IO)
  add_library(VTK::IO INTERFACE IMPORTED)
  set_target_properties(VTK::IO PROPERTIES
    INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${VTKIO_INCLUDE_DIR}
    INTERFACE_INCLUDE_DIRECTORIES ${VTKIO_INCLUDE_DIR}
    INTERFACE_LINK_LIBRARIES "${VTKIO_LIBRARIES}")
endif()
