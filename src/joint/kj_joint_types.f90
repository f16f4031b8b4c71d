!> THE table of joint types: which local dofs are free, how the joint frame turns, how its angles
!> are counted. A joint type has no code of its own: its physics is its row here plus the laws of
!> its dofs. CONTRIBUTING.md lists what a new row needs beside it.
module kj_joint_types
   use kj_error, only: str, width_of
   implicit none
   private

   public :: joint_type_t, find_joint_type, known_types

   integer, parameter, public :: NDOF = 6            !! tx ty tz rx ry rz, joint frame J
   integer, parameter, public :: FRAME_MEAN  = 1     !! J turns with the mean of both bodies
   integer, parameter, public :: FRAME_FIRST = 2     !! J is the first skew (skew flag 1)
   integer, parameter, public :: FRAME_CROSS = 3     !! J is spanned by one axis of each body
   ! of springs (/PROP/TYPE4, /PROP/TYPE8), which have FRAME_FIRST too
   integer, parameter, public :: FRAME_SECOND = 4    !! J is a skew that rides on end 2
   integer, parameter, public :: FRAME_FIXED = 5     !! J is fixed in space
   integer, parameter, public :: FRAME_APART = 6     !! J is a skew that rides on neither end
   integer, parameter, public :: FRAME_LINE = 7      !! x of J points from node 1 to node 2

   !> How the consistent formulation counts the rotations of a joint
   integer, parameter, public :: CHART_TWIST = 1     !! at most one is free, about x
   integer, parameter, public :: CHART_VECTOR = 2    !! all three are free
   integer, parameter, public :: CHART_UNIVERSAL = 3 !! about y of end 1 and z of end 2
   integer, parameter, public :: CHART_LINE = 4      !! none: a spring along its line

   !> Angles that a KJOINT2 with two skews starts with
   integer, parameter, public :: ANGLES_NONE = 0     !! none: no skews are needed
   integer, parameter, public :: ANGLES_X = 1        !! about x alone, which both skews must have
   integer, parameter, public :: ANGLES_ALL = 2      !! all three

   character(len=2), parameter, public :: DOF_NAME(NDOF) = ['tx', 'ty', 'tz', 'rx', 'ry', 'rz']

   !> A row of the table
   type :: joint_type_t
      integer           :: id          !! number on the property card
      character(len=13) :: name        !! name in messages and HDF5 attributes
      integer           :: free(NDOF)  !! 1 free (user law), 0 blocked (penalty Kn)
      integer           :: frame       !! rule of the frame with skew flag 0
      integer           :: chart       !! CHART_ constant
      integer           :: n_axis_node !! nodes that a KJOINT2 without a skew needs for its axes
      integer           :: angles      !! ANGLES_ constant
   end type joint_type_t

   type(joint_type_t), parameter, public :: joint_types(*) = [ &
      !            id  name             tx ty tz rx ry rz   frame        chart        nodes  angles
      joint_type_t(1, 'spherical',     [0, 0, 0, 1, 1, 1], FRAME_MEAN,  CHART_VECTOR,    2, ANGLES_ALL),  &
      joint_type_t(2, 'revolute',      [0, 0, 0, 1, 0, 0], FRAME_MEAN,  CHART_TWIST,     3, ANGLES_X),    &
      joint_type_t(3, 'cylindrical',   [1, 0, 0, 1, 0, 0], FRAME_MEAN,  CHART_TWIST,     3, ANGLES_X),    &
      joint_type_t(4, 'planar',        [0, 1, 1, 1, 0, 0], FRAME_MEAN,  CHART_TWIST,     3, ANGLES_X),    &
      joint_type_t(5, 'universal',     [0, 0, 0, 0, 1, 1], FRAME_CROSS, CHART_UNIVERSAL, 4, ANGLES_NONE), &
      joint_type_t(6, 'translational', [1, 0, 0, 0, 0, 0], FRAME_MEAN,  CHART_TWIST,     3, ANGLES_NONE), &
      joint_type_t(7, 'oldham',        [0, 1, 1, 0, 0, 0], FRAME_MEAN,  CHART_TWIST,     3, ANGLES_NONE), &
      joint_type_t(8, 'fixed',         [0, 0, 0, 0, 0, 0], FRAME_MEAN,  CHART_TWIST,     2, ANGLES_NONE), &
      joint_type_t(9, 'free',          [1, 1, 1, 1, 1, 1], FRAME_MEAN,  CHART_VECTOR,    4, ANGLES_ALL)]

   !> Row of the type whose six dofs are free, which springs have, too
   integer, parameter, public :: ROW_FREE = findloc(joint_types%name, 'free', 1)

contains

   !> Row of the joint type with this card number, 0 when there is none
   pure integer function find_joint_type(id) result(row)
      integer, intent(in) :: id

      row = findloc(joint_types%id, id, 1)
   end function find_joint_type

   !> The numbers there are, for messages: "1 to 9"
   pure function known_types() result(text)
      character(len=5 + width_of(size(joint_types))) :: text

      text = '1 to '//str(size(joint_types))
   end function known_types

end module kj_joint_types
