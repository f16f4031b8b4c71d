!> THE table of joint types: which local dofs are free and how the joint frame turns.
!> A joint type has no code of its own: its physics is its row here plus the dof laws of
!> kj_legacy_law. To add a type, add a row (and a row to tests/unit/test_joint_types.pf).
module kj_joint_types
   implicit none
   private

   public :: joint_type_t, find_joint_type

   integer, parameter, public :: NDOF = 6            !! tx ty tz rx ry rz, joint frame J
   integer, parameter, public :: FRAME_MEAN  = 1     !! J turns with the mean of both bodies
   integer, parameter, public :: FRAME_FIRST = 2     !! J is the first skew (skew flag 1)
   integer, parameter, public :: FRAME_CROSS = 3     !! J is spanned by one axis of each body
   ! of springs (/PROP/TYPE4, /PROP/TYPE8), which have FRAME_FIRST too
   integer, parameter, public :: FRAME_SECOND = 4    !! J is a skew that rides on end 2
   integer, parameter, public :: FRAME_FIXED = 5     !! J is fixed in space
   integer, parameter, public :: FRAME_APART = 6     !! J is a skew that rides on neither end
   integer, parameter, public :: FRAME_LINE = 7      !! x of J points from node 1 to node 2

   character(len=2), parameter, public :: DOF_NAME(NDOF) = ['tx', 'ty', 'tz', 'rx', 'ry', 'rz']

   !> A row of the table
   type :: joint_type_t
      integer           :: id          !! number on the property card
      character(len=13) :: name        !! name in messages and HDF5 attributes
      integer           :: free(NDOF)  !! 1 free (user law), 0 blocked (penalty Kn)
      integer           :: frame       !! rule of the frame with skew flag 0
   end type joint_type_t

   type(joint_type_t), parameter, public :: joint_types(*) = [ &
      !            id  name             tx ty tz rx ry rz   frame
      joint_type_t(1, 'spherical',     [0, 0, 0, 1, 1, 1], FRAME_MEAN),  &
      joint_type_t(2, 'revolute',      [0, 0, 0, 1, 0, 0], FRAME_MEAN),  &
      joint_type_t(3, 'cylindrical',   [1, 0, 0, 1, 0, 0], FRAME_MEAN),  &
      joint_type_t(4, 'planar',        [0, 1, 1, 1, 0, 0], FRAME_MEAN),  &
      joint_type_t(5, 'universal',     [0, 0, 0, 0, 1, 1], FRAME_CROSS), &
      joint_type_t(6, 'translational', [1, 0, 0, 0, 0, 0], FRAME_MEAN),  &
      joint_type_t(7, 'oldham',        [0, 1, 1, 0, 0, 0], FRAME_MEAN),  &
      joint_type_t(8, 'fixed',         [0, 0, 0, 0, 0, 0], FRAME_MEAN),  &
      joint_type_t(9, 'free',          [1, 1, 1, 1, 1, 1], FRAME_MEAN)]

contains

   !> Row of the joint type with this card number, 0 when there is none
   pure integer function find_joint_type(id) result(row)
      integer, intent(in) :: id

      do row = 1, size(joint_types)
         if (joint_types(row)%id == id) return
      end do
      row = 0
   end function find_joint_type

end module kj_joint_types
