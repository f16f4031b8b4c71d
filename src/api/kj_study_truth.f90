!> What a scene would do with joints that do not give way: blocked directions of stiffness Kn give
!> way by their force over Kn, so that rows at Kn, less those of ideal joints, go with 1/Kn.
module kj_study_truth
   use kj_kinds, only: wp
   use kj_study_metric, only: study_sink_t
   implicit none
   private

   public :: STIFFER, extrapolate, soften

   real(wp), parameter :: STIFFER = 4.0_wp       !! Kn of the second of two runs over the first

contains

   !> Rows for 1/Kn to 0: x(4 Kn) + (x(4 Kn) - x(Kn))/3
   subroutine extrapolate(soft, stiff, truth)
      type(study_sink_t), intent(in) :: soft     !! with Kn
      type(study_sink_t), intent(in) :: stiff    !! with STIFFER Kn, at the same times
      type(study_sink_t), intent(out) :: truth

      truth = stiff
      call blend(stiff%rows, soft%rows, -1.0_wp/(STIFFER - 1.0_wp), truth)
   end subroutine extrapolate

   !> Rows at `scale` times the Kn of `run`: the truth and what is left of its distance from the run
   subroutine soften(truth, run, scale, rows)
      type(study_sink_t), intent(in) :: truth, run
      real(wp), intent(in) :: scale
      type(study_sink_t), intent(out) :: rows

      rows = run
      call blend(truth%rows, run%rows, 1.0_wp/scale, rows)
   end subroutine soften

   !> a + part (b - a), quaternions of one sign and made 1 long
   subroutine blend(a, b, part, sink)
      real(wp), intent(in) :: a(:, :), b(:, :)
      real(wp), intent(in) :: part
      type(study_sink_t), intent(inout) :: sink

      integer :: i, k, n

      n = sink%n_row
      sink%rows(:, :n) = a(:, :n) + part*(b(:, :n) - a(:, :n))
      do i = 1, size(sink%history%variable)
         associate (v => sink%history%variable(i))
            if (v%n_comp /= 4) cycle
            do k = 1, v%n_entity
               call blend_turns(a(v%first + 4*(k - 1):v%first + 4*k - 1, :n), &
                  b(v%first + 4*(k - 1):v%first + 4*k - 1, :n), part, &
                  sink%rows(v%first + 4*(k - 1):v%first + 4*k - 1, :n))
            end do
         end associate
      end do
   end subroutine blend

   pure subroutine blend_turns(a, b, part, c)
      real(wp), intent(in) :: a(:, :), b(:, :)   !! (4, n)
      real(wp), intent(in) :: part
      real(wp), intent(inout) :: c(:, :)

      real(wp) :: q(4), length
      integer :: i

      do i = 1, size(c, 2)
         q = a(:, i) + part*(sign(1.0_wp, dot_product(a(:, i), b(:, i)))*b(:, i) - a(:, i))
         length = norm2(q)
         c(:, i) = q
         if (length > 0.0_wp) c(:, i) = q/length
      end do
   end subroutine blend_turns

end module kj_study_truth
