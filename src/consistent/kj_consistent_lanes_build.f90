!> Room for scenes side by side (kj_consistent_lanes)
module kj_consistent_lanes_build
   use, intrinsic :: iso_c_binding, only: c_loc
   use kj_kinds, only: wp
   use kj_block, only: BLOCK, block_of, lane_of, clear
   use kj_joint_batch, only: joint_batch_t
   use kj_lead_map, only: build_lead_map, N_SUM
   use kj_gravity, only: new_gravity
   use kj_consistent_matrix, only: N_CONSISTENT_WRENCH
   use kj_consistent_state, only: consistent_model_t, consistent_state_t, row_t
   use kj_consistent_lanes, only: lanes_t, seat
   implicit none
   private

   public :: new_lanes

contains

   !> Room for scenes as this one; in all places it
   subroutine new_lanes(model, state, lanes)
      type(consistent_model_t), intent(in) :: model
      type(consistent_state_t), intent(inout) :: state     !! is not changed
      type(lanes_t), intent(out) :: lanes

      integer, allocatable :: ends(:, :)
      integer :: b, i, s, at

      associate (w => lanes%model)
         w%n_lead = BLOCK*model%n_lead
         w%n_body = BLOCK*model%n_body
         w%n_element = BLOCK*model%n_element
         w%damped = model%damped
         w%curves = model%curves
         w%rests = [((model%rests(i), s=1, BLOCK), i=1, model%n_lead)]
         w%steady = model%steady
         allocate (w%motion(BLOCK*size(model%motion)), w%cload(0), w%placed(0))
         w%gravity = model%gravity
         allocate (w%batch(size(model%batch)), ends(2, w%n_element))
         do b = 1, size(model%batch)
            call new_batch(model%batch(b), w%batch(b))
            associate (first => w%batch(b)%first)
               ends(:, first + 1:first + w%batch(b)%n) = transpose(w%batch(b)%lead)
            end associate
         end do
         call build_lead_map(w%n_lead, ends, w%map)
         w%map%abreast = .true.
         call new_holds(model, w)
         w%team%threads = 1
         w%team%lanes = BLOCK
         at = sum((model%batch%n))
         allocate (w%team%lead(2, model%n_lead), w%team%joint(3, at))
      end associate
      call new_state(model, lanes%model, state, lanes%state)
      do s = 1, BLOCK
         call seat(model, state, s, lanes)
      end do
   end subroutine new_lanes

   !> A batch for 64 scenes, without its numbers
   subroutine new_batch(one, wide)
      type(joint_batch_t), intent(in) :: one
      type(joint_batch_t), intent(out) :: wide

      integer :: i

      wide%n = BLOCK*one%n
      wide%first = BLOCK*one%first
      wide%row = one%row
      wide%frame = one%frame
      wide%law = one%law
      wide%kind = one%kind
      wide%limited = one%limited
      wide%abreast = .true.
      allocate (wide%lead(wide%n, 2))
      do i = 1, wide%n
         wide%lead(i, :) = BLOCK*(one%lead(block_of(i), :) - 1) + lane_of(i)
      end do
      if (allocated(one%spring)) allocate (wide%spring(wide%n))
      wide%geometry%chart = one%geometry%chart
      wide%geometry%mean = one%geometry%mean
      wide%geometry%ball = one%geometry%ball
      wide%geometry%sprung = one%geometry%sprung
      wide%geometry%damped = one%geometry%damped
      wide%geometry%shifted = one%geometry%shifted
      wide%geometry%implicit = one%geometry%implicit
   end subroutine new_batch

   !> Conditions of 64 scenes, by ascending lead
   subroutine new_holds(model, wide)
      type(consistent_model_t), intent(in) :: model
      type(consistent_model_t), intent(inout) :: wide

      integer :: i, s, k

      allocate (wide%hold(BLOCK*size(model%hold)), wide%hold_to(0:model%n_lead))
      allocate (wide%mover(2, model%n_lead), source=0)
      wide%hold_to(0) = 0
      do i = 1, model%n_lead
         if (.not. model%rests(i)) wide%mover(:, i) = [BLOCK*(i - 1) + 1, BLOCK*i]
         wide%hold_to(i) = BLOCK*count(model%hold%lead <= i)
      end do
      do i = 1, size(wide%hold)
         s = lane_of(i)
         wide%hold(i) = model%hold(block_of(i))
         associate (h => wide%hold(i))
            h%lead = BLOCK*(h%lead - 1) + s
            do k = 1, 3
               call place_row(h%trans(k))
               call place_row(h%rot(k))
            end do
         end associate
      end do

   contains

      pure subroutine place_row(row)
         type(row_t), intent(inout) :: row

         if (row%skew > 0) row%skew = (s - 1)*model%skews%n + row%skew
         if (row%motion > 0) row%motion = BLOCK*(row%motion - 1) + s
      end subroutine place_row
   end subroutine new_holds

   subroutine new_state(model, wide, one, state)
      type(consistent_model_t), intent(in) :: model, wide
      type(consistent_state_t), intent(in) :: one
      type(consistent_state_t), target, intent(inout) :: state

      integer :: b, i, s, k, m

      associate (n => wide%n_lead, p => state%poses)
         allocate (p%x(n, 3), p%d(n, 3), p%quat(n, 4), p%v(n, 3), p%w(n, 3), p%w_left(n, 3), &
            p%psi(n, 3), p%im(n), p%ij(n, 6), state%v(n, 3), state%l(n, 3), state%f(n, 3), &
            state%t(n, 3), state%own_f(n, 3), state%own_t(n, 3), source=0.0_wp)
         allocate (state%impulse(wide%n_body, 3), state%angular_impulse(wide%n_body, 3), &
            state%turn(wide%n_body, 3), state%skew(0:BLOCK*model%skews%n, 9), &
            state%part(N_SUM, wide%map%part(size(wide%map%part)) - 1), &
            state%wrench(N_CONSISTENT_WRENCH, wide%n_element), source=0.0_wp)
         m = size(wide%motion)
         allocate (state%mean(m), state%final(m), state%motion_at(m), source=0.0_wp)
         allocate (state%active(m), source=.false.)
         m = size(wide%hold)
         allocate (state%kept%rates(6, m), state%kept%quat(4, m), state%kept%w(3, m), &
            state%kept%work(2, m, size(one%kept%work, 3)), source=0.0_wp)
      end associate
      state%skew(0, :) = one%skew(0, :)
      state%cycle = 1
      allocate (state%joint(size(one%joint)))
      do b = 1, size(one%joint)
         associate (n => model%batch(b)%n, joint => state%joint(b))
            allocate (joint%block(n))
            do i = 1, n
               call clear(c_loc(joint%block(i)), storage_size(joint%block))
            end do
            if (allocated(one%joint(b)%limit)) allocate (joint%limit(n))
            if (allocated(one%joint(b)%spring)) allocate (joint%spring(n))
         end associate
      end do
      allocate (state%field(size(model%gravity)))
      do i = 1, size(model%gravity)
         associate (node => model%gravity(i)%node)
            call new_gravity([((BLOCK*(node(k) - 1) + s, s=1, BLOCK), k=1, size(node))], &
               wide%n_lead, state%field(i))
            allocate (state%field(i)%each(BLOCK*size(node), 3), source=0.0_wp)
         end associate
      end do
   end subroutine new_state

end module kj_consistent_lanes_build
