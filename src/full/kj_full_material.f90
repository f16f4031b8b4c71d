!> Cards -> density of materials, and the elasticity that the inertia of beams asks for.
!> Source: docs/theory/full.md 2.
module kj_full_material
   use kj_kinds, only: wp
   use kj_units, only: dimensions, D_DENSITY
   use kj_sort, only: lookup_t, new_lookup
   use kj_keywords, only: keywords, KW_MAT_VOID
   use kj_deck_text, only: deck_t, block_factors, kind_word
   use kj_draft, only: draft_t
   use kj_full_card, only: card_real
   implicit none
   private

   public :: material_t, read_materials

   !> A material
   type :: material_t
      integer :: block = 0                       !! of the deck
      real(wp) :: density = 0.0_wp
      logical :: known = .true.                  !! its density follows from its first card
      logical :: elastic = .false.               !! nu is known
      real(wp) :: nu = 0.0_wp
      logical :: void = .false.                  !! its elements have no stiffness
      logical :: rigid = .false.                 !! they are rigid bodies
   end type material_t

   !> Laws whose density is not on the first card, or none of ours
   character(len=10), parameter :: OTHERS(*) = [character(len=10) :: 'LAW20', 'BIMAT', 'LAW151', &
      'MULTIFLUID', 'LAW51', 'MULTIMAT', 'LAW37', 'BIPHAS', 'PLAS_PREDE', 'LAW108', 'SPR_GENE', &
      'LAW113', 'SPR_BEAM', 'LAW114', 'LAW135', 'LAW13', 'RIGID']
   !> Laws without any
   character(len=10), parameter :: NONE(*) = [character(len=10) :: 'GAS', 'LAW29', 'LAW30', 'LAW31']
   !> Laws whose second card begins with E and nu
   character(len=10), parameter :: ELASTIC(*) = [character(len=10) :: 'LAW1', 'LAW01', 'ELAST', &
      'LAW2', 'LAW02', 'PLAS_JOHNS', 'LAW36', 'PLAS_TAB', 'LAW44', 'COWPER', 'LAW27', 'PLAS_BRIT', &
      'LAW22', 'DAMA', 'LAW23', 'PLAS_DAMA', 'LAW0', 'VOID']

contains

   !> All materials of a deck, and the lookup from their ids
   subroutine read_materials(draft, list, id)
      type(draft_t), intent(inout) :: draft
      type(material_t), allocatable, intent(out) :: list(:)
      type(lookup_t), intent(out) :: id

      integer, allocatable :: blocks(:)
      integer :: i

      blocks = pack([(i, i=1, draft%deck%n_block)], [(is_material(draft%deck, i), &
         i=1, draft%deck%n_block)])
      call new_lookup(draft%deck%block(blocks)%id, id)
      allocate (list(size(blocks)))
      do i = 1, size(blocks)
         call read_material(draft, blocks(i), list(i))
      end do
   end subroutine read_materials

   pure logical function is_material(deck, block)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block

      is_material = .false.
      if (deck%block(block)%row > 0) is_material = &
         index(keywords(deck%block(block)%row)%name, '/MAT') == 1
   end function is_material

   subroutine read_material(draft, block, material)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: block
      type(material_t), intent(out) :: material

      real(wp) :: factor(size(dimensions))
      character(len=10) :: law

      material%block = block
      law = kind_word(draft%deck, block)
      material%void = draft%deck%block(block)%keyword == KW_MAT_VOID
      material%known = all(OTHERS /= law)
      material%rigid = law == 'LAW13' .or. law == 'RIGID'
      if (.not. material%known .or. any(NONE == law) .or. index(law, 'USER') == 1) return
      factor = block_factors(draft%deck, block)
      call card_real(draft%deck, block, 1, 1, factor(D_DENSITY), material%density, &
         fine=material%known)
      material%elastic = any(ELASTIC == law)
      if (.not. material%elastic) return
      if (material%void) then
         call card_real(draft%deck, block, 1, 41, 1.0_wp, material%nu, fine=material%elastic)
      else
         call card_real(draft%deck, block, 2, 21, 1.0_wp, material%nu, fine=material%elastic)
      end if
   end subroutine read_material

end module kj_full_material
