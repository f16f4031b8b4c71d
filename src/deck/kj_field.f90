!> What a field of a card is: its place, name, kind and dimension.
module kj_field
   use kj_keywords, only: keywords, KW_NODE, KW_GRNOD_NODE, KW_GRNOD_NODENS, KW_GRNOD_GENE, &
      KW_GRNOD_GEN_INCR, KW_TH_NODE, KW_SPRING, KW_TH_SPRING, KW_GRNOD_PART, KW_TH_PART, &
      KW_GRNOD_MAT, KW_GRNOD_PROP, KW_GRNOD_SUBMODEL
   implicit none
   private

   public :: field_t, named_by_field, named_by_header, named_by_clause

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

   !> A family of ids. A submodel shifts the first six by offsets of their own.
   integer, parameter, public :: OF_NOTHING = 0, OF_NODE = 1, OF_ELEMENT = 2, OF_PART = 3, &
      OF_MATERIAL = 4, OF_PROPERTY = 5, OF_SUBMODEL = 6, OF_SKEW = 7, OF_FRAME = 8, &
      OF_GROUP = 9, OF_FUNCTION = 10, OF_SENSOR = 11, OF_OTHER = 12

   integer, parameter :: NODE_IDS(*) = [KW_NODE, KW_GRNOD_NODE, KW_GRNOD_NODENS, KW_GRNOD_GENE, &
      KW_GRNOD_GEN_INCR, KW_TH_NODE]

contains


   !> Family that a field names: OF_ constant, OF_NOTHING when it is no id
   pure integer function named_by_field(f) result(family)
      type(field_t), intent(in) :: f

      family = OF_NOTHING
      if (f%kind /= 'i') return
      select case (f%name)
      case ('n1', 'n2', 'n3', 'n4', 'n5', 'n6', 'node_id'); family = OF_NODE
      case ('skew_id', 'skew_1', 'skew_2'); family = OF_SKEW
      case ('frame_id'); family = OF_FRAME
      case ('grnod_id'); family = OF_GROUP
      case ('sens_id'); family = OF_SENSOR
      case ('mat_id'); family = OF_MATERIAL
      case ('prop_id'); family = OF_PROPERTY
      case ('part_id'); family = OF_PART
      case ('submodel'); family = OF_SUBMODEL
      case ('surf_id', 'subset_id', 'grpart_id'); family = OF_OTHER
      case ('id'); family = named_by_list(f%keyword)
      case default
         if (f%name(:2) == 'f_' .or. f%name(:3) == 'fct') family = OF_FUNCTION
      end select
   end function named_by_field

   !> Family of the ids that a block lists
   pure integer function named_by_list(keyword) result(family)
      integer, intent(in) :: keyword             !! KW_ constant

      family = OF_OTHER
      if (any(NODE_IDS == keyword)) family = OF_NODE
      if (any([KW_SPRING, KW_TH_SPRING] == keyword)) family = OF_ELEMENT
      if (any([KW_GRNOD_PART, KW_TH_PART] == keyword)) family = OF_PART
      if (keyword == KW_GRNOD_MAT) family = OF_MATERIAL
      if (keyword == KW_GRNOD_PROP) family = OF_PROPERTY
      if (keyword == KW_GRNOD_SUBMODEL) family = OF_SUBMODEL
   end function named_by_list

   !> Family of the id in a header; elements stand under the id of their part
   pure integer function named_by_header(row, is_element) result(family)
      integer, intent(in) :: row                 !! of the table of keywords
      logical, intent(in) :: is_element

      family = OF_OTHER
      if (is_element .or. keywords(row)%name == '/PART') family = OF_PART
      if (index(keywords(row)%name, '/MAT') == 1) family = OF_MATERIAL
      if (index(keywords(row)%name, '/PROP') == 1) family = OF_PROPERTY
      if (keywords(row)%name == '//SUBMODEL') family = OF_SUBMODEL
      if (index(keywords(row)%name, '/UNIT') == 1 .or. keywords(row)%name == '/PARAMETER') &
         family = OF_NOTHING
   end function named_by_header

   !> Family of the ids of a clause of a /SET, or of a list such as /GRSHEL/PART
   pure integer function named_by_clause(word) result(family)
      character(len=*), intent(in) :: word       !! NODE, PART_D, SHEL, ...

      family = OF_OTHER
      select case (word(:max(0, scan(word//'_', '_') - 1)))
      case ('NODE', 'SEG'); family = OF_NODE
      case ('PART'); family = OF_PART
      case ('SUBM', 'SUBMODEL'); family = OF_SUBMODEL
      case ('MAT'); family = OF_MATERIAL
      case ('PROP'); family = OF_PROPERTY
      case ('SOLID', 'QUAD', 'SHELL', 'SH3N', 'TRIA', 'BEAM', 'TRUSS', 'SPRING', 'SHEL', 'BRIC', &
         'TRUS', 'SPRI', 'GENE'); family = OF_ELEMENT
      end select
   end function named_by_clause

end module kj_field
