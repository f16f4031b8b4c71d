# Install kjoint into a fresh folder, build hosts and examples against it, and check its packages.
# usage: cmake -D BUILD=... -D SOURCE=... -D WORK=... -D FLAGS=... -D GENERATOR=... -P run_embed.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK})
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
foreach(name tests/embed examples)
  cmake_path(GET name FILENAME short)
  run(${CMAKE_COMMAND} -S ${SOURCE}/${name} -B ${WORK}/${short} -G ${GENERATOR}
    -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_BUILD_TYPE=Release
    "-DCMAKE_Fortran_FLAGS=${FLAGS}" "-DCMAKE_C_FLAGS=${FLAGS}")
  run(${CMAKE_COMMAND} --build ${WORK}/${short})
endforeach()

# components, of which packages are made: each file is in one
set(of_program bin/kjoint share/man/man1/kjoint-check.1.gz)
set(of_library libkjoint_c.so.0.1)
set(of_development include/kjoint.h kjoint.pc kjoint-config.cmake libkjoint.a)
set(of_python python/kjoint/__init__.py)
set(of_docs share/kjoint/decks/knee_0000.rad docs/howto.md)
set(all_files "")
foreach(component program library development python docs)
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/parts/${component} --component ${component})
  file(GLOB_RECURSE found RELATIVE ${WORK}/parts/${component} ${WORK}/parts/${component}/*)
  foreach(name IN LISTS of_${component})
    if(NOT "${found}" MATCHES "(^|;)([^;]*/)?${name}(;|$)" AND NOT (name MATCHES "[.]a$" AND "${found}" MATCHES "libkjoint[.]so"))
      message(FATAL_ERROR "the component ${component} lacks ${name}: ${found}")
    endif()
  endforeach()
  foreach(name IN LISTS found)
    if(name IN_LIST all_files)
      message(FATAL_ERROR "two components hold ${name}")
    endif()
  endforeach()
  list(APPEND all_files ${found})
endforeach()
file(GLOB_RECURSE whole RELATIVE ${WORK}/prefix ${WORK}/prefix/*)
list(REMOVE_ITEM whole ${all_files})
if(whole)
  message(FATAL_ERROR "in no component: ${whole}")
endif()

# a program that holds HDF5 itself comes with its licence
if(EXISTS ${WORK}/prefix/bin/kjoint AND EXISTS /usr/share/doc/libhdf5-dev/copyright)
  execute_process(COMMAND ldd ${WORK}/prefix/bin/kjoint OUTPUT_VARIABLE libraries COMMAND_ERROR_IS_FATAL ANY)
  if(NOT libraries MATCHES "libhdf5" AND NOT EXISTS ${WORK}/prefix/share/doc/kjoint/copyright.hdf5)
    message(FATAL_ERROR "the program holds HDF5, and its licence is not installed")
  endif()
endif()

# a project in C alone
file(WRITE ${WORK}/c_alone/CMakeLists.txt [[
cmake_minimum_required(VERSION 3.25)
project(c_alone LANGUAGES C)
find_package(kjoint 0.1 CONFIG REQUIRED COMPONENTS c)
add_executable(c_host ${SOURCE}/examples/c_host.c)
target_link_libraries(c_host PRIVATE kjoint::c m)
]])
run(${CMAKE_COMMAND} -S ${WORK}/c_alone -B ${WORK}/c_alone/build -G ${GENERATOR} -DSOURCE=${SOURCE}
  -DCMAKE_PREFIX_PATH=${WORK}/prefix "-DCMAKE_C_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK}/c_alone/build)

# pkg-config
find_program(pkg_config pkg-config)
if(pkg_config AND FLAGS STREQUAL "")
  file(GLOB_RECURSE pc ${WORK}/prefix/kjoint.pc)
  cmake_path(GET pc PARENT_PATH pc_folder)
  set(ENV{PKG_CONFIG_PATH} ${pc_folder})
  file(WRITE ${WORK}/pc.sh "set -e
gfortran ${SOURCE}/examples/rigid_host.f90 -o ${WORK}/pc_fortran -J${WORK} \\
  $(pkg-config --cflags kjoint) $(pkg-config --libs kjoint)
cc ${SOURCE}/examples/c_host.c -o ${WORK}/pc_c $(pkg-config --cflags --libs kjoint-c) -lm
[ ! -f ${pc_folder}/kjoint-io.pc ] ||
  gfortran ${WORK}/tell.f90 -o ${WORK}/pc_io -J${WORK} $(pkg-config --cflags --libs kjoint-io)
")
  file(WRITE ${WORK}/tell.f90 [[
program tell
   use kj_error, only: error_t
   use kj_info, only: describe_history
   implicit none
   type(error_t), allocatable :: error
   character(len=:), allocatable :: text

   call describe_history('none.h5', .false., text, error)
   if (.not. allocated(error)) error stop 'none.h5 is there'
end program tell
]])
  run(sh ${WORK}/pc.sh)
  if(EXISTS ${WORK}/pc_io)
    run(${WORK}/pc_io)
  endif()
endif()

# part of another project: its libraries, without its tests and packages
file(WRITE ${WORK}/parent/CMakeLists.txt [[
cmake_minimum_required(VERSION 3.25)
project(parent LANGUAGES C Fortran)
add_subdirectory(${SOURCE} kjoint EXCLUDE_FROM_ALL)
if(NOT TARGET kjoint::kjoint OR TARGET unit_tests OR BUILD_TESTING OR CMAKE_BUILD_TYPE OR DEFINED CPACK_PACKAGE_NAME)
  message(FATAL_ERROR "kjoint sets up more than its libraries")
endif()
]])
run(${CMAKE_COMMAND} -S ${WORK}/parent -B ${WORK}/parent/build -G ${GENERATOR} -DSOURCE=${SOURCE})
