!> Columns of a state -> the entities of a history, a whole variable at a time.
module kj_take
   use kj_kinds, only: wp
   use kj_model, only: model_t
   implicit none
   private

   public :: roster_t, new_roster, new_rosters, take, take_block

   !> Entities of a history whose values stand in the same arrays
   type :: roster_t
      integer :: batch = 0                       !! of joints and springs
      integer :: row = 0                         !! of kj_joint_types, of joints and springs
      integer, allocatable :: place(:)           !! in the arrays of the state
      integer, allocatable :: entity(:)          !! in the history
   end type roster_t

   !> Fill what a variable has of the entities of a roster, from columns or from one
   interface take
      module procedure take_columns, take_column
   end interface take

contains

   !> The entities of a history in their order
   pure subroutine new_roster(place, roster)
      integer, intent(in) :: place(:)
      type(roster_t), intent(out) :: roster

      integer :: k

      roster%place = place
      roster%entity = [(k, k=1, size(place))]
   end subroutine new_roster

   !> Joints or springs of a history by batches
   pure subroutine new_rosters(model, joint, roster)
      type(model_t), intent(in) :: model
      integer, intent(in) :: joint(:)            !! the elements of the history
      type(roster_t), allocatable, intent(out) :: roster(:)

      integer :: b, k, n
      integer :: of(size(model%batch)), place(size(joint)), batch(size(joint)), filled(size(joint))

      batch = model%joint(joint)%batch
      place = model%joint(joint)%place
      of = 0
      n = 0
      do k = 1, size(joint)
         of(batch(k)) = of(batch(k)) + 1
         if (of(batch(k)) == 1) n = n + 1
      end do
      allocate (roster(n))
      n = 0
      do b = 1, size(of)
         if (of(b) == 0) cycle
         n = n + 1
         allocate (roster(n)%place(of(b)), roster(n)%entity(of(b)))
         roster(n)%batch = b
         roster(n)%row = model%batch(b)%row
         of(b) = n
      end do
      filled = 0
      do k = 1, size(joint)
         associate (r => roster(of(batch(k))), i => filled(of(batch(k))))
            i = i + 1
            r%place(i) = place(k)
            r%entity(i) = k
         end associate
      end do
   end subroutine new_rosters

   pure subroutine take_columns(from, roster, y)
      real(wp), contiguous, intent(in) :: from(:, :)     !! (places, components)
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)     !! (components, entities)

      integer :: c, i

      if (size(y, 1) == 3) then
         do i = 1, size(roster%place)
            associate (j => roster%place(i), k => roster%entity(i))
               y(1, k) = from(j, 1)
               y(2, k) = from(j, 2)
               y(3, k) = from(j, 3)
            end associate
         end do
         return
      end if
      do c = 1, size(y, 1)
         do i = 1, size(roster%place)
            y(c, roster%entity(i)) = from(roster%place(i), c)
         end do
      end do
   end subroutine take_columns

   pure subroutine take_column(from, roster, y)
      real(wp), contiguous, intent(in) :: from(:)        !! (places)
      type(roster_t), intent(in) :: roster
      real(wp), contiguous, intent(inout) :: y(:, :)     !! (1, entities)

      integer :: i

      do i = 1, size(roster%place)
         y(1, roster%entity(i)) = from(roster%place(i))
      end do
   end subroutine take_column

   !> Columns of some places, to work on them together; the rest of the block stays
   pure subroutine take_block(from, place, block)
      real(wp), contiguous, intent(in) :: from(:, :)     !! (places, components)
      integer, contiguous, intent(in) :: place(:)
      real(wp), contiguous, intent(inout) :: block(:, :)    !! (places at a time, components)

      integer :: c, i

      do c = 1, size(block, 2)
         do i = 1, size(place)
            block(i, c) = from(place(i), c)
         end do
      end do
   end subroutine take_block

end module kj_take
