# Cairo by its library and its headers alone: libcairo2-dev would bring 57 packages (X11, GLib and their headers) that
# nothing here includes. The headers may come from the same Debian package, unpacked (./dev does it; KERF_HEADERS_ROOT
# says where), the library from libcairo2. Defines Cairo::Cairo.
find_path(CAIRO_INCLUDE_DIR cairo.h HINTS ${KERF_HEADERS_ROOT} PATH_SUFFIXES usr/include/cairo include/cairo cairo)
find_library(CAIRO_LIBRARY NAMES cairo libcairo.so.2)
mark_as_advanced(CAIRO_INCLUDE_DIR CAIRO_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Cairo REQUIRED_VARS CAIRO_INCLUDE_DIR CAIRO_LIBRARY)
if(Cairo_FOUND AND NOT TARGET Cairo::Cairo)
  add_library(Cairo::Cairo UNKNOWN IMPORTED)
  set_target_properties(Cairo::Cairo PROPERTIES IMPORTED_LOCATION "${CAIRO_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${CAIRO_INCLUDE_DIR}")
endif()
