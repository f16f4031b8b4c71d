!> Many runs side by side: small scenes of one topology take their steps together
!> (kj_consistent_lanes), all others run one after the other. Source: docs/sweep.md.
submodule (kjoint:kjoint_run) kjoint_beside
   use kj_block, only: BLOCK
   use kj_consistent_topology, only: is_small, same_topology
   use kj_consistent_lanes, only: lanes_t, seat, step_lanes, take_out, take_coordinates
   use kj_consistent_lanes_build, only: new_lanes
   use kj_consistent_march, only: EVERY => LOOK, LIEMID, spell, count_steps, is_calm, look_ahead, &
      arrive, is_too_short
   use kj_scheme, only: begin_way, end_way
   implicit none

   !> A place of the lanes
   type :: place_t
      integer :: run = 0                         !! who has it
      integer :: left = 0                        !! steps until its monitor looks
      integer :: now = 0, to_go = 0              !! steps of its spell, and those left of it
      real(wp) :: h = 0.0_wp
   end type place_t

   !> The lanes and who is there
   type :: rows_t
      type(lanes_t) :: lanes
      integer :: first = 0                       !! run that they were made for
      integer :: n = 0                           !! places taken
      type(place_t) :: place(BLOCK)
      type(course_t), allocatable :: course(:)   !! of each run
   end type rows_t

