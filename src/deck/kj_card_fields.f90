!> THE table of fields of all cards, and the layout of one block: which field stands where.
!>
!> The reader, `kjoint list keywords` and the manual are all driven by this table.
module kj_card_fields
   use kj_units, only: D_NUMBER, D_LENGTH, D_STIFFNESS, D_ROT_STIFFNESS, D_DAMPING, D_ROT_DAMPING, &
      D_FORCE, D_MOMENT, D_VELOCITY, D_ANGULAR_VELOCITY
   use kj_card_field, only: field_t, EACH
   use kj_card_fields_joint, only: joint_fields, property_fields
   use kj_card_fields_scene, only: scene_fields
   use kj_card_fields_load, only: load_fields
   use kj_keywords, only: KW_SPRING8, N_KEYWORD
   use kj_joint_types, only: joint_types, find_joint_type, NDOF
   implicit none
   private

   public :: field_range, list_free_dofs, rotational, has_variant

   !> All fields; those of one keyword stand together
   type(field_t), parameter, public :: fields(*) = &
      [joint_fields, property_fields, scene_fields, load_fields]

contains

   !> First and last row of each keyword in the table of fields; 1 and 0 when it has none
   pure subroutine field_range(first, last)
      integer, intent(out) :: first(N_KEYWORD), last(N_KEYWORD)

      integer :: i, k

      first = 1
      last = 0
      do i = 1, size(fields)
         k = fields(i)%keyword
         if (last(k) == 0) first(k) = i
         last(k) = i
      end do
   end subroutine field_range

   !> The keyword has fields for this type in the header
   pure logical function has_variant(keyword, variant)
      integer, intent(in) :: keyword, variant

      has_variant = any(fields%keyword == keyword .and. &
         (fields%variant == variant .or. fields%variant == EACH))
   end function has_variant

   !> Directions whose cards (times = DOFS) stand in a block
   pure subroutine list_free_dofs(keyword, joint_type, n, dof)
      integer, intent(in) :: keyword           !! KW_KJOINT2 or KW_SPRING8
      integer, intent(in) :: joint_type        !! of KJOINT2; 0 directions when there is none
      integer, intent(out) :: n, dof(NDOF)     !! the first n are set: 1 tx, ..., 6 rz

      integer :: i, row

      n = 0
      dof = 0
      row = find_joint_type(joint_type)
      do i = 1, NDOF
         if (keyword /= KW_SPRING8) then
            if (row == 0) return
            if (joint_types(row)%free(i) == 0) cycle
         end if
         n = n + 1
         dof(n) = i
      end do
   end subroutine list_free_dofs

   !> Dimension of a field for a rotation, given that for a translation
   pure integer function rotational(dim) result(other)
      integer, intent(in) :: dim               !! D_ constant

      integer, parameter :: PAIR(2, 5) = reshape([D_LENGTH, D_NUMBER, D_STIFFNESS, &
         D_ROT_STIFFNESS, D_DAMPING, D_ROT_DAMPING, D_FORCE, D_MOMENT, D_VELOCITY, &
         D_ANGULAR_VELOCITY], [2, 5])
      integer :: i

      other = dim
      do i = 1, size(PAIR, 2)
         if (PAIR(1, i) == dim) other = PAIR(2, i)
      end do
   end function rotational

end module kj_card_fields
