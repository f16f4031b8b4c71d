!> What a host may change between the steps of a scene.
submodule (kjoint:kjoint_step) kjoint_change
   use kj_consistent_build, only: settle
   use kj_host_start, only: turned
   implicit none

contains

   module procedure set_body_load
      integer :: b

      call find_body(sim, id, b, error)
      if (.not. allocated(error)) call check_values([force, moment], error)
      if (allocated(error)) return
      associate (n => sim%model%n_lead)
         if (.not. allocated(sim%state%f_host)) then
            allocate (sim%state%f_host(n, 3), sim%state%m_host(n, 3), source=0.0_wp)
            if (.not. sim%legacy) allocate (sim%c_state%f_host(n, 3), sim%c_state%t_host(n, 3), &
               sim%c_state%f_host_old(n, 3), sim%c_state%t_host_old(n, 3), source=0.0_wp)
         end if
      end associate
      sim%state%f_host(b, :) = force
      sim%state%m_host(b, :) = moment
      if (sim%legacy) return
      call change_host_load(sim, b, force, moment)
   end procedure set_body_load

   !> The force now there changes, too, so that the first half kick has it; not the ledger
   subroutine change_host_load(sim, b, force, moment)
      type(simulation_t), intent(inout) :: sim
      integer, intent(in) :: b
      real(wp), intent(in) :: force(3), moment(3)

      real(wp) :: more(3), turn(3), before

      associate (s => sim%c_state)
         call balance_ledger(sim%model, s)
         before = s%error*s%scale
         more = force - s%f_host(b, :)
         turn = moment - s%t_host(b, :)
         s%f(b, :) = s%f(b, :) + more
         s%own_f(b, :) = s%own_f(b, :) + more
         s%t(b, :) = s%t(b, :) + turn
         s%own_t(b, :) = s%own_t(b, :) + turn
         s%f_host(b, :) = force
         s%t_host(b, :) = moment
         s%f_host_old(b, :) = force
         s%t_host_old(b, :) = moment
         call balance_ledger(sim%model, s)
         s%offset = s%offset - (s%error*s%scale - before)
      end associate
      call renew_published(sim)
   end subroutine change_host_load

   module procedure set_load_factor
      integer :: i

      call check_started(sim, error)
      if (.not. allocated(error)) call check_values([factor], error)
      if (allocated(error)) return
      do i = 1, size(sim%model%cload)
         if (sim%model%cload(i)%id /= id) cycle
         sim%model%cload(i)%y_scale = factor*sim%load_scale(i)
         return
      end do
      call fail(error, ERR_INPUT, 'there is no concentrated load '//str(id))
   end procedure set_load_factor

   module procedure set_body_velocity
      real(wp) :: p(3, 3)
      integer :: b

      call find_body(sim, id, b, error)
      if (.not. allocated(error)) call check_values([velocity, omega], error)
      if (allocated(error)) return
      if (sim%legacy) then
         sim%state%v(b, :) = velocity
         sim%state%world%w(b, :) = omega
         sim%state%fastest = max(sim%state%fastest, dot_product(omega, omega))
      else
         p = reshape(columns(sim%c_state%poses%quat(b, :)), [3, 3])
         sim%c_state%v(b, :) = velocity
         sim%c_state%l(b, :) = matmul(p, sim%model%spin_inertia(b, :)*matmul(omega, p))
         call start_anew(sim)
      end if
   end procedure set_body_velocity

   module procedure set_body_pose
      integer :: b

      call find_body(sim, id, b, error)
      if (.not. allocated(error)) call check_values([position, attitude], error)
      if (allocated(error)) return
      if (sim%legacy) then
         call fail(error, ERR_INPUT, &
            'the legacy formulation sums up its frames: a body cannot be put elsewhere')
      else if (.not. norm2(attitude) > 0.0_wp) then
         call fail(error, ERR_INPUT, 'the quaternion is zero')
      else
         associate (p => sim%c_state%poses)
            p%d(b, :) = position - sim%model%x0(b, :)
            p%x(b, :) = position
            p%quat(b, :) = turned(attitude, sim%model%quat0(b, :))
         end associate
         call start_anew(sim)
      end if
   end procedure set_body_pose

   module procedure lock_joint
      real(wp) :: t_lock, t_free
      integer :: j

      call find_joint(sim, id, j, error)
      if (allocated(error)) return
      t_lock = huge(1.0_wp)
      t_free = huge(1.0_wp)
      if (locked) t_lock = sim%state%time
      associate (ref => sim%model%joint(j))
         if (.not. sim%model%batch(ref%batch)%limited) then
            call fail(error, ERR_INPUT, 'joint '//str(id)//' cannot lock: it is no '// &
               '/PROP/KJOINT2 with stops, friction or a sensor')
            return
         end if
         associate (limit => sim%model%batch(ref%batch)%limit)
            limit%t_lock(ref%place) = t_lock
            limit%t_free(ref%place) = t_free
         end associate
         sim%state%joint(ref%batch)%locked(ref%place) = .false.
         if (sim%legacy) return
         associate (limit => sim%model%batch(ref%batch)%limit)
            limit%t_lock(ref%place) = t_lock
            limit%t_free(ref%place) = t_free
         end associate
         associate (joint => sim%c_state%joint(ref%batch))
            joint%limit(block_of(ref%place))%locked(lane_of(ref%place)) = 0.0_wp
         end associate
      end associate
      call start_march(sim%model, sim%c_state, sim%march)
   end procedure lock_joint

   subroutine check_values(values, error)
      real(wp), intent(in) :: values(:)
      type(error_t), allocatable, intent(out) :: error

      if (.not. all(ieee_is_finite(values))) call fail(error, ERR_INPUT, 'a value is not finite')
   end subroutine check_values

   !> Forces of a consistent scene after a change; what it does to the energy is external work
   subroutine start_anew(sim)
      type(simulation_t), intent(inout) :: sim

      real(wp) :: before, scale

      associate (s => sim%c_state)
         call balance_ledger(sim%model, s)
         before = s%error*s%scale
         s%poses%psi = 0.0_wp
         call settle(sim%model, s)
         call balance_ledger(sim%model, s)
         scale = s%scale
         s%work = s%work + s%error*scale - before
         call start_march(sim%model, s, sim%march)
      end associate
      call renew_published(sim)
   end subroutine start_anew

end submodule kjoint_change
