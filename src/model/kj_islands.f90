!> Islands: parts of a scene that do not act on each other.
!>
!> Joints and springs tie the leads of their ends together. So does a moving skew that a load, a
!> condition or an imposed motion reads: it ties the lead that it acts on to those on which the skew
!> rides. Ground, that is leads blocked in all six directions, ties nothing: it does not move,
!> whatever acts on it. A driven lead is not ground. Sensors and functions know time alone.
module kj_islands
   use kj_kinds, only: wp
   use kj_sort, only: find_root
   use kj_model, only: model_t, load_t
   implicit none
   private

   public :: find_islands, element_leads, island_steps

contains

   !> Number the islands by their first leads
   pure subroutine find_islands(model, island, n)
      type(model_t), intent(in) :: model
      integer, allocatable, intent(out) :: island(:)   !! (n_lead) 1..n, 0 for ground
      integer, intent(out) :: n

      integer :: parent(model%n_lead), i
      logical :: ground(model%n_lead)

      parent = [(i, i=1, model%n_lead)]
      ground = ground_of(model)
      call tie_elements(model, ground, parent)
      do i = 1, size(model%gravity)
         call tie_load(model, ground, model%gravity(i), parent)
      end do
      do i = 1, size(model%cload)
         call tie_load(model, ground, model%cload(i), parent)
      end do
      do i = 1, size(model%bcs)
         call tie_skew(model, ground, model%bcs(i)%skew, model%bcs(i)%lead, parent)
      end do
      do i = 1, size(model%motion)
         call tie_skew(model, ground, model%motion(i)%skew, model%motion(i)%lead, parent)
      end do
      allocate (island(model%n_lead), source=0)
      n = 0
      do i = 1, model%n_lead
         if (ground(i)) cycle
         if (parent(i) == i) n = n + 1
         island(i) = n
         if (parent(i) < i) island(i) = island(parent(i))   ! parents come first
      end do
   end subroutine find_islands

   !> Leads with all six directions blocked, along axes that stay, and not driven.
   !>
   !> A load along a moving skew would show in the reactions of such a lead: then it counts as free.
   pure function ground_of(model) result(ground)
      type(model_t), intent(in) :: model
      logical :: ground(model%n_lead)

      integer :: i

      ground = .false.
      do i = 1, size(model%bcs)
         if (.not. all(model%bcs(i)%fixed)) cycle
         ground(model%bcs(i)%lead) = .not. rides(model, model%bcs(i)%skew)
      end do
      ground(model%motion%lead) = .false.
      do i = 1, size(model%gravity)
         if (rides(model, model%gravity(i)%skew)) ground(model%gravity(i)%node) = .false.
      end do
      do i = 1, size(model%cload)
         if (rides(model, model%cload(i)%skew)) ground(model%lead(model%cload(i)%node)) = .false.
      end do
   end function ground_of

   !> A skew that moves with its nodes
   pure logical function rides(model, skew)
      type(model_t), intent(in) :: model
      integer, intent(in) :: skew

      rides = .false.
      if (skew > 0) rides = model%skews%dir(skew) > 0
   end function rides

   !> Leads of all joints and springs: (2, n_element), in the order of the batches
   pure function element_leads(model) result(ends)
      type(model_t), intent(in) :: model
      integer :: ends(2, model%n_element)

      integer :: b

      do b = 1, size(model%batch)
         associate (batch => model%batch(b))
            ends(:, batch%first + 1:batch%first + batch%n) = transpose(batch%lead)
         end associate
      end do
   end function element_leads

   !> The longest step that the joints and springs of each island allow; huge: they allow any
   pure function island_steps(model, island, n, step) result(least)
      type(model_t), intent(in) :: model
      integer, intent(in) :: island(:), n
      real(wp), intent(in) :: step(:)            !! (n_element) step that each allows
      real(wp) :: least(n)

      integer :: ends(2, model%n_element), i, j, e

      ends = element_leads(model)
      least = huge(1.0_wp)
      do j = 1, model%n_element
         do e = 1, 2
            i = island(ends(e, j))
            if (i > 0) least(i) = min(least(i), step(j))
         end do
      end do
   end function island_steps

   pure subroutine tie_elements(model, ground, parent)
      type(model_t), intent(in) :: model
      logical, intent(in) :: ground(:)
      integer, intent(inout) :: parent(:)

      integer :: ends(2, model%n_element), j

      ends = element_leads(model)
      do j = 1, model%n_element
         call tie(ground, ends(1, j), ends(2, j), parent)
      end do
   end subroutine tie_elements

   pure subroutine tie_load(model, ground, load, parent)
      type(model_t), intent(in) :: model
      logical, intent(in) :: ground(:)
      type(load_t), intent(in) :: load
      integer, intent(inout) :: parent(:)

      integer :: k

      do k = 1, size(load%node)
         call tie_skew(model, ground, load%skew, model%lead(load%node(k)), parent)
      end do
   end subroutine tie_load

   pure subroutine tie_skew(model, ground, skew, lead, parent)
      type(model_t), intent(in) :: model
      logical, intent(in) :: ground(:)
      integer, intent(in) :: skew, lead
      integer, intent(inout) :: parent(:)

      integer :: k

      if (.not. rides(model, skew)) return
      do k = 1, 3
         call tie(ground, lead, model%lead(model%skews%node(k, skew)), parent)
      end do
   end subroutine tie_skew

   !> One island of two leads: the root with the lower number stays
   pure subroutine tie(ground, a, b, parent)
      logical, intent(in) :: ground(:)
      integer, intent(in) :: a, b
      integer, intent(inout) :: parent(:)

      integer :: root_a, root_b

      if (ground(a) .or. ground(b)) return
      call find_root(a, parent, root_a)
      call find_root(b, parent, root_b)
      parent(max(root_a, root_b)) = min(root_a, root_b)
   end subroutine tie

end module kj_islands
