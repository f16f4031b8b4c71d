!> What a host may change between the steps of a scene.
submodule (kjoint:kjoint_step) kjoint_change
   use kj_scheme, only: load_body, move_body, put_body, lock_place
   implicit none

contains

   module procedure set_body_load
      integer :: b

      call find_body(sim, id, b, error)
      if (.not. allocated(error)) call check_values([force, moment], error)
      if (.not. allocated(error)) call load_body(b, force, moment, sim%model, sim%scheme)
   end procedure set_body_load

   module procedure set_load_factor
      integer :: i

      call check_started(sim, error)
      if (.not. allocated(error)) call check_values([factor], error)
      if (allocated(error)) return
      i = findloc(sim%model%cload%id, id, 1)
      if (i > 0) sim%model%cload(i)%y_scale = factor*sim%load_scale(i)
      if (i == 0) call fail(error, ERR_INPUT, 'there is no concentrated load '//str(id))
   end procedure set_load_factor

   module procedure set_body_velocity
      integer :: b

      call find_body(sim, id, b, error)
      if (.not. allocated(error)) call check_values([velocity, omega], error)
      if (.not. allocated(error)) call move_body(b, velocity, omega, sim%model, sim%scheme)
   end procedure set_body_velocity

   module procedure set_body_pose
      integer :: b

      call find_body(sim, id, b, error)
      if (.not. allocated(error)) call check_values([position, attitude], error)
      if (.not. allocated(error)) call put_body(b, position, attitude, sim%model, sim%scheme, error)
   end procedure set_body_pose

   module procedure lock_joint
      real(wp) :: t_lock
      integer :: j

      call find_joint(sim, id, j, error)
      if (allocated(error)) return
      t_lock = huge(1.0_wp)
      if (locked) t_lock = sim%scheme%now%time
      associate (ref => sim%model%joint(j))
         if (.not. sim%model%batch(ref%batch)%limited) then
            call fail(error, ERR_INPUT, 'joint '//str(id)//' cannot lock: it is no '// &
               '/PROP/KJOINT2 with stops, friction or a sensor')
            return
         end if
         call lock_place(ref%batch, ref%place, t_lock, sim%model, sim%scheme)
      end associate
   end procedure lock_joint

   subroutine check_values(values, error)
      real(wp), intent(in) :: values(:)
      type(error_t), allocatable, intent(out) :: error

      if (.not. all(ieee_is_finite(values))) call fail(error, ERR_INPUT, 'a value is not finite')
   end subroutine check_values

end submodule kjoint_change
