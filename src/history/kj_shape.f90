!> What a picture of the rigid bodies needs beside their motion: points that they carry, and which
!> of them to join.
module kj_shape
   use kj_model, only: model_t
   use kj_history, only: shape_t
   implicit none
   private

   public :: describe_shape

contains

   !> Centres and nodes of the bodies of the history; a segment from the centre to each node that a
   !> joint or spring holds
   pure subroutine describe_shape(model, shape)
      type(model_t), intent(in) :: model
      type(shape_t), intent(out) :: shape

      logical :: shown(model%n_node), held(model%n_node)
      integer :: place(model%n_node), owner, i, n

      shown = .false.
      shown(model%th_body) = .true.
      shown = shown(model%lead)                  ! a body is the lead of its nodes, and of itself
      held = .false.
      do i = 1, model%n_element
         held(model%joint(i)%node) = .true.
      end do
      n = 0
      do i = 1, model%n_node
         if (.not. shown(i)) cycle
         n = n + 1
         place(i) = n
      end do
      allocate (shape%body(n), shape%node(n), shape%point(3, n))
      allocate (shape%segment(2, count(shown(model%n_lead + 1:) .and. held(model%n_lead + 1:))))
      n = 0
      do i = 1, model%n_node
         if (.not. shown(i)) cycle
         owner = model%lead(i)
         shape%body(place(i)) = model%body_id(owner)
         shape%node(place(i)) = model%node_id(i)
         shape%point(:, place(i)) = model%x0(i, :) - model%x0(owner, :)
         if (i == owner .or. .not. held(i)) cycle
         n = n + 1
         shape%segment(:, n) = [place(owner), place(i)]
      end do
   end subroutine describe_shape

end module kj_shape
