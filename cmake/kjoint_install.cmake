# What `cmake --install` installs, the CMake and pkg-config packages, and the Debian package

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kjoint)
install(TARGETS kjoint EXPORT kjoint-core)
install(EXPORT kjoint-core NAMESPACE kjoint:: DESTINATION ${package_dir})
if(KJOINT_IO)
  install(TARGETS kjoint_io EXPORT kjoint-io)
  install(EXPORT kjoint-io NAMESPACE kjoint:: DESTINATION ${package_dir})
  install(TARGETS kjoint_cli)
endif()
install(DIRECTORY ${mods}/ DESTINATION ${install_mods} FILES_MATCHING PATTERN "*.mod")
if(KJOINT_C)
  install(TARGETS kjoint_c EXPORT kjoint-c)
  install(EXPORT kjoint-c NAMESPACE kjoint:: DESTINATION ${package_dir})
  install(FILES include/kjoint.h TYPE INCLUDE)
  install(DIRECTORY python/kjoint DESTINATION ${CMAKE_INSTALL_LIBDIR}/kjoint/python
    FILES_MATCHING PATTERN "*.py" PATTERN "*.html" PATTERN "py.typed")
endif()

# ---- manual pages and completions, out of what the program says of itself
find_package(Python3 3.9 QUIET COMPONENTS Interpreter)
if(KJOINT_IO AND Python3_FOUND AND NOT SKBUILD)
  set(share ${PROJECT_BINARY_DIR}/share)
  add_custom_command(OUTPUT ${share}/man/man1/kjoint.1 VERBATIM
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/manual $<TARGET_FILE:kjoint_cli> ${share}
    DEPENDS kjoint_cli ${PROJECT_SOURCE_DIR}/tools/manual COMMENT "Manual pages")
  add_custom_target(kjoint_manual ALL DEPENDS ${share}/man/man1/kjoint.1)
  install(DIRECTORY ${share}/ DESTINATION ${CMAKE_INSTALL_DATADIR})
endif()

# ---- the wheel (pyproject.toml): beside the Python package, found by it
if(SKBUILD)
  install(TARGETS kjoint_cli RUNTIME DESTINATION kjoint/bin COMPONENT wheel)
  install(FILES $<TARGET_FILE:kjoint_c> RENAME libkjoint_c.so DESTINATION kjoint/lib COMPONENT wheel)
endif()

configure_package_config_file(cmake/kjoint-config.cmake.in kjoint-config.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(kjoint-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kjoint-config.cmake
  ${PROJECT_BINARY_DIR}/kjoint-config-version.cmake DESTINATION ${package_dir})

# ---- licences: that of kjoint, and that of HDF5 where the program holds it
install(DIRECTORY decks DESTINATION ${CMAKE_INSTALL_DATADIR}/kjoint FILES_MATCHING PATTERN "*.rad")
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
if(KJOINT_IO AND KJOINT_STATIC_HDF5 AND KJOINT_HDF5_HAS_ARCHIVES)
  find_file(KJOINT_HDF5_LICENCE NAMES copyright COPYING LICENSE PATHS /usr/share/doc/libhdf5-dev
    /usr/share/doc/hdf5 /usr/share/licenses/hdf5 NO_DEFAULT_PATH)
  mark_as_advanced(KJOINT_HDF5_LICENCE)
  if(KJOINT_HDF5_LICENCE)
    install(FILES ${KJOINT_HDF5_LICENCE} DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright.hdf5)
  else()
    message(STATUS "The licence of HDF5 was not found: add it to what you pass on")
  endif()
endif()

# ---- pkg-config: kjoint for Fortran (static), kjoint-c for C
set(pc_libraries "-llapack -lblas")
if(KJOINT_OPENMP AND OpenMP_Fortran_FLAGS)
  string(APPEND pc_libraries " ${OpenMP_Fortran_FLAGS}")
endif()
file(RELATIVE_PATH pc_up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
foreach(name kjoint kjoint-c)
  if(name STREQUAL "kjoint-c" AND NOT KJOINT_C)
    continue()
  endif()
  configure_file(cmake/${name}.pc.in ${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()

# ---- Debian package: cpack -G DEB in the build folder
set(CPACK_PACKAGE_NAME kjoint)
set(CPACK_PACKAGE_CONTACT "the kjoint developers <kjoint@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-numpy")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
  "python3-matplotlib, python3-h5py, gfortran, liblapack-dev, libhdf5-dev, zlib1g-dev, libisal-dev")
include(CPack)
