# The part of VTK that reads and writes XML files, found without VTK's own package file: that one wants all of
# libvtk9-dev, whose dependencies (Java, LLVM, GDAL, Qt ...) are 320 packages and one gigabyte. The headers come from the same
# Debian package, unpacked (./dev does it; KERF_HEADERS_ROOT says where), the libraries from libvtk9.1. Defines VTK::IO.
find_path(VTKIO_INCLUDE_DIR vtkXMLUnstructuredGridWriter.h
  HINTS ${KERF_HEADERS_ROOT} PATH_SUFFIXES usr/include/vtk-9.1 include/vtk-9.1 vtk-9.1)
set(VTKIO_LIBRARIES "")
set(VTKIO_COMPLETE TRUE)
foreach(name CommonCore CommonDataModel CommonExecutionModel IOXML IOXMLParser)
  # Without the development package there is no libvtk*.so, only the library itself.
  find_library(VTKIO_${name} NAMES vtk${name}-9.1 libvtk${name}-9.1.so.1)
  mark_as_advanced(VTKIO_${name})
  if(VTKIO_${name})
    list(APPEND VTKIO_LIBRARIES ${VTKIO_${name}})
  else()
    set(VTKIO_COMPLETE FALSE)
  endif()
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(VTKIO REQUIRED_VARS VTKIO_INCLUDE_DIR VTKIO_LIBRARIES VTKIO_COMPLETE)
if(VTKIO_FOUND AND NOT TARGET VTK::IO)
  add_library(VTK::IO INTERFACE IMPORTED)
  set_target_properties(VTK::IO PROPERTIES
    INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${VTKIO_INCLUDE_DIR}
    INTERFACE_INCLUDE_DIRECTORIES ${VTKIO_INCLUDE_DIR}
    INTERFACE_LINK_LIBRARIES "${VTKIO_LIBRARIES}")
endif()
