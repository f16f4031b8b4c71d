!> How long a run will be, as it stands at its start.
module kj_forecast
   use kj_kinds, only: wp
   use kj_error, only: error_t, fail, ERR_INPUT
   use kj_model, only: model_t
   use kj_scheme, only: scheme_t
   implicit none
   private

   public :: refuse_years

   real(wp), parameter :: MOST_CYCLES = 1.0e12_wp   !! of a run that is not forced

contains

   !> Cycles to the end of a run at the present step; a sample interval takes one at least
   pure real(wp) function cycles_to_go(model, self) result(n)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self

      real(wp) :: span, interval, h

      span = max(0.0_wp, model%control%t_stop - self%now%time)
      if (self%legacy) then
         interval = span
         h = min(self%cycles%h2, span)
         if (self%now%cycle == 0 .and. model%control%dt_ini > 0.0_wp) h = span   ! it is the first
      else
         interval = span
         if (model%control%sample > 0.0_wp) interval = min(span, model%control%sample)
         h = min(self%march%limit, interval)
      end if
      n = 0.0_wp
      if (span > 0.0_wp) n = span/interval*max(1.0_wp, interval/max(h, tiny(h)))
   end function cycles_to_go

   !> Cycles to the end of a run. Errors: ERR_INPUT beyond MOST_CYCLES, unless the run is forced
   subroutine refuse_years(model, self, force, cycles, error)
      type(model_t), intent(in) :: model
      type(scheme_t), intent(in) :: self
      logical, intent(in) :: force
      real(wp), intent(out) :: cycles
      type(error_t), allocatable, intent(out) :: error

      character(len=9) :: text

      cycles = cycles_to_go(model, self)
      if (force .or. cycles <= MOST_CYCLES) return
      write (text, '(es9.1)') cycles
      call fail(error, ERR_INPUT, 'the run would take'//text//' cycles, which is years', &
         'KJ-9079')
      error%hint = 'longer steps (a lower Kn), longer intervals of samples, an earlier end, '// &
         'or --force'
   end subroutine refuse_years

end module kj_forecast
