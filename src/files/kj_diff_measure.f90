!> The tolerance of every channel, and the difference of two rows in terms of it.
module kj_diff_measure
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use, intrinsic :: iso_fortran_env, only: int64, real32
   use kj_kinds, only: wp
   use kj_units, only: D_ENERGY, D_NUMBER
   use kj_channels, only: channels, OF_RUN, CH_KE_TRANS, CH_KE_ROT, CH_IE, CH_WORK, find_channel, &
      OF_JOINT, OF_SPRING
   use kj_diff_types, only: channel_result_t, profile_t, is_quaternion
   use kj_sort, only: lookup_t, new_lookup, lower_bound
   use kj_history, only: history_t
   implicit none
   private

   public :: rounding_t, rounding_of, add_peaks, scene_energy, set_tolerances, compare_rows, &
      list_groups, find_in_groups, entity_ids

   !> What 32-bit reals on a side add to a tolerance: relative * |value| + smallest
   type :: rounding_t
      real(wp) :: relative = 0.0_wp
      real(wp) :: smallest = 0.0_wp
   end type rounding_t

   real(wp), parameter :: FLOOR_OF_CLASS = 1.0e-6_wp     !! of the largest peak of a class
   real(wp), parameter :: ENERGY_FACTOR = 10.0_wp        !! energies under parity: 1e-6, not 1e-7

