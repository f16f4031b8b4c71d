!> What a field of a card is: its place, name, kind and dimension.
module kj_field
   implicit none
   private

   public :: field_t

   !> How often a card stands in a block
   integer, parameter, public :: &
      ONCE = 1, &       !! once
      ROWS = 2, &       !! up to the end of the block
      DOFS = 3, &       !! cards 2, 3, ... once for each direction: K becomes K_tx, K_ty, ...
      IDS = 4, &        !! ids of ten columns each, to the end of the block
      PAIRS = 5, &      !! as IDS, two belong together
      TRIPLES = 6, &    !! as IDS, three on a card belong together
      NAMES = 7, &      !! names of ten columns each, up to the first card with a number
      CLAUSES = 8       !! a word and ids, to the end of the block

   integer, parameter, public :: EACH = -1   !! fields that all variants of a keyword have

   !> A row of the tables of fields. Cards are counted without the title.
   type :: field_t
      integer           :: keyword       !! owner, KW_ constant
      integer           :: variant       !! EACH, joint type (KJOINT) or type in the header (ADMAS)
      integer           :: card          !! card number inside the block
      integer           :: times         !! ONCE, ROWS, ...
      integer           :: first, last   !! columns, 1-based, inclusive
      character(len=12) :: name
      character(len=1)  :: kind          !! i integer, r real, a text
      integer           :: dim           !! D_ constant: unit conversion
      integer           :: since         !! first format version that has the field
      character(len=48) :: meaning
   end type field_t

end module kj_field
