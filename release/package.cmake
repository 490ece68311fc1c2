# Writes the CMake package and the pkg-config file of a built library, as ../CMakeLists.txt does for one that it installs:
# cmake -D SOURCE=... -D OUT=... -D VERSION=... -D SHARED=... -D SONAME=... -D IMPORT=... -D LIBRARIES=... -P package.cmake
include(CMakePackageConfigHelpers)

set(PROJECT_VERSION "${VERSION}")
set(CMAKE_INSTALL_INCLUDEDIR include)
set(CMAKE_INSTALL_LIBDIR lib)
set(shared_file "${SHARED}")
set(soname "${SONAME}")
set(import_library "${IMPORT}")
set(native_libraries "${LIBRARIES}")
list(TRANSFORM native_libraries PREPEND "-l" OUTPUT_VARIABLE native_flags)
string(REPLACE ";" " " native_flags "${native_flags}")

# The folder may be moved: both files tell their place from their own.
set(CMAKE_INSTALL_PREFIX "\${pcfiledir}/../..")
configure_file("${SOURCE}/cmake/intrinsym.pc.in" "${OUT}/lib/pkgconfig/intrinsym.pc" @ONLY)
set(folder "${OUT}/lib/cmake/intrinsym")
set(CMAKE_INSTALL_PREFIX "/intrinsym")
configure_package_config_file("${SOURCE}/cmake/intrinsym-config.cmake.in" "${folder}/intrinsym-config.cmake"
  INSTALL_DESTINATION lib/cmake/intrinsym PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file("${folder}/intrinsym-config-version.cmake" VERSION "${VERSION}"
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
