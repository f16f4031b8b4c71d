!> Waves of the consistent formulation: which scenes have one, and what a wave leaves to its end.
module kj_consistent_wave
   use kj_kinds, only: wp
   use kj_team, only: team_t, new_team, LARGE
   use kj_lead_map, only: SPAN, N_SUM
   use kj_plan, only: plan_t
   use kj_wave, only: new_wave, wave_share
   use kj_consistent_state, only: consistent_model_t, consistent_state_t
   use kj_consistent_conditions, only: at_rest
   implicit none
   private

   public :: build_wave, load_hub

   integer, parameter :: WAVE_SHARES(3) = [4, 2, 1]   !! for each thread
   real(wp), parameter :: LEAST_WAVE_SHARE = 0.85_wp  !! of the time of threads that is used

contains

   !> A wave where the scene allows one, in the shares that leave threads the least to wait for
   subroutine build_wave(model)
      type(consistent_model_t), intent(inout) :: model

      type(team_t) :: team
      type(plan_t) :: wave
      logical :: rests(model%n_lead)
      real(wp) :: best
      integer :: i

      allocate (model%wave%stage(0))
      if (.not. may_wave(model)) return
      rests = at_rest(model)
      if (.not. all(rests(model%map%hub))) return
      best = LEAST_WAVE_SHARE
      do i = 1, size(WAVE_SHARES)
         call new_team(model%control%threads, model%control%least_share, model%batch%n, &
            min(SPAN, model%n_end), team, WAVE_SHARES(i))
         call new_wave(model%batch%first, model%map, team, merge(2, 1, model%damped), wave)
         if (.not. wave_share(wave) > best) cycle
         best = wave_share(wave)
         model%wave = wave
         if (team%threads == 1) exit
      end do
   end subroutine build_wave

   !> Nothing but joints and steady gravity acts between steps, and no law looks at the time
   pure logical function may_wave(model) result(may)
      type(consistent_model_t), intent(in) :: model

      may = model%n_joint + model%n_lead >= LARGE .and. size(model%placed) == 0 .and. &
         size(model%cload) == 0 .and. size(model%motion) == 0 .and. size(model%gravity) <= 1 .and. &
         all(model%steady) .and. .not. any(model%batch%limited)
   end function may_wave

   !> Forces on a hub at rest, which a wave has left out, and their impulses; the first half kick of
   !> the wave had those of before
   pure subroutine load_hub(model, i, n, state)
      type(consistent_model_t), intent(in) :: model
      integer, intent(in) :: i, n                    !! hub; steps
      type(consistent_state_t), intent(inout) :: state

      real(wp) :: total(N_SUM), half(6)
      integer :: k, round

      associate (lead => model%map%hub(i), from => model%map%part(i), &
         to => model%map%part(i + 1) - 1)
         do k = 1, n
            do round = 1, size(model%wave%ready, 2)
               total = sum_of(state%part(:, from:to, round, k))
               if (round == 1) then
                  state%f(lead, :) = total(1:3) + state%own_f(lead, :)
                  state%t(lead, :) = total(4:6) + state%own_t(lead, :)
               else
                  state%f(lead, :) = state%f(lead, :) + total(1:3)
                  state%t(lead, :) = state%t(lead, :) + total(4:6)
               end if
            end do
            if (lead > model%n_body) cycle
            half = 0.5_wp*state%h*[state%f(lead, :) - state%own_f(lead, :), &
               state%t(lead, :) - state%own_t(lead, :)]
            do round = 1, merge(1, 2, k == n)        ! of the second half kick and the next first
               state%impulse(lead, :) = state%impulse(lead, :) + half(1:3)
               state%angular_impulse(lead, :) = state%angular_impulse(lead, :) + half(4:6)
            end do
         end do
      end associate
   end subroutine load_hub

   !> Sum of the parts of a hub, one after the other
   pure function sum_of(part) result(total)
      real(wp), intent(in) :: part(:, :)
      real(wp) :: total(N_SUM)

      integer :: i

      total = 0.0_wp
      do i = 1, size(part, 2)
         total = total + part(:, i)
      end do
   end function sum_of

end module kj_consistent_wave
