!> SHA-256 of a text, as FIPS 180-4 defines it. Words are kept in the low half of 64-bit integers.
module kj_sha256
   use, intrinsic :: iso_fortran_env, only: int64
   implicit none
   private

   public :: sha256, sha256_t, add_text, digest_of

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

   !> A digest under way: the text may come in pieces
   type :: sha256_t
      private
      integer(int64) :: h(8) = H0              !! hash value of the whole blocks so far
      character(len=64) :: held = ''           !! the start of the next block
      integer :: n_held = 0                    !! its bytes
      integer(int64) :: n = 0                  !! bytes so far
   end type sha256_t

contains

   !> Digest of the bytes of a text, 64 lower-case hexadecimal digits
   pure function sha256(text) result(digest)
      character(len=*), intent(in) :: text
      character(len=64) :: digest

      type(sha256_t) :: sha

      call add_text(sha, text)
      digest = digest_of(sha)
   end function sha256

   !> Add the next piece of the text
   pure subroutine add_text(sha, text)
      type(sha256_t), intent(inout) :: sha
      character(len=*), intent(in) :: text

      integer :: at, n

      sha%n = sha%n + len(text)
      n = min(len(text), 64 - sha%n_held)
      sha%held(sha%n_held + 1:sha%n_held + n) = text(:n)
      sha%n_held = sha%n_held + n
      if (sha%n_held < 64) return
      call add_block(sha%held, sha%h)
      do at = n, len(text) - 64, 64
         call add_block(text(at + 1:at + 64), sha%h)
      end do
      sha%n_held = modulo(len(text) - n, 64)
      sha%held(:sha%n_held) = text(len(text) - sha%n_held + 1:)
   end subroutine add_text

   !> Digest of what has been added, 64 lower-case hexadecimal digits
   pure function digest_of(sha) result(digest)
      type(sha256_t), intent(in) :: sha
      character(len=64) :: digest

      character(len=128) :: tail
      integer(int64) :: h(8)
      integer :: i, n_tail

      ! the rest, a one bit, zeros, and the length in bits as 8 bytes, highest first
      h = sha%h
      n_tail = merge(64, 128, sha%n_held < 56)
      tail = sha%held(:sha%n_held)//char(128)//repeat(achar(0), 127 - sha%n_held)
      do i = 0, 7
         tail(n_tail - i:n_tail - i) = char(int(ibits(8*sha%n, 8*i, 8)))
      end do
      do i = 1, n_tail/64
         call add_block(tail(64*i - 63:64*i), h)
      end do

      write (digest, '(8z8.8)') h
      do i = 1, len(digest)
         if (digest(i:i) >= 'A') digest(i:i) = achar(iachar(digest(i:i)) + 32)
      end do
   end function digest_of

   !> Work 64 bytes into the hash value
   pure subroutine add_block(block, hash)
      character(len=64), intent(in) :: block
      integer(int64), intent(inout) :: hash(8)

      integer(int64) :: w(0:63), x, y, a, b, c, d, e, f, g, h
      integer :: i

      do i = 0, 15
         w(i) = ior(ior(shiftl(int(ichar(block(4*i + 1:4*i + 1)), int64), 24), &
            shiftl(int(ichar(block(4*i + 2:4*i + 2)), int64), 16)), &
            ior(shiftl(int(ichar(block(4*i + 3:4*i + 3)), int64), 8), &
            int(ichar(block(4*i + 4:4*i + 4)), int64)))
      end do
      do i = 16, 63
         x = twice(w(i - 15))
         y = twice(w(i - 2))
         w(i) = iand(MASK, w(i - 16) + w(i - 7) + &
            iand(MASK, ieor(ieor(shiftr(x, 7), shiftr(x, 18)), shiftr(w(i - 15), 3))) + &
            iand(MASK, ieor(ieor(shiftr(y, 17), shiftr(y, 19)), shiftr(w(i - 2), 10))))
      end do

      a = hash(1)
      b = hash(2)
      c = hash(3)
      d = hash(4)
      e = hash(5)
      f = hash(6)
      g = hash(7)
      h = hash(8)
      do i = 0, 63, 8                          ! names move on by one each round
         call mix(K(i) + w(i), a, b, c, d, e, f, g, h)
         call mix(K(i + 1) + w(i + 1), h, a, b, c, d, e, f, g)
         call mix(K(i + 2) + w(i + 2), g, h, a, b, c, d, e, f)
         call mix(K(i + 3) + w(i + 3), f, g, h, a, b, c, d, e)
         call mix(K(i + 4) + w(i + 4), e, f, g, h, a, b, c, d)
         call mix(K(i + 5) + w(i + 5), d, e, f, g, h, a, b, c)
         call mix(K(i + 6) + w(i + 6), c, d, e, f, g, h, a, b)
         call mix(K(i + 7) + w(i + 7), b, c, d, e, f, g, h, a)
      end do
      hash = iand(MASK, hash + [a, b, c, d, e, f, g, h])
   end subroutine add_block

   !> One round: the new values of d and h
   pure subroutine mix(kw, a, b, c, d, e, f, g, h)
      integer(int64), intent(in) :: kw         !! constant and word of the round
      integer(int64), intent(in) :: a, b, c, e, f, g
      integer(int64), intent(inout) :: d, h

      integer(int64) :: x

      x = twice(e)
      h = h + kw + ieor(g, iand(e, ieor(f, g))) + &
         iand(MASK, ieor(ieor(shiftr(x, 6), shiftr(x, 11)), shiftr(x, 25)))
      d = iand(MASK, d + h)
      x = twice(a)
      h = iand(MASK, h + ior(iand(a, b), iand(c, ior(a, b))) + &
         iand(MASK, ieor(ieor(shiftr(x, 2), shiftr(x, 13)), shiftr(x, 22))))
   end subroutine mix

   !> A 32-bit word twice, side by side: shifted right, its low half is the word turned right
   pure integer(int64) function twice(word)
      integer(int64), intent(in) :: word

      twice = ior(word, shiftl(word, 32))
   end function twice

end module kj_sha256