contains

   !> Half a unit in the last place for each side of 32 bits, and what such a side rounds to 0
   pure function rounding_of(n_single) result(rounding)
      integer, intent(in) :: n_single        !! sides with 32-bit reals
      type(rounding_t) :: rounding

      rounding%relative = 0.5_wp*real(n_single, wp)*real(epsilon(1.0_real32), wp)
      rounding%smallest = real(n_single, wp)*real(tiny(1.0_real32), wp)
   end function rounding_of

   !> Raise the peaks by a row of REF; what is not finite has no part in them
   pure subroutine add_peaks(row, list)
      real(wp), intent(in) :: row(:)
      type(channel_result_t), intent(inout) :: list(:)

      real(wp) :: size_here
      integer :: i

      do i = 1, size(list)
         if (list(i)%n_comp == 1) then
            size_here = abs(row(list(i)%ref_at))
         else
            size_here = norm2(row(list(i)%ref_at:list(i)%ref_at + list(i)%n_comp - 1))
         end if
         if (size_here > list(i)%peak .and. size_here <= huge(1.0_wp)) list(i)%peak = size_here
      end do
   end subroutine add_peaks

   !> kinetic + internal + |external work| of a row, as far as the file has them
   pure real(wp) function scene_energy(row, list) result(energy)
      real(wp), intent(in) :: row(:)
      type(channel_result_t), intent(in) :: list(:)

      integer :: i

      energy = 0.0_wp
      do i = 1, size(list)
         if (channels(list(i)%channel)%owner /= OF_RUN) cycle
         select case (list(i)%channel)
         case (CH_KE_TRANS, CH_KE_ROT, CH_IE)
            energy = energy + row(list(i)%ref_at)
         case (CH_WORK)
            energy = energy + abs(row(list(i)%ref_at))
         end select
      end do
   end function scene_energy

   !> atol + rtol S of every channel
   !>
   !> S is the peak in REF, not below FLOOR_OF_CLASS of the largest peak among the channels of the
   !> same class and dimension (a class may hold newtons and newton seconds). Quaternions differ by
   !> an angle: S = 1 rad. Under parity energies are measured by the largest energy of the scene
   !> and a fraction of energy by 1, with ten times the tolerance.
   pure subroutine set_tolerances(profile, atol, largest_energy, list)
      type(profile_t), intent(in) :: profile
      real(wp), intent(in) :: atol
      real(wp), intent(in) :: largest_energy           !! of REF, 0 when it has no energies
      type(channel_result_t), intent(inout) :: list(:)

      real(wp) :: largest(size(channels)), s, rtol
      integer :: i, like(size(channels))

      call find_alike(like)
      largest = 0.0_wp
      do i = 1, size(list)
         associate (group => like(list(i)%channel))
            largest(group) = max(largest(group), list(i)%peak)
         end associate
      end do
      do i = 1, size(list)
         s = max(list(i)%peak, FLOOR_OF_CLASS*largest(like(list(i)%channel)))
         rtol = profile%rtol
         if (is_quaternion(list(i))) s = 1.0_wp
         if (profile%name == 'parity' .and. channels(list(i)%channel)%class == 'energy') then
            rtol = ENERGY_FACTOR*rtol
            if (channels(list(i)%channel)%dim == D_ENERGY .and. largest_energy > 0.0_wp) &
               s = largest_energy
            if (channels(list(i)%channel)%dim == D_NUMBER) s = 1.0_wp
         end if
         list(i)%tolerance = atol + rtol*s
      end do
   end subroutine set_tolerances

   !> For each channel of the table the first of the same class and dimension
   pure subroutine find_alike(like)
      integer, intent(out) :: like(size(channels))

      integer :: i, j

      do i = 1, size(channels)
         do j = 1, i
            if (channels(j)%class /= channels(i)%class) cycle
            if (channels(j)%dim == channels(i)%dim) exit
         end do
         like(i) = j
      end do
   end subroutine find_alike

   !> Compare two rows of equal time
   pure subroutine compare_rows(t, x, y, bitwise, rounding, list)
      real(wp), intent(in) :: t
      real(wp), intent(in) :: x(:), y(:)               !! rows of REF and RUN
      logical, intent(in) :: bitwise
      type(rounding_t), intent(in) :: rounding
      type(channel_result_t), intent(inout) :: list(:)

      integer :: i, k, n_void
      real(wp) :: d, allowed

      do i = 1, size(list)
         if (list(i)%run_at == 0 .or. .not. list(i)%counted) cycle
         associate (c => list(i), a => x(list(i)%ref_at:list(i)%ref_at + list(i)%n_comp - 1), &
            b => y(list(i)%run_at:list(i)%run_at + list(i)%n_comp - 1))
            n_void = count(ieee_is_nan(a) .and. ieee_is_nan(b))
            c%n_void = c%n_void + n_void
            c%n_number = c%n_number + c%n_comp - n_void
            if (same_bits(a, b)) cycle
            if (is_quaternion(c) .and. .not. bitwise) then
               call note_difference(t, 0, angle_between(a, b), c%tolerance + rounding%relative, c)
               cycle
            end if
            do k = 1, c%n_comp
               if (bitwise) then
                  if (same_bits(a(k:k), b(k:k))) cycle
                  call note_difference(t, k, abs(a(k) - b(k)), -1.0_wp, c)
               else
                  d = abs(a(k) - b(k))
                  if (d <= 0.0_wp) cycle
                  if (ieee_is_nan(d) .and. same_bits(a(k:k), b(k:k))) cycle
                  allowed = c%tolerance + rounding%smallest + &
                     rounding%relative*max(abs(a(k)), abs(b(k)))
                  call note_difference(t, k, d, allowed, c)
               end if
            end do
         end associate
      end do
   end subroutine compare_rows

   !> Equal bits; NaN equals NaN, whatever its payload
   pure logical function same_bits(a, b) result(same)
      real(wp), intent(in) :: a(:), b(:)

      integer :: i

      do i = 1, size(a)
         same = transfer(a(i), 0_int64) == transfer(b(i), 0_int64)
         if (.not. same) same = ieee_is_nan(a(i)) .and. ieee_is_nan(b(i))
         if (.not. same) return
      end do
   end function same_bits

   !> Angle in rad of the rotation between two unit quaternions; NaN when one of them is
   !>
   !>   |p - q| = 2 sin(angle/4), and q and -q are the same rotation
   pure real(wp) function angle_between(p, q) result(angle)
      real(wp), intent(in) :: p(:), q(:)               !! (4)

      real(wp) :: chord

      chord = min(norm2(p - q), norm2(p + q))
      angle = 4.0_wp*asin(min(0.5_wp*chord, 1.0_wp))
      if (ieee_is_nan(chord)) angle = chord
   end function angle_between

   !> Count a difference and keep it when it is the worst one
   pure subroutine note_difference(t, comp, difference, allowed, channel)
      real(wp), intent(in) :: t
      integer, intent(in) :: comp                      !! 0 = all together
      real(wp), intent(in) :: difference
      real(wp), intent(in) :: allowed                  !! negative: none at all
      type(channel_result_t), intent(inout) :: channel

      real(wp) :: excess

      excess = huge(1.0_wp)
      if (allowed > 0.0_wp) excess = min(difference/allowed, huge(1.0_wp))
      if (ieee_is_nan(difference)) excess = huge(1.0_wp)
      if (excess > 1.0_wp) channel%n_beyond = channel%n_beyond + 1
      if (excess > 1.0_wp) channel%different = .true.
      if (.not. (excess > channel%excess .or. &
         (excess >= channel%excess .and. difference > channel%difference))) return
      channel%excess = excess
      channel%difference = difference
      channel%allowed = max(allowed, 0.0_wp)
      channel%time = t
      channel%comp = comp
   end subroutine note_difference

   !> The channels of another side that may hold what a channel holds, 0 = none, and their entities
   subroutine list_groups(other, channel, group, entities)
      type(history_t), intent(in) :: other
      integer, intent(in) :: channel
      integer, intent(out) :: group(2)
      type(lookup_t), intent(out) :: entities(2)

      integer, allocatable :: id(:)
      integer :: k

      group = [channel, 0]
      associate (c => channels(channel))
         if (c%owner == OF_JOINT) group(2) = find_channel(OF_SPRING, c%name)
         if (c%owner == OF_SPRING) group(2) = find_channel(OF_JOINT, c%name)
      end associate
      do k = 1, 2
         id = [integer ::]
         if (group(k) > 0) call entity_ids(other, channels(group(k))%owner, id)
         call new_lookup(id, entities(k))
      end do
   end subroutine list_groups

   !> Place of entity j on the other side, 0 = none, and which group has it
   pure subroutine find_in_groups(id, j, entities, k, group)
      integer, intent(in) :: id(:), j            !! ids ascend
      type(lookup_t), intent(in) :: entities(2)
      integer, intent(out) :: k, group

      group = 1
      k = partner(id, j, entities(1))
      if (k > 0) return
      k = partner(id, j, entities(2))
      if (k > 0) group = 2
   end subroutine find_in_groups

   !> Place on the other side of entity j: of those with one id the n-th belong together; 0 = none
   pure integer function partner(id, j, other) result(k)
      integer, intent(in) :: id(:), j           !! ids ascend
      type(lookup_t), intent(in) :: other

      integer :: n

      n = 0
      do while (j - n > 1)
         if (id(j - n - 1) /= id(j)) exit
         n = n + 1
      end do
      k = lower_bound(other%id, id(j)) + n
      if (k <= size(other%id)) then
         if (other%id(k) == id(j)) then
            k = other%place(k)
            return
         end if
      end if
      k = 0
   end function partner

   !> User ids of the entities of an owner; 0 for the run itself
   subroutine entity_ids(history, owner, id)
      type(history_t), intent(in) :: history
      integer, intent(in) :: owner                !! OF_ constant
      integer, allocatable, intent(out) :: id(:)

      if (owner == OF_RUN) then
         id = [0]
      else if (allocated(history%entity(owner)%id)) then
         id = history%entity(owner)%id
      end if
      if (.not. allocated(id)) allocate (id(0))
   end subroutine entity_ids

end module kj_diff_measure
