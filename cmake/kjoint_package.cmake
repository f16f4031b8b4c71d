# Packages of Debian, one a component, out of a build for /usr:
#   cmake --workflow --preset package

set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_PACKAGE_NAME kjoint)
set(CPACK_PACKAGE_CONTACT "the kjoint developers <kjoint@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program library development python docs)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
  "The program kjoint: runs, checks and studies Radioss decks,\n compares and exports histories.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME kjoint)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS python3-kjoint)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS kjoint-doc)

set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
  "The shared library of the C interface, for hosts in C and Python.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libkjoint-c${soversion})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_MULTIARCH same)         # by CMake 3.31 and later
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_MULTIARCH same)

set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
  "Header of C, static libraries and modules of Fortran,\n packages of CMake and pkg-config.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libkjoint-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libkjoint-c${soversion} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS
  "gfortran, liblapack-dev, libhdf5-dev, zlib1g-dev, libisal-dev")

set(CPACK_COMPONENT_PYTHON_DESCRIPTION
  "Mechanisms in Python; plots, films and reports of the program kjoint.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-kjoint)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "libkjoint-c${soversion} (= ${PROJECT_VERSION}), python3 (>= 3.9), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-h5py, python3-matplotlib")

set(CPACK_COMPONENT_DOCS_DESCRIPTION
  "Guides, theory, examples and commented decks.")
set(CPACK_DEBIAN_DOCS_PACKAGE_NAME kjoint-doc)
set(CPACK_DEBIAN_DOCS_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCS_PACKAGE_ARCHITECTURE all)

# what a distribution wants beside: a licence in each package, the place where its Python looks
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  foreach(component LIBRARY DEVELOPMENT PYTHON DOCS)
    string(TOLOWER ${component} name)
    install(FILES LICENSE RENAME copyright COMPONENT ${name}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${component}_PACKAGE_NAME})
  endforeach()
  file(WRITE ${PROJECT_BINARY_DIR}/kjoint.pth "/usr/${CMAKE_INSTALL_LIBDIR}/kjoint/python\n")
  install(FILES ${PROJECT_BINARY_DIR}/kjoint.pth DESTINATION lib/python3/dist-packages
    COMPONENT python)
endif()
include(CPack)
