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

   public :: archive_t, new_archive, close_archive, open_archive, keep, keep_blocks, is_done

   !> Bytes, and where passing stands
   type :: archive_t
      logical :: saving = .true.                 !! into the bytes, else out of them
      logical :: damaged = .false.
      logical :: counting = .false.              !! bytes alone: nothing is passed
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

   !> An archive to save to. room: the bytes that it will hold, 0 = count them; without, it grows
   pure subroutine new_archive(self, room)
      type(archive_t), intent(out) :: self
      integer(int64), intent(in), optional :: room

      if (.not. present(room)) then
         allocate (self%byte(4096))
      else
         allocate (self%byte(room))
         self%counting = room == 0
      end if
   end subroutine new_archive

   !> What was saved
   subroutine close_archive(self, byte)
      type(archive_t), intent(inout) :: self
      integer(int8), allocatable, intent(out) :: byte(:)

      integer(int64) :: i

      if (self%n == size(self%byte, kind=int64)) then
         call move_alloc(self%byte, byte)
         return
      end if
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

   !> n blocks of so many bits at an address
   subroutine keep_blocks(self, address, n, bits)
      type(archive_t), intent(inout) :: self
      type(c_ptr), intent(in) :: address
      integer, intent(in) :: n, bits

      call keep_bytes(self, address, int(n, int64)*(bits/8))
   end subroutine keep_blocks

   !> n bytes at an address
   subroutine keep_bytes(self, address, n)
      type(archive_t), intent(inout) :: self
      type(c_ptr), intent(in) :: address
      integer(int64), intent(in) :: n

      integer(int8), pointer :: x(:)
      integer(int8), allocatable :: longer(:)
      integer(int64) :: i

      if (n == 0 .or. self%damaged) return
      if (self%counting) then
         self%n = self%n + n
         return
      end if
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

   !> A flag that is neither 0 nor 1 is damage
   subroutine keep_logical(self, x)
      type(archive_t), intent(inout) :: self
      logical, intent(inout) :: x

      integer :: flag

      flag = merge(1, 0, x)
      call keep_integer(self, flag)
      self%damaged = self%damaged .or. all(flag /= [0, 1])
      x = flag == 1
   end subroutine keep_logical

   subroutine keep_text(self, x)
      type(archive_t), intent(inout) :: self
      character(len=:), allocatable, intent(inout) :: x

      integer(int8), allocatable, target :: code(:)
      integer :: n

      n = 0
      if (self%saving) n = len(x)
      call keep_integer(self, n)
      self%damaged = self%damaged .or. n < 0 .or. (n > size(self%byte) .and. .not. self%saving)
      if (self%damaged) return
      allocate (code(n))
      if (self%saving) code = transfer(x, code, n)
      if (n > 0) call keep_bytes(self, c_loc(code), int(n, int64))
      if (.not. self%saving) x = transfer(code, repeat(' ', n))
   end subroutine keep_text

   !> Whether an array is in the archive, which then can be passed, and its bounds: a row for each
   !> dimension, as it has them, or the archive
   subroutine keep_bounds(self, is_allocated, bounds, there)
      type(archive_t), intent(inout) :: self
      logical, intent(in) :: is_allocated
      integer, intent(inout) :: bounds(:, :)     !! (dimensions, 2)
      logical, intent(out) :: there

      integer :: had(size(bounds, 1), 2), i
      integer(int64) :: many

      had = bounds
      there = is_allocated
      call keep_logical(self, there)
      self%damaged = self%damaged .or. (is_allocated .and. .not. there)
      there = there .and. .not. self%damaged
      if (.not. there) return
      many = 1
      do i = 1, size(bounds, 1)
         call keep_integer(self, bounds(i, 1))
         call keep_integer(self, bounds(i, 2))
         many = many*max(0_int64, int(bounds(i, 2), int64) - bounds(i, 1) + 1)
         if (self%saving) cycle
         self%damaged = self%damaged .or. many > size(self%byte, kind=int64)
         if (self%damaged) exit
      end do
      if (is_allocated) self%damaged = self%damaged .or. any(had /= bounds)
      there = .not. self%damaged
   end subroutine keep_bounds

   subroutine keep_integers_1(self, x)
      type(archive_t), intent(inout) :: self
      integer, allocatable, target, intent(inout) :: x(:)

      integer :: b(1, 2)
      logical :: there

      if (allocated(x)) b(1, :) = [lbound(x), ubound(x)]
      call keep_bounds(self, allocated(x), b, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(b(1, 1):b(1, 2)))
      call keep_blocks(self, c_loc(x), size(x), storage_size(x))
   end subroutine keep_integers_1

   subroutine keep_integers_2(self, x)
      type(archive_t), intent(inout) :: self
      integer, allocatable, target, intent(inout) :: x(:, :)

      integer :: b(2, 2)
      logical :: there

      if (allocated(x)) b = reshape([lbound(x), ubound(x)], [2, 2])
      call keep_bounds(self, allocated(x), b, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(b(1, 1):b(1, 2), b(2, 1):b(2, 2)))
      call keep_blocks(self, c_loc(x), size(x), storage_size(x))
   end subroutine keep_integers_2

   subroutine keep_logicals(self, x)
      type(archive_t), intent(inout) :: self
      logical, allocatable, intent(inout) :: x(:)

      integer :: b(1, 2), i
      logical :: there

      if (allocated(x)) b(1, :) = [lbound(x), ubound(x)]
      call keep_bounds(self, allocated(x), b, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(b(1, 1):b(1, 2)), source=.false.)
      do i = b(1, 1), b(1, 2)
         call keep_logical(self, x(i))
      end do
   end subroutine keep_logicals

   subroutine keep_reals_1(self, x)
      type(archive_t), intent(inout) :: self
      real(wp), allocatable, target, intent(inout) :: x(:)

      integer :: b(1, 2)
      logical :: there

      if (allocated(x)) b(1, :) = [lbound(x), ubound(x)]
      call keep_bounds(self, allocated(x), b, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(b(1, 1):b(1, 2)))
      call keep_blocks(self, c_loc(x), size(x), storage_size(x))
   end subroutine keep_reals_1

   subroutine keep_reals_2(self, x)
      type(archive_t), intent(inout) :: self
      real(wp), allocatable, target, intent(inout) :: x(:, :)

      integer :: b(2, 2)
      logical :: there

      if (allocated(x)) b = reshape([lbound(x), ubound(x)], [2, 2])
      call keep_bounds(self, allocated(x), b, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(b(1, 1):b(1, 2), b(2, 1):b(2, 2)))
      call keep_blocks(self, c_loc(x), size(x), storage_size(x))
   end subroutine keep_reals_2

   subroutine keep_reals_3(self, x)
      type(archive_t), intent(inout) :: self
      real(wp), allocatable, target, intent(inout) :: x(:, :, :)

      integer :: b(3, 2)
      logical :: there

      if (allocated(x)) b = reshape([lbound(x), ubound(x)], [3, 2])
      call keep_bounds(self, allocated(x), b, there)
      if (.not. there) return
      if (.not. allocated(x)) allocate (x(b(1, 1):b(1, 2), b(2, 1):b(2, 2), b(3, 1):b(3, 2)))
      call keep_blocks(self, c_loc(x), size(x), storage_size(x))
   end subroutine keep_reals_3

end module kj_archive
