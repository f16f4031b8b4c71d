!> The states of the parts of a scene put together, as if it had marched as one.
module kj_consistent_gather
   use kj_kinds, only: wp
   use kj_block, only: BLOCK
   use kj_consistent_batch, only: consistent_joint_t, matrix_of
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_march, only: march_t, balance_ledger, close_ledger
   use kj_cut_model, only: cut_t
   use kj_consistent_islands, only: part_t
   implicit none
   private

   public :: gather_parts, gather_clock, joint_cycles

contains

   !> State, clock and ledger of the scene. All parts must stand at the same time.
   subroutine gather_parts(model, part, state, march)
      type(consistent_model_t), intent(in) :: model
      type(part_t), intent(inout) :: part(:)
      type(consistent_state_t), intent(inout) :: state
      type(march_t), intent(inout) :: march

      integer :: p

      state%f = 0.0_wp
      state%t = 0.0_wp
      state%own_f = 0.0_wp
      state%own_t = 0.0_wp
      state%impulse = 0.0_wp
      state%angular_impulse = 0.0_wp
      state%work = 0.0_wp
      state%energy = 0.0_wp
      do p = 1, size(part)
         call balance_ledger(part(p)%model, part(p)%state)
         call gather_leads(part(p)%cut, part(p)%state, state)
         call gather_joints(part(p)%cut, part(p)%model, model, part(p)%state, state)
         state%work = state%work + part(p)%state%work
         state%energy = state%energy + part(p)%state%energy
      end do
      call gather_clock(part, state, march)
      if (state%cycle == 0) state%scale = sum(part%state%scale)
      call close_ledger(sum(part%state%change), state)
   end subroutine gather_parts

   !> Cycles and step of the part with the shortest step, and who holds it; the time that all parts
   !> have reached
   subroutine gather_clock(part, state, march)
      type(part_t), intent(in) :: part(:)
      type(consistent_state_t), intent(inout) :: state
      type(march_t), intent(inout) :: march

      integer :: p

      p = minloc(part%march%limit, dim=1)
      state%time = minval(part%state%time)
      state%cycle = maxval(part%state%cycle)
      state%h = part(p)%state%h
      march%limit = part(p)%march%limit
      march%joint = 0
      if (part(p)%march%joint > 0) march%joint = part(p)%cut%element(part(p)%march%joint)
   end subroutine gather_clock

   !> Poses, momenta and loads of the leads. Ground stands in many parts at the same place; what the
   !> joints of each part do to it adds up.
   subroutine gather_leads(cut, from, state)
      type(cut_t), intent(in) :: cut
      type(consistent_state_t), intent(in) :: from
      type(consistent_state_t), intent(inout) :: state

      associate (l => cut%lead, body => cut%lead(:size(from%turn, 1)))
         state%poses%x(l, :) = from%poses%x
         state%poses%d(l, :) = from%poses%d
         state%poses%quat(l, :) = from%poses%quat
         state%v(l, :) = from%v
         state%l(l, :) = from%l
         state%turn(body, :) = from%turn
         state%f(l, :) = state%f(l, :) + from%f
         state%t(l, :) = state%t(l, :) + from%t
         state%own_f(l, :) = state%own_f(l, :) + from%own_f
         state%own_t(l, :) = state%own_t(l, :) + from%own_t
         state%impulse(body, :) = state%impulse(body, :) + from%impulse
         state%angular_impulse(body, :) = state%angular_impulse(body, :) + from%angular_impulse
      end associate
      state%skew(cut%skew, :) = from%skew(1:, :)
   end subroutine gather_leads

   subroutine gather_joints(cut, section, model, from, state)
      type(cut_t), intent(in) :: cut
      type(consistent_model_t), intent(in) :: section, model   !! of the part, of the scene
      type(consistent_state_t), intent(in) :: from
      type(consistent_state_t), intent(inout) :: state

      integer :: b, last, there

      last = 0
      do b = 1, size(cut%batch)
         there = cut%batch(b)
         associate (n => section%batch(b)%n)
            call gather_batch(from%joint(b), cut%element(last + 1:last + n) - &
               model%geometry(there)%first, model%geometry(there)%limited, state%joint(there))
            last = last + n
         end associate
      end do
   end subroutine gather_joints

   !> Joints of one batch to their places in that of the scene
   pure subroutine gather_batch(from, place, limited, to)
      type(consistent_joint_t), intent(in) :: from
      integer, intent(in) :: place(:)
      logical, intent(in) :: limited
      type(consistent_joint_t), intent(inout) :: to

      integer :: i, k

      to%q(place, :) = from%q
      to%qd(place, :) = from%qd
      to%fe(place, :) = from%fe
      to%fd(place, :) = from%fd
      to%elastic(place) = from%elastic
      to%dissipated(place) = from%dissipated
      do i = 1, size(place)
         k = place(i) - 1
         to%b(modulo(k, BLOCK) + 1, :, k/BLOCK + 1) = matrix_of(from, i)
      end do
      if (.not. limited) return
      to%friction(place, :) = from%friction
      to%grip(place, :) = from%grip
      to%slip_energy(place) = from%slip_energy
      to%stored(place) = from%stored
      to%locked(place) = from%locked
      to%q_lock(place, :) = from%q_lock
      to%flag(place, :) = from%flag
   end subroutine gather_batch

   !> Steps of all joints so far
   pure real(wp) function joint_cycles(part) result(n)
      type(part_t), intent(in) :: part(:)

      integer :: p

      n = 0.0_wp
      do p = 1, size(part)
         n = n + real(part(p)%state%cycle, wp)*part(p)%model%n_joint
      end do
   end function joint_cycles

end module kj_consistent_gather
