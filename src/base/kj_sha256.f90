!> SHA-256 of a text, as FIPS 180-4 defines it. Words are kept in the low half of 64-bit integers.
module kj_sha256
   use, intrinsic :: iso_fortran_env, only: int64
   implicit none
   private

   public :: sha256

   integer(int64), parameter :: MASK = int(z'FFFFFFFF', int64)

   !> First 32 bits of the fractional parts of the cube roots of the first 64 primes
   integer(int64), parameter :: K(0:63) = [ &
      int(z'428A2F98', int64), int(z'71374491', int64), int(z'B5C0FBCF', int64), &
      int(z'E9B5DBA5', int64), int(z'3956C25B', int64), int(z'59F111F1', int64), &
      int(z'923F82A4', int64), int(z'AB1C5ED5', int64), int(z'D807AA98', int64), &
      int(z'12835B01', int64), int(z'243185BE', int64), int(z'550C7DC3', int64), &
      int(z'72BE5D74', int64), int(z'80DEB1FE', int64), int(z'9BDC06A7', int64), &
      int(z'C19BF174', int64), int(z'E49B69C1', int64), int(z'EFBE4786', int64), &
      int(z'0FC19DC6', int64), int(z'240CA1CC', int64), int(z'2DE92C6F', int64), &
      int(z'4A7484AA', int64), int(z'5CB0A9DC', int64), int(z'76F988DA', int64), &
      int(z'983E5152', int64), int(z'A831C66D', int64), int(z'B00327C8', int64), &
      int(z'BF597FC7', int64), int(z'C6E00BF3', int64), int(z'D5A79147', int64), &
      int(z'06CA6351', int64), int(z'14292967', int64), int(z'27B70A85', int64), &
      int(z'2E1B2138', int64), int(z'4D2C6DFC', int64), int(z'53380D13', int64), &
      int(z'650A7354', int64), int(z'766A0ABB', int64), int(z'81C2C92E', int64), &
      int(z'92722C85', int64), int(z'A2BFE8A1', int64), int(z'A81A664B', int64), &
      int(z'C24B8B70', int64), int(z'C76C51A3', int64), int(z'D192E819', int64), &
      int(z'D6990624', int64), int(z'F40E3585', int64), int(z'106AA070', int64), &
      int(z'19A4C116', int64), int(z'1E376C08', int64), int(z'2748774C', int64), &
      int(z'34B0BCB5', int64), int(z'391C0CB3', int64), int(z'4ED8AA4A', int64), &
      int(z'5B9CCA4F', int64), int(z'682E6FF3', int64), int(z'748F82EE', int64), &
      int(z'78A5636F', int64), int(z'84C87814', int64), int(z'8CC70208', int64), &
      int(z'90BEFFFA', int64), int(z'A4506CEB', int64), int(z'BEF9A3F7', int64), &
      int(z'C67178F2', int64)]

   !> The same of the square roots of the first 8 primes
   integer(int64), parameter :: H0(8) = [ &
      int(z'6A09E667', int64), int(z'BB67AE85', int64), int(z'3C6EF372', int64), &
      int(z'A54FF53A', int64), int(z'510E527F', int64), int(z'9B05688C', int64), &
      int(z'1F83D9AB', int64), int(z'5BE0CD19', int64)]

contains

   !> Digest of the bytes of a text, 64 lower-case hexadecimal digits
   pure function sha256(text) result(digest)
      character(len=*), intent(in) :: text
      character(len=64) :: digest

      character(len=128) :: tail
      integer(int64) :: h(8), bits
      integer :: i, n_whole, n_rest, n_tail

      h = H0
      n_whole = len(text)/64
      do i = 1, n_whole
         call add_block(text(64*i - 63:64*i), h)
      end do

      ! the rest, a one bit, zeros, and the length in bits as 8 bytes, highest first
      n_rest = len(text) - 64*n_whole
      n_tail = merge(64, 128, n_rest < 56)
      tail = repeat(achar(0), 128)
      tail(:n_rest) = text(64*n_whole + 1:)
      tail(n_rest + 1:n_rest + 1) = char(128)
      bits = 8*len(text, int64)
      do i = 0, 7
         tail(n_tail - i:n_tail - i) = char(int(ibits(bits, 8*i, 8)))
      end do
      do i = 1, n_tail/64
         call add_block(tail(64*i - 63:64*i), h)
      end do

      write (digest, '(8z8.8)') h
      do i = 1, len(digest)
         if (digest(i:i) >= 'A') digest(i:i) = achar(iachar(digest(i:i)) + 32)
      end do
   end function sha256

   !> Work 64 bytes into the hash value
   pure subroutine add_block(block, h)
      character(len=64), intent(in) :: block
      integer(int64), intent(inout) :: h(8)

      integer(int64) :: w(0:63), v(8), t1, t2
      integer :: i, j

      do i = 0, 15
         w(i) = 0
         do j = 1, 4
            w(i) = ior(ishft(w(i), 8), int(ichar(block(4*i + j:4*i + j)), int64))
         end do
      end do
      do i = 16, 63
         t1 = ieor(ieor(turn(w(i - 15), 7), turn(w(i - 15), 18)), ishft(w(i - 15), -3))
         t2 = ieor(ieor(turn(w(i - 2), 17), turn(w(i - 2), 19)), ishft(w(i - 2), -10))
         w(i) = iand(w(i - 16) + t1 + w(i - 7) + t2, MASK)
      end do

      v = h
      do i = 0, 63
         t1 = ieor(ieor(turn(v(5), 6), turn(v(5), 11)), turn(v(5), 25))
         t1 = v(8) + t1 + ieor(iand(v(5), v(6)), iand(iand(not(v(5)), MASK), v(7))) + K(i) + w(i)
         t2 = ieor(ieor(turn(v(1), 2), turn(v(1), 13)), turn(v(1), 22))
         t2 = t2 + ieor(ieor(iand(v(1), v(2)), iand(v(1), v(3))), iand(v(2), v(3)))
         v(2:8) = v(1:7)
         v(5) = iand(v(5) + t1, MASK)
         v(1) = iand(t1 + t2, MASK)
      end do
      h = iand(h + v, MASK)
   end subroutine add_block

   !> Turn a 32-bit word to the right
   pure integer(int64) function turn(word, bits)
      integer(int64), intent(in) :: word
      integer, intent(in) :: bits

      turn = iand(ior(ishft(word, -bits), ishft(word, 32 - bits)), MASK)
   end function turn

end module kj_sha256
