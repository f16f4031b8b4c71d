# Compiler options of every target: kjoint_fortran(target), and of a library: kjoint_library(target)

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Release or Debug" FORCE)
endif()

# gfortran 12 wrongly calls the descriptor of an allocatable array uninitialized when a function
# result is assigned to it, so that warning is off. When sanitized it computes with the bounds of an
# array that is not allocated yet, which may overflow: that check is off, too.
# Each `a*b + c` is rounded twice (-ffp-contract=off): same deck, same bits, with any -march.
# -frecursive keeps local arrays off static memory: simulations run side by side in threads.
function(kjoint_fortran target)
  if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:Fortran>:
      -std=f2008 -ffp-contract=off -frecursive
      -Wall -Wextra -pedantic -Wimplicit-interface -Wconversion
      -Wno-uninitialized -Wno-maybe-uninitialized
      $<$<BOOL:${KJOINT_WERROR}>:-Werror>>)
  endif()
  if(CMAKE_C_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:C>:
      -std=c11 -Wall -Wextra -pedantic $<$<BOOL:${KJOINT_WERROR}>:-Werror>>)
  endif()
  if(KJOINT_MARCH)
    target_compile_options(${target} PRIVATE -march=${KJOINT_MARCH})
  endif()
  if(KJOINT_SANITIZE)
    target_compile_options(${target} PRIVATE -g -fno-omit-frame-pointer
      -fsanitize=address,undefined -fno-sanitize=signed-integer-overflow
      -fno-sanitize-recover=undefined
      $<$<COMPILE_LANGUAGE:Fortran>:-fcheck=all,no-array-temps>)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
  if(KJOINT_OPENMP)
    find_package(OpenMP REQUIRED COMPONENTS Fortran)
    target_link_libraries(${target} PRIVATE OpenMP::OpenMP_Fortran)
  elseif(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:Fortran>:-fopenmp-simd>)
  endif()
endfunction()

# Before 1.0 each minor version is another interface
function(kjoint_version target)
  set_target_properties(${target} PROPERTIES VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
endfunction()

function(kjoint_library target)
  kjoint_fortran(${target})
  kjoint_version(${target})
  set_target_properties(${target} PROPERTIES
    Fortran_MODULE_DIRECTORY ${mods} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${mods}> $<INSTALL_INTERFACE:${install_mods}>)
endfunction()

# Sources of kjoint as one file, so that the compiler makes kernels for few joints or leads where callers
# give it that number, and no calls within a kernel, of memcpy and memset neither, which take longer than few
# joints. `result`: what is compiled
function(kjoint_one_piece result)
  set(${result} ${ARGN} PARENT_SCOPE)
  if(CMAKE_BUILD_TYPE STREQUAL "Debug" OR NOT CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
    return()
  endif()
  set(piece ${PROJECT_BINARY_DIR}/kj_one_piece.F90)
  list(TRANSFORM ARGN REPLACE "(.+)" "#include \"${PROJECT_SOURCE_DIR}/\\1\"" OUTPUT_VARIABLE lines)
  list(JOIN lines "\n" lines)
  file(CONFIGURE OUTPUT ${piece} CONTENT "${lines}\n" @ONLY)
  set_source_files_properties(${ARGN} PROPERTIES HEADER_FILE_ONLY ON)
  set_source_files_properties(${piece} PROPERTIES COMPILE_OPTIONS "-fno-semantic-interposition;\
-fno-tree-loop-distribute-patterns;--param=ipa-cp-eval-threshold=1;--param=ipa-cp-unit-growth=400")
  target_sources(kjoint PRIVATE ${piece})
  set(${result} ${piece} PARENT_SCOPE)
endfunction()

# Compile kernels of a library for x86-64, -v3 and -v4: kj_kernels.c chooses at start
option(KJOINT_VARIANTS "Kernels for x86-64-v3 and -v4, too, chosen at start" ON)
function(kjoint_kernels target)
  set(chosen src/base/kj_kernels.c)
  set(machine ${CMAKE_SYSTEM_PROCESSOR})
  if(KJOINT_MARCH)
    set(machine ${KJOINT_MARCH})
  endif()
  set_property(SOURCE ${chosen} PROPERTY COMPILE_DEFINITIONS "KJOINT_MACHINE=\"${machine}\"")
  if(NOT KJOINT_VARIANTS OR KJOINT_MARCH OR KJOINT_SANITIZE OR CMAKE_BUILD_TYPE STREQUAL "Debug"
     OR NOT CMAKE_GENERATOR MATCHES "Ninja|Makefiles" OR NOT CMAKE_SYSTEM_NAME STREQUAL "Linux"
     OR NOT CMAKE_Fortran_COMPILER_ID STREQUAL "GNU" OR CMAKE_INTERPROCEDURAL_OPTIMIZATION)
    return()
  endif()
  check_source_compiles(C "#if !defined __x86_64__ || defined __ILP32__
    #error not x86-64
    #endif
    int main(void) { return __builtin_cpu_supports(\"x86-64-v4\"); }" KJOINT_CHOOSES_KERNELS)
  if(KJOINT_CHOOSES_KERNELS)
    set_property(SOURCE ${chosen} PROPERTY COMPILE_DEFINITIONS KJOINT_VARIANTS)
    set_property(TARGET ${target} APPEND PROPERTY Fortran_COMPILER_LAUNCHER
      ${PROJECT_SOURCE_DIR}/cmake/kjoint_variants.sh)
    set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS
      -mprefer-vector-width=256 -march=x86-64-v4 -march=x86-64-v3 -march=x86-64)
    set_property(SOURCE ${ARGN} APPEND PROPERTY OBJECT_DEPENDS
      ${PROJECT_SOURCE_DIR}/cmake/kjoint_variants.sh)
  endif()
endfunction()