contains

   module procedure run_simulations
      type(rows_t) :: self
      integer :: next, steps, i

      allocate (self%course(size(run)))
      next = 1
      do
         do while (self%n < BLOCK .and. next <= size(run))
            call begin(next, run, monitor, self)
            next = next + 1
         end do
         if (self%n == 0) exit
         associate (place => self%place(:self%n))
            steps = minval(place%to_go)
            call step_lanes(run(self%first)%sim%scheme%integrator == LIEMID, self%n, steps, &
               place%h, self%lanes)
            place%to_go = place%to_go - steps
         end associate
         do i = self%n, 1, -1
            if (self%place(i)%to_go == 0) call attend(i, run, monitor, self)
         end do
      end do
   end procedure run_simulations

   !> Give a run a place, or run it by itself
   subroutine begin(r, run, monitor, self)
      integer, intent(in) :: r
      type(beside_t), intent(inout) :: run(:)
      class(monitor_t), intent(inout) :: monitor
      type(rows_t), intent(inout) :: self

      integer :: left
      logical :: beside

      associate (a => run(r), scheme => run(r)%sim%scheme)
         call open_run(a%sim, a%sink, a%error)
         if (allocated(a%error)) return
         call begin_run(a%sim, self%course(r), a%status, a%error)
         if (.not. allocated(a%error)) then
            beside = may_march(a%sim)
            if (beside .and. self%first > 0) beside = &
               scheme%integrator == run(self%first)%sim%scheme%integrator .and. &
               same_topology(a%sim%model, run(self%first)%sim%model)
            if (.not. beside) &
               call run_on(a%sim, a%sink, monitor, self%course(r), a%status, a%error)
         end if
         call set_off(a, monitor, self%course(r), left)
         if (left == 0) return
         if (self%first == 0) call new_lanes(a%sim%model, scheme%state, self%lanes)
         if (self%first == 0) self%first = r
         self%n = self%n + 1
         call seat(a%sim%model, scheme%state, self%n, self%lanes)
         self%place(self%n)%run = r
         call start_spell(a%sim, left, self%place(self%n))
      end associate
   end subroutine begin

   !> Others may take the steps of a scene
   pure logical function may_march(sim)
      type(simulation_t), intent(in) :: sim

      may_march = .false.
      if (sim%scheme%legacy) return
      if (sim%scheme%integrator > LIEMID .or. size(sim%scheme%part) > 0) return
      may_march = is_small(sim%model, sim%scheme%state)
   end function may_march

   !> Samples where a run stands, and the beginning of its next way; or its end
   subroutine set_off(run, monitor, course, left)
      type(beside_t), intent(inout) :: run
      class(monitor_t), intent(inout) :: monitor
      type(course_t), intent(inout) :: course
      integer, intent(out) :: left               !! steps that may be taken; 0: it is over

      left = 0
      do while (.not. (allocated(run%error) .or. course%over))
         call visit(run%sim, run%sink, monitor, course, run%status, run%error)
         if (course%over .or. allocated(run%error)) exit
         call begin_way(run%sim%model, run%sim%scheme, left)
         if (left > 0) return
         call finish_way(run, monitor, course)
      end do
      call end_run(run%sim, run%sink, monitor, course, run%status, run%error)
   end subroutine set_off

   subroutine finish_way(run, monitor, course)
      type(beside_t), intent(inout) :: run
      class(monitor_t), intent(inout) :: monitor
      type(course_t), intent(inout) :: course

      call end_way(run%sim%model, run%sim%scheme, run%error)
      if (.not. allocated(run%error)) call pass(run%sim, monitor, course, run%status, run%error)
   end subroutine finish_way

   pure subroutine start_spell(sim, left, place)
      type(simulation_t), intent(in) :: sim
      integer, intent(in) :: left
      type(place_t), intent(inout) :: place

      place%left = left
      place%now = spell(sim%scheme%march, left)
      place%to_go = place%now
      place%h = sim%scheme%march%h
   end subroutine start_spell

   !> The end of a spell at place i: what march does after its steps
   subroutine attend(i, run, monitor, self)
      integer, intent(in) :: i
      type(beside_t), intent(inout) :: run(:)
      class(monitor_t), intent(inout) :: monitor
      type(rows_t), intent(inout) :: self

      logical :: arrived

      associate (p => self%place(i), sim => run(self%place(i)%run)%sim)
         associate (model => sim%model, state => sim%scheme%state, march => sim%scheme%march)
            state%cycle = min(state%cycle, huge(state%cycle) - p%now) + p%now
            call count_steps(p%now, p%left, march, arrived)
            if (.not. arrived) then
               if (march%since == EVERY) call look_beside(i, sim, self%lanes)
               if (p%left > 0 .and. .not. is_too_short(model%model_t, march)) then
                  call start_spell(sim, p%left, p)
                  return
               end if
            end if
            call take_out(model, i, self%lanes, state)
            if (arrived) call arrive(model, march, state)
            call finish_way(run(p%run), monitor, self%course(p%run))
            call set_off(run(p%run), monitor, self%course(p%run), p%left)
            if (p%left == 0) then
               call leave(i, run, self)
               return
            end if
            self%lanes%state%poses%time(i) = state%time
            call start_spell(sim, p%left, p)
         end associate
      end associate
   end subroutine attend

   !> Do the steps still hold?
   subroutine look_beside(i, sim, lanes)
      integer, intent(in) :: i
      type(simulation_t), intent(inout) :: sim
      type(lanes_t), intent(inout) :: lanes

      associate (model => sim%model, state => sim%scheme%state, march => sim%scheme%march)
         call take_coordinates(model, i, lanes, state)
         if (is_calm(model, march, state)) then
            march%since = 0
         else
            call take_out(model, i, lanes, state)
            call look_ahead(model, march, state)
         end if
      end associate
   end subroutine look_beside

   !> The last place is given up: who had it goes to place i
   subroutine leave(i, run, self)
      integer, intent(in) :: i
      type(beside_t), intent(inout) :: run(:)
      type(rows_t), intent(inout) :: self

      if (i < self%n) then
         self%place(i) = self%place(self%n)
         associate (sim => run(self%place(i)%run)%sim)
            call take_out(sim%model, self%n, self%lanes, sim%scheme%state)
            call seat(sim%model, sim%scheme%state, i, self%lanes)
         end associate
      end if
      self%n = self%n - 1
   end subroutine leave

end submodule kjoint_beside
