# What `cmake --install` installs, in components: program, library, development, python, docs; the
# CMake and pkg-config packages, and, of a build for /usr, the Debian packages

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kjoint)
set(as_library RUNTIME COMPONENT library
  LIBRARY COMPONENT library NAMELINK_COMPONENT development
  ARCHIVE COMPONENT development)
install(TARGETS kjoint EXPORT kjoint-core ${as_library})
install(EXPORT kjoint-core NAMESPACE kjoint:: DESTINATION ${package_dir} COMPONENT development)
if(KJOINT_IO)
  install(TARGETS kjoint_io EXPORT kjoint-io ${as_library})
  install(EXPORT kjoint-io NAMESPACE kjoint:: DESTINATION ${package_dir} COMPONENT development)
  install(TARGETS kjoint_cli RUNTIME COMPONENT program)
endif()
install(DIRECTORY ${mods}/ DESTINATION ${install_mods} COMPONENT development
  FILES_MATCHING PATTERN "*.mod")
if(KJOINT_C)
  install(TARGETS kjoint_c EXPORT kjoint-c ${as_library})
  install(EXPORT kjoint-c NAMESPACE kjoint:: DESTINATION ${package_dir} COMPONENT development)
  install(FILES include/kjoint.h TYPE INCLUDE COMPONENT development)
  install(DIRECTORY python/kjoint DESTINATION ${CMAKE_INSTALL_LIBDIR}/kjoint/python
    COMPONENT python FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN "*.html")
endif()

# ---- manual pages and completions, out of what the program says of itself
find_package(Python3 3.9 QUIET COMPONENTS Interpreter)
if(KJOINT_IO AND Python3_FOUND AND NOT SKBUILD)
  set(share ${PROJECT_BINARY_DIR}/share)
  add_custom_command(OUTPUT ${share}/man/man1/kjoint.1.gz VERBATIM
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${share}
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/manual $<TARGET_FILE:kjoint_cli> ${share}
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/editors $<TARGET_FILE:kjoint_cli>
      ${share}/kjoint/editors
    DEPENDS kjoint_cli ${PROJECT_SOURCE_DIR}/tools/manual ${PROJECT_SOURCE_DIR}/tools/editors COMMENT "Manual pages")
  add_custom_target(kjoint_manual ALL DEPENDS ${share}/man/man1/kjoint.1.gz)
  install(DIRECTORY ${share}/ DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT program)
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
  ${PROJECT_BINARY_DIR}/kjoint-config-version.cmake DESTINATION ${package_dir} COMPONENT development)

# ---- documents, decks, licences: that of kjoint, and those of what the program holds
install(DIRECTORY decks DESTINATION ${CMAKE_INSTALL_DATADIR}/kjoint COMPONENT docs
  FILES_MATCHING PATTERN "*.rad")
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT docs)
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT docs)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT program)
if(KJOINT_IO AND KJOINT_STATIC_HDF5 AND KJOINT_HDF5_HAS_ARCHIVES)
  foreach(name hdf5 lapack aec zlib1g)
    string(TOUPPER KJOINT_${name}_LICENCE licence)
    find_file(${licence} NAMES copyright COPYING LICENSE PATHS /usr/share/doc/lib${name}-dev
      /usr/share/doc/${name} /usr/share/licenses/${name} NO_DEFAULT_PATH)
    mark_as_advanced(${licence})
    if(${licence})
      install(FILES ${${licence}} DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright.${name}
        COMPONENT program)
    else()
      message(STATUS "The licence of ${name} was not found: add it to what you pass on")
    endif()
  endforeach()
endif()

# ---- pkg-config: kjoint and kjoint-io for Fortran, kjoint-c for C; what the static libraries need
# is named as CMake found it
function(link_words out)
  set(words "")
  foreach(library IN LISTS ARGN)
    if(TARGET "${library}")
      foreach(property IMPORTED_LOCATION IMPORTED_LOCATION_RELEASE IMPORTED_LOCATION_NONE)
        get_target_property(place ${library} ${property})
        if(place)
          break()
        endif()
      endforeach()
      set(library "${place}")
    endif()
    get_filename_component(folder "${library}" DIRECTORY)
    get_filename_component(name "${library}" NAME)
    if(IS_ABSOLUTE "${library}" AND name MATCHES "^lib(.+)[.](so|a|dylib)$")
      if(NOT folder IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
        list(APPEND words "-L${folder}")
      endif()
      list(APPEND words "-l${CMAKE_MATCH_1}")
    elseif(library)
      list(APPEND words "${library}")
    endif()
  endforeach()
  list(REMOVE_DUPLICATES words)
  string(REPLACE ";" " " words "${words}")
  set(${out} "${words}" PARENT_SCOPE)
endfunction()

link_words(pc_libraries ${LAPACK_LIBRARIES})
if(KJOINT_OPENMP)
  string(APPEND pc_libraries " ${OpenMP_Fortran_FLAGS}")
endif()
set(pc_files kjoint)
if(KJOINT_C)
  list(APPEND pc_files kjoint-c)
endif()
if(KJOINT_IO)
  set(isal "")
  if(KJOINT_ISAL AND ISAL_LIBRARY AND ISAL_INCLUDE_DIR)
    set(isal ${ISAL_LIBRARY})
  endif()
  link_words(pc_io_libraries hdf5::hdf5_hl_fortran hdf5::hdf5_fortran hdf5::hdf5_hl hdf5::hdf5
    ${ZLIB_LIBRARIES} ${isal} ${CMAKE_THREAD_LIBS_INIT})
  list(APPEND pc_files kjoint-io)
endif()
file(RELATIVE_PATH pc_up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
foreach(name IN LISTS pc_files)
  configure_file(cmake/${name}.pc.in ${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
    COMPONENT development)
endforeach()

if(PROJECT_IS_TOP_LEVEL)
  include(cmake/kjoint_package.cmake)
endif()
