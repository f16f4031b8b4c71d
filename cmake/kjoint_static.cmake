# HDF5 out of its archives, for the program: the shared library of Debian brings libcurl and thirty
# more, and loading them takes longer than a run of one joint.
option(KJOINT_STATIC_HDF5 "Link HDF5 into the program, where it has archives" ON)

# Link `target` with the libraries that use HDF5, named after it, and with the archives beside the
# shared libraries of HDF5: these then have nothing left to give and are not needed at run time.
function(kjoint_static_hdf5 target)
  if(NOT KJOINT_STATIC_HDF5 OR BUILD_SHARED_LIBS OR NOT CMAKE_SYSTEM_NAME STREQUAL "Linux")
    return()
  endif()
  set(archives "")
  foreach(name hdf5_hl_fortran hdf5_fortran hdf5_hl hdf5)
    get_target_property(shared hdf5::${name} IMPORTED_LOCATION)
    string(REGEX REPLACE "[.]so$" ".a" archive "${shared}")
    if(NOT EXISTS "${archive}")
      return()
    endif()
    list(APPEND archives "${archive}")
  endforeach()
  # what HDF5 may be built with, and the few routines of LAPACK that are used, as archives where there are:
  # a tenth of a millisecond each; --as-needed drops what has nothing left to give
  foreach(name sz aec z lapack blas)
    string(TOUPPER KJOINT_${name}_LIBRARY library)
    find_library(${library} NAMES lib${name}.a ${name} PATH_SUFFIXES ${name})
    mark_as_advanced(${library})
    if(${library})
      list(APPEND archives "${${library}}")
    endif()
  endforeach()
  list(APPEND archives ZLIB::ZLIB ${CMAKE_DL_LIBS} m)
  # the runtime of gfortran, too
  set(runtime "")
  foreach(name gomp gfortran)
    if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU" AND NOT KJOINT_SANITIZE)
      execute_process(COMMAND ${CMAKE_Fortran_COMPILER} -print-file-name=lib${name}.a
        OUTPUT_VARIABLE archive OUTPUT_STRIP_TRAILING_WHITESPACE)
      if(EXISTS "${archive}" AND name STREQUAL "gfortran")
        set(runtime -static-libgfortran -static-libgcc)
      elseif(EXISTS "${archive}" AND KJOINT_OPENMP)
        list(PREPEND archives "${archive}")
      endif()
    endif()
  endforeach()

  set(CMAKE_REQUIRED_QUIET ON)
  set(CMAKE_REQUIRED_INCLUDES ${HDF5_Fortran_INCLUDE_DIRS})
  set(CMAKE_REQUIRED_LIBRARIES ${archives})
  set(CMAKE_REQUIRED_LINK_OPTIONS ${runtime})
  check_source_compiles(Fortran "program p
      use h5ds, only: h5dsset_scale_f
      use hdf5, only: hid_t, h5open_f
      integer :: status
      call h5open_f(status)
      call h5dsset_scale_f(0_hid_t, status)
    end program p" KJOINT_HDF5_HAS_ARCHIVES)
  if(KJOINT_HDF5_HAS_ARCHIVES)
    set_target_properties(${target} PROPERTIES SKIP_BUILD_RPATH ON)   # no folder to be searched
    target_link_options(${target} PRIVATE -Wl,--as-needed ${runtime})
    target_link_libraries(${target} PRIVATE ${ARGN} ${archives})
  endif()
endfunction()
