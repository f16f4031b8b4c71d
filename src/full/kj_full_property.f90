!> Cards -> what the mass of elements takes from their property: thickness, area, layers, rules.
!> Source: docs/theory/full.md 2.
!> One file: what the cards of a full deck say, and how they are read
module kj_full_property
   use kj_kinds, only: wp
   use kj_units, only: dimensions, D_LENGTH, D_MASS, D_INERTIA, D_DENSITY
   use kj_sort, only: lookup_t, new_lookup
   use kj_keywords, only: keywords, KW_DEF_SOLID, KW_DEF_SHELL, KW_MAT_VOID
   use kj_deck_text, only: deck_t, block_factors, kind_word, id_shift, first_card, line_text
   use kj_field, only: OF_MATERIAL
   use kj_draft, only: draft_t
   use kj_number, only: parse_real, parse_integer, NUMBER_FINE
   use kj_card_cut, only: read_real_at, read_integer_at, cut_t, cut_card, MOST_ON_CARD
   implicit none
   private

   public :: section_t, layer_t, defaults_t, read_sections, read_defaults, material_t, &
      read_materials, card_real, card_integer

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

   !> What a property is for
   integer, parameter, public :: OTHER_SECTION = 0, A_SHELL = 1, A_SANDWICH = 2, A_VOID = 3, &
      A_TRUSS = 4, A_BEAM = 5, AN_INTEGRATED_BEAM = 6, A_SOLID = 7, A_SPRING = 8, A_PULLEY = 9, &
      A_STACK = 10, A_JOINT = 11

   !> A layer of a shell
   type :: layer_t
      real(wp) :: thickness = 0.0_wp, z = 0.0_wp !! z: of its middle
      integer :: material = 0                    !! id
   end type layer_t

   !> A property
   type :: section_t
      integer :: block = 0                       !! of the deck
      integer :: kind = OTHER_SECTION
      real(wp) :: thickness = 0.0_wp             !! of shells
      logical :: fine = .false.                  !! Ishell of 11 and more
      type(layer_t), allocatable :: layer(:)
      integer :: isolid = 1, itetra10 = 0, imas = 0
      real(wp) :: area = 0.0_wp, iyy = 0.0_wp, izz = 0.0_wp, ixx = 0.0_wp   !! of beams and trusses
      logical :: integrated = .false.            !! a beam by points
      real(wp) :: mass = 0.0_wp, inertia = 0.0_wp   !! of springs
      logical :: per_length = .false.            !! these are per unit of length
   end type section_t

   !> /DEF_SHELL, /DEF_SOLID: where a property says 0
   type :: defaults_t
      integer :: ishell = 1, isolid = 1, itetra10 = 0, imas = 0
   end type defaults_t

   !> What the second word of /PROP/WORD says
   type :: word_t
      character(len=10) :: name
      integer           :: kind
   end type word_t

   type(word_t), parameter :: words(*) = [ &
      word_t('SHELL', A_SHELL), word_t('TYPE1', A_SHELL), word_t('SH_ORTH', A_SHELL), &
      word_t('TYPE9', A_SHELL), word_t('SH_COMP', A_SHELL), word_t('TYPE10', A_SHELL), &
      word_t('SH_SANDW', A_SANDWICH), word_t('TYPE11', A_SANDWICH), &
      word_t('SH_FABR', A_SANDWICH), word_t('TYPE16', A_SANDWICH), word_t('VOID', A_VOID), &
      word_t('TYPE0', A_VOID), word_t('TRUSS', A_TRUSS), word_t('TYPE2', A_TRUSS), &
      word_t('BEAM', A_BEAM), word_t('TYPE3', A_BEAM), word_t('INT_BEAM', AN_INTEGRATED_BEAM), &
      word_t('TYPE18', AN_INTEGRATED_BEAM), word_t('SOLID', A_SOLID), word_t('TYPE14', A_SOLID), &
      word_t('SOL_ORTH', A_SOLID), word_t('TYPE6', A_SOLID), word_t('TSHELL', A_SOLID), &
      word_t('TYPE20', A_SOLID), word_t('TSH_ORTH', A_SOLID), word_t('TYPE21', A_SOLID), &
      word_t('TSH_COMP', A_SOLID), word_t('TYPE22', A_SOLID), word_t('SPRING', A_SPRING), &
      word_t('TYPE4', A_SPRING), word_t('SPR_GENE', A_SPRING), word_t('TYPE8', A_SPRING), &
      word_t('SPR_BEAM', A_SPRING), word_t('TYPE13', A_SPRING), word_t('SPR_AXI', A_SPRING), &
      word_t('TYPE25', A_SPRING), word_t('SPR_PRE', A_SPRING), word_t('TYPE32', A_SPRING), &
      word_t('SPR_PUL', A_PULLEY), word_t('TYPE12', A_PULLEY), word_t('STACK', A_STACK), &
      word_t('TYPE17', A_STACK), word_t('TYPE51', A_STACK), word_t('TYPE52', A_STACK), &
      word_t('PCOMPP', A_STACK), word_t('KJOINT', A_JOINT), word_t('TYPE33', A_JOINT), &
      word_t('KJOINT2', A_JOINT), word_t('TYPE45', A_JOINT)]

   real(wp), parameter :: LEAST = 1.0e-20_wp     !! of the mass and inertia of some springs

