!> The version of kjoint, once. CMakeLists.txt names the same one.
module kj_version
   implicit none
   private

   !> MAJOR.MINOR.PATCH, semantic versioning
   character(len=*), parameter, public :: KJOINT_VERSION = '0.1.0'
end module kj_version
