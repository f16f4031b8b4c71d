!> A state as bytes: one list of its fields both saves and restores it. `keep` passes a field into
!> the bytes or out of them, so what is saved is what is restored, in the same order.
!>
!> An array that is restored must have the shape that the scene gave it, or not be allocated yet.
!> Bytes that do not fit set `damaged`, and nothing more is passed.
module kj_archive
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc, c_f_pointer
   use, intrinsic :: iso_fortran_env, only: int8, int64
   use kj_kinds, only: wp
   implicit none
   private

   public :: archive_t, new_archive, close_archive, open_archive, keep, keep_bytes, is_done

   !> Bytes, and where passing stands
   type :: archive_t
      logical :: saving = .true.                 !! into the bytes, else out of them
      logical :: damaged = .false.
      integer(int64) :: n = 0                    !! bytes passed
      integer(int8), allocatable :: byte(:)
   end type archive_t

   !> A field: a number, a flag, a text, or an allocatable array
   interface keep
      module procedure keep_integer, keep_real, keep_logical, keep_text
      module procedure keep_integers_1, keep_integers_2, keep_logicals
      module procedure keep_reals_1, keep_reals_2, keep_reals_3
   end interface keep

contains

   !> An archive to save to
   pure subroutine new_archive(self)
      type(archive_t), intent(out) :: self

      allocate (self%byte(4096))
   end subroutine new_archive

   !> What was saved
   subroutine close_archive(self, byte)
      type(archive_t), intent(in) :: self
      integer(int8), allocatable, intent(out) :: byte(:)

      integer(int64) :: i

      allocate (byte(self%n))
      do i = 1, self%n
         byte(i) = self%byte(i)
      end do
   end subroutine close_archive

   !> An archive to restore from; the bytes are moved into it
   pure subroutine open_archive(byte, self)
      integer(int8), allocatable, intent(inout) :: byte(:)
      type(archive_t), intent(out) :: self

      self%saving = .false.
      call move_alloc(byte, self%byte)
   end subroutine open_archive

   !> Whether all bytes have been restored, and fitted
   pure logical function is_done(self)
      type(archive_t), intent(in) :: self

      is_done = .not. self%damaged .and. self%n == size(self%byte, kind=int64)
   end function is_done

   !> n bytes at an address
   subroutine keep_bytes(self, address, n)
      type(archive_t), intent(inout) :: self
      type(c_ptr), intent(in) :: address
      integer(int64), intent(in) :: n

      integer(int8), pointer :: x(:)
      integer(int8), allocatable :: longer(:)
      integer(int64) :: i

      if (n == 0 .or. self%damaged) return
      if (self%n + n > size(self%byte, kind=int64)) then
         self%damaged = .not. self%saving
         if (self%damaged) return
         allocate (longer(max(self%n + n, 2*size(self%byte, kind=int64))))
         do i = 1, self%n
            longer(i) = self%byte(i)
         end do
         call move_alloc(longer, self%byte)
      end if
      call c_f_pointer(address, x, [n])
      do i = 1, n
         if (self%saving) self%byte(self%n + i) = x(i)
         if (.not. self%saving) x(i) = self%byte(self%n + i)
      end do
      self%n = self%n + n
   end subroutine keep_bytes

   subroutine keep_integer(self, x)
      type(archive_t), intent(inout) :: self
      integer, target, intent(inout) :: x

      call keep_bytes(self, c_loc(x), 4_int64)
   end subroutine keep_integer

   subroutine keep_real(self, x)
      type(archive_t), intent(inout) :: self
      real(wp), target, intent(inout) :: x

      call keep_bytes(self, c_loc(x), 8_int64)
   end subroutine keep_real

   subroutine keep_logical(self, x)
      type(archive_t), intent(inout) :: self
      logical, intent(inout) :: x

      integer :: flag

      flag = merge(1, 0, x)
      call keep_integer(self, flag)
      x = flag == 1
   end subroutine keep_logical

   subroutine keep_text(self, x)
      type(archive_t), intent(inout) :: self
      character(len=:), allocatable, intent(inout) :: x

      integer, allocatable :: code(:)
      integer :: i

      if (self%saving) code = [(ichar(x(i:i)), i=1, len(x))]
      call keep_integers_1(self, code)
      if (self%saving .or. self%damaged .or. .not. allocated(code)) return
      x = repeat(' ', size(code))
      do i = 1, size(code)
         x(i:i) = char(modulo(code(i), 256))
      end do
   end subroutine keep_text

   !> Whether an array is there, and its bounds. There: it is in the archive, and can be passed.
   subroutine keep_bounds(self, is_allocated, low, high, there)
      type(archive_t), intent(inout) :: self
      logical, intent(in) :: is_allocated
      integer, intent(inout) :: low(:), high(:)
      logical, intent(out) :: there

      integer(int64) :: many
      integer :: had(size(low), 2), i

      had(:, 1) = low
      had(:, 2) = high
      there = is_allocated
      call keep_logical(self, there)
      if (.not. there) self%damaged = self%damaged .or. is_allocated
      there = there .and. .not. self%damaged
      if (.not. there) return
      many = 1
      do i = 1, size(low)
         call keep_integer(self, low(i))
         call keep_integer(self, high(i))
         many = many*max(0_int64, int(high(i), int64) - low(i) + 1)
         if (.not. self%saving .and. many > size(self%byte, kind=int64)) exit
      end do
      if (.not. self%saving) self%damaged = self%damaged .or. many > size(self%byte, kind=int64)
      if (is_allocated) self%damaged = self%damaged .or. any(had(:, 1) /= low) .or. &
         any(had(:, 2) /= high)
      there = .not. self%damaged
   end subroutine keep_bounds

   subroutine keep_integers_1(self, x)
      type(archive_t), intent(inout) :: self
      integer, allocatable, target, intent(inout) :: x(:)

      integer :: low(1), high(1)
      logical :: there

      low = 1
      high = 0
      if (allocated(x)) low = lbound(x)
      if (allocated(x)) high = ubound(x)
      call keep_bounds(self, allocated(x), low, high, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(low(1):high(1)))
      if (size(x) > 0) call keep_bytes(self, c_loc(x), 4*size(x, kind=int64))
   end subroutine keep_integers_1

   subroutine keep_integers_2(self, x)
      type(archive_t), intent(inout) :: self
      integer, allocatable, target, intent(inout) :: x(:, :)

      integer :: low(2), high(2)
      logical :: there

      low = 1
      high = 0
      if (allocated(x)) low = lbound(x)
      if (allocated(x)) high = ubound(x)
      call keep_bounds(self, allocated(x), low, high, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(low(1):high(1), low(2):high(2)))
      if (size(x) > 0) call keep_bytes(self, c_loc(x), 4*size(x, kind=int64))
   end subroutine keep_integers_2

   subroutine keep_logicals(self, x)
      type(archive_t), intent(inout) :: self
      logical, allocatable, target, intent(inout) :: x(:)

      integer, allocatable :: flag(:)

      if (allocated(x)) then
         allocate (flag(lbound(x, 1):ubound(x, 1)))
         flag = merge(1, 0, x)
      end if
      call keep_integers_1(self, flag)
      if (self%damaged .or. .not. allocated(flag)) return
      if (.not. allocated(x)) allocate (x(lbound(flag, 1):ubound(flag, 1)))
      x = flag == 1
   end subroutine keep_logicals

   subroutine keep_reals_1(self, x)
      type(archive_t), intent(inout) :: self
      real(wp), allocatable, target, intent(inout) :: x(:)

      integer :: low(1), high(1)
      logical :: there

      low = 1
      high = 0
      if (allocated(x)) low = lbound(x)
      if (allocated(x)) high = ubound(x)
      call keep_bounds(self, allocated(x), low, high, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(low(1):high(1)))
      if (size(x) > 0) call keep_bytes(self, c_loc(x), 8*size(x, kind=int64))
   end subroutine keep_reals_1

   subroutine keep_reals_2(self, x)
      type(archive_t), intent(inout) :: self
      real(wp), allocatable, target, intent(inout) :: x(:, :)

      integer :: low(2), high(2)
      logical :: there

      low = 1
      high = 0
      if (allocated(x)) low = lbound(x)
      if (allocated(x)) high = ubound(x)
      call keep_bounds(self, allocated(x), low, high, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(low(1):high(1), low(2):high(2)))
      if (size(x) > 0) call keep_bytes(self, c_loc(x), 8*size(x, kind=int64))
   end subroutine keep_reals_2

   subroutine keep_reals_3(self, x)
      type(archive_t), intent(inout) :: self
      real(wp), allocatable, target, intent(inout) :: x(:, :, :)

      integer :: low(3), high(3)
      logical :: there

      low = 1
      high = 0
      if (allocated(x)) low = lbound(x)
      if (allocated(x)) high = ubound(x)
      call keep_bounds(self, allocated(x), low, high, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(low(1):high(1), low(2):high(2), low(3):high(3)))
      if (size(x) > 0) call keep_bytes(self, c_loc(x), 8*size(x, kind=int64))
   end subroutine keep_reals_3

end module kj_archive