contains

   !> Defaults of elements
   subroutine read_defaults(deck, defaults)
      type(deck_t), intent(inout) :: deck
      type(defaults_t), intent(out) :: defaults

      integer :: block

      do block = 1, deck%n_block
         if (deck%block(block)%keyword == KW_DEF_SHELL) &
            call card_integer(deck, block, 1, 1, defaults%ishell)
         if (deck%block(block)%keyword /= KW_DEF_SOLID) cycle
         call card_integer(deck, block, 1, 1, defaults%isolid)
         call card_integer(deck, block, 1, 51, defaults%itetra10)
         call card_integer(deck, block, 1, 61, defaults%imas)
      end do
      if (defaults%ishell == 0) defaults%ishell = 1
      if (defaults%isolid == 0) defaults%isolid = 1
   end subroutine read_defaults

   !> All properties of a deck, and the lookup from their ids
   subroutine read_sections(draft, defaults, list, id)
      type(draft_t), intent(inout) :: draft
      type(defaults_t), intent(in) :: defaults
      type(section_t), allocatable, intent(out) :: list(:)
      type(lookup_t), intent(out) :: id

      integer, allocatable :: blocks(:)
      integer :: i

      blocks = pack([(i, i=1, draft%deck%n_block)], [(is_property(draft%deck, i), &
         i=1, draft%deck%n_block)])
      call new_lookup(draft%deck%block(blocks)%id, id)
      allocate (list(size(blocks)))
      do i = 1, size(blocks)
         call read_section(draft, blocks(i), defaults, list(i))
      end do
   end subroutine read_sections

   pure logical function is_property(deck, block)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block

      is_property = .false.
      if (deck%block(block)%row > 0) is_property = &
         index(keywords(deck%block(block)%row)%name, '/PROP') == 1
   end function is_property

   subroutine read_section(draft, block, defaults, s)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: block
      type(defaults_t), intent(in) :: defaults
      type(section_t), intent(out) :: s

      character(len=10) :: word
      real(wp) :: f(size(dimensions))
      integer :: row

      s%block = block
      word = kind_word(draft%deck, block)
      row = findloc(words%name, word, 1)
      if (row > 0) s%kind = words(row)%kind
      f = block_factors(draft%deck, block)
      select case (s%kind)
      case (A_SHELL, A_SANDWICH)
         call read_shell(draft, block, defaults, f(D_LENGTH), s)
         if (s%kind == A_SANDWICH) call read_layers(draft, block, any(word == &
            [character(len=10) :: 'SH_FABR', 'TYPE16']), f(D_LENGTH), s)
      case (A_VOID)
         call card_real(draft%deck, block, 1, 1, f(D_LENGTH), s%thickness)
         s%fine = defaults%ishell >= 11
         s%isolid = defaults%isolid
      case (A_TRUSS)
         call card_real(draft%deck, block, 1, 1, f(D_LENGTH)**2, s%area)
      case (A_BEAM)
         call card_real(draft%deck, block, 3, 1, f(D_LENGTH)**2, s%area)
         call card_real(draft%deck, block, 3, 21, f(D_LENGTH)**4, s%iyy)
         call card_real(draft%deck, block, 3, 41, f(D_LENGTH)**4, s%izz)
         call card_real(draft%deck, block, 3, 61, f(D_LENGTH)**4, s%ixx)
      case (AN_INTEGRATED_BEAM)
         call read_points(draft, block, f(D_LENGTH), s)
      case (A_SOLID)
         s%imas = defaults%imas
         s%itetra10 = defaults%itetra10
         call card_integer(draft%deck, block, 1, 1, s%isolid)
         if (s%isolid == 0) s%isolid = defaults%isolid
         call card_integer(draft%deck, block, 1, 41, row)
         if (row > 0 .and. any(word == [character(len=10) :: 'SOLID', 'TYPE14'])) s%itetra10 = row
      case (A_SPRING, A_PULLEY)
         call read_spring(draft, block, word, f, s)
      end select
   end subroutine read_section

   !> Thickness and form of a shell
   subroutine read_shell(draft, block, defaults, length, s)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: block
      type(defaults_t), intent(in) :: defaults
      real(wp), intent(in) :: length             !! factor of lengths
      type(section_t), intent(inout) :: s

      integer :: ishell

      call card_integer(draft%deck, block, 1, 1, ishell)
      if (ishell == 0) ishell = defaults%ishell
      s%fine = ishell >= 11
      call card_real(draft%deck, block, 3, 21, length, s%thickness, 3)
   end subroutine read_shell

   !> Layers of a sandwich or a fabric: stacked in their order, or where their Z says (Ipos 1)
   subroutine read_layers(draft, block, fabric, length, s)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: block
      logical, intent(in) :: fabric              !! its cards have two angles
      real(wp), intent(in) :: length
      type(section_t), intent(inout) :: s

      real(wp) :: below
      integer :: n, i, ipos, first, id

      call card_integer(draft%deck, block, 3, 1, n)
      call card_integer(draft%deck, block, 4, 81, ipos, 6)
      first = merge(41, 21, fabric)
      allocate (s%layer(max(0, min(n, 1000))))
      below = -0.5_wp*s%thickness
      do i = 1, size(s%layer)
         associate (l => s%layer(i))
            call card_real(draft%deck, block, 4 + i, first, length, l%thickness)
            call card_real(draft%deck, block, 4 + i, first + 20, length, l%z)
            call card_integer(draft%deck, block, 4 + i, first + 40, id, merge(5, 4, fabric))
            l%material = id
            if (id > 0) l%material = id + id_shift(draft%deck, draft%deck%block(block)%submodel, &
               OF_MATERIAL)
            if (ipos == 1) cycle
            l%z = below + 0.5_wp*l%thickness
            below = below + l%thickness
         end associate
      end do
   end subroutine read_layers

   !> Area and moments of a beam from its points: I = sum of a^2/12 + a y^2
   subroutine read_points(draft, block, length, s)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: block
      real(wp), intent(in) :: length
      type(section_t), intent(inout) :: s

      real(wp) :: y, z, a
      integer :: n, i

      s%integrated = .true.
      call card_integer(draft%deck, block, 3, 1, n)
      do i = 1, n
         call card_real(draft%deck, block, 3 + i, 1, length, y)
         call card_real(draft%deck, block, 3 + i, 21, length, z)
         call card_real(draft%deck, block, 3 + i, 41, length**2, a)
         s%area = s%area + a
         s%iyy = s%iyy + a**2/12.0_wp + a*y**2
         s%izz = s%izz + a**2/12.0_wp + a*z**2
      end do
      s%ixx = s%iyy + s%izz
   end subroutine read_points

   !> Mass and inertia of a spring, and whether they are per unit of length
   subroutine read_spring(draft, block, word, f, s)
      type(draft_t), intent(inout) :: draft
      integer, intent(in) :: block
      character(len=*), intent(in) :: word
      real(wp), intent(in) :: f(:)               !! one per D_ constant
      type(section_t), intent(inout) :: s

      integer :: ileng
      logical :: six                             ! laws: it has an inertia

      six = any(word == [character(len=10) :: 'SPR_GENE', 'TYPE8', 'SPR_BEAM', 'TYPE13', &
         'SPR_AXI', &
         'TYPE25'])
      call card_real(draft%deck, block, 1, 1, f(D_MASS), s%mass)
      if (six) call card_real(draft%deck, block, 1, 21, f(D_INERTIA), s%inertia)
      if (six) s%inertia = max(s%inertia, LEAST)
      select case (word)
      case ('SPR_GENE', 'TYPE8', 'SPR_PRE', 'TYPE32')
         ileng = 0
      case ('SPR_BEAM', 'TYPE13', 'SPR_AXI', 'TYPE25')
         s%mass = max(s%mass, LEAST)
         call card_integer(draft%deck, block, 1, 81, ileng, 7)
      case default
         call card_integer(draft%deck, block, 1, 71, ileng, 5)
      end select
      s%per_length = ileng == 1
   end subroutine read_spring

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

   !> A block has a card of this number, the title not counted
   pure logical function has_card(deck, block, card)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: block, card

      has_card = first_card(deck, block) + card - 1 <= deck%block(block)%last
   end function has_card

   !> Real in twenty columns of a card, in work units; 0 when it is blank or missing
   !>
   !> Where it may not matter, `fine` tells that it is a number or blank; else a finding does.
   subroutine card_real(deck, block, card, first, factor, value, item, fine)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block, card         !! the title is not counted
      integer, intent(in) :: first               !! column
      real(wp), intent(in) :: factor             !! input to work units
      real(wp), intent(out) :: value
      integer, intent(in), optional :: item      !! in free format; first/20 + 1
      logical, intent(out), optional :: fine

      integer :: line, a, b, status

      value = 0.0_wp
      if (present(fine)) fine = .true.
      if (.not. has_card(deck, block, card)) return
      line = first_card(deck, block) + card - 1
      call find_field(line_text(deck, line), first, first + 19, a, b, item)
      if (.not. present(fine)) then
         call read_real_at(deck, line, a, b, 'the field', 'a real number', factor, value)
      else if (b >= a) then
         call parse_real(line_part(deck, line, a, b), value, status)
         fine = status == NUMBER_FINE
         value = merge(value*factor, 0.0_wp, fine)
      end if
   end subroutine card_real

   !> Integer in ten columns of a card; 0 when it is blank or missing. Likewise
   subroutine card_integer(deck, block, card, first, value, item, fine)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: block, card, first
      integer, intent(out) :: value
      integer, intent(in), optional :: item      !! in free format; first/10 + 1
      logical, intent(out), optional :: fine

      integer :: line, a, b, status

      value = 0
      if (present(fine)) fine = .true.
      if (.not. has_card(deck, block, card)) return
      line = first_card(deck, block) + card - 1
      call find_field(line_text(deck, line), first, first + 9, a, b, item)
      if (.not. present(fine)) then
         call read_integer_at(deck, line, a, b, 'the field', 'an integer', value)
      else if (b >= a) then
         call parse_integer(line_part(deck, line, a, b), value, status)
         fine = status == NUMBER_FINE
         if (.not. fine) value = 0
      end if
   end subroutine card_integer

   !> Columns of a line
   pure function line_part(deck, line, first, last) result(text)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: line, first, last
      character(len=last - first + 1) :: text

      character(len=last) :: start

      start = line_text(deck, line)
      text = start(first:)
   end function line_part

   !> Columns of the text in a field; b < a when it is blank
   pure subroutine find_field(text, first, last, a, b, item)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first, last
      integer, intent(out) :: a, b
      integer, intent(in), optional :: item      !! in free format

      type(cut_t) :: cut
      integer :: n, i

      n = 1
      if (index(text, ',') > 0) n = min(MOST_ON_CARD, first/(last - first + 1) + 1)
      if (present(item) .and. n > 1) n = item
      if (n == 1) call cut_card(text, 1, [first], [last], cut)
      if (n > 1) call cut_card(text, n, [(10*i - 9, i=1, n)], [(10*i, i=1, n)], cut)
      a = cut%first(n)
      b = cut%last(n)
   end subroutine find_field

end module kj_full_property
