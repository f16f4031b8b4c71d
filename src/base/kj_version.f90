!> The version of kjoint. CMakeLists.txt reads it here; fpm.toml and CITATION.cff repeat it, and a
!> test compares them.
module kj_version
   implicit none
   private

   !> MAJOR.MINOR.PATCH, semantic versioning
   character(len=*), parameter, public :: KJOINT_VERSION = '0.1.0'
end module kj_version
