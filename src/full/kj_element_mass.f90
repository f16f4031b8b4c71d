!> Elements -> mass and inertia of their nodes: a plain sum over all elements of a deck.
!> Source: docs/theory/full.md 2.
!>
!> An element is read, weighed and forgotten.
module kj_element_mass
   use kj_kinds, only: wp
   use kj_units, only: D_LENGTH, dimensions
   use kj_sort, only: lookup_t, find
   use kj_keywords, only: KW_SHELL, KW_SH3N, KW_BRICK, KW_TETRA4, KW_PENTA6, KW_TETRA10, &
      KW_BRIC20, &
      KW_SHEL16, KW_BEAM, KW_TRUSS, KW_SPRING
   use kj_error, only: str, SEV_ERROR
   use kj_deck_text, only: block_factors, add_deck_finding
   use kj_card_cut, only: cut_t, cut_card, read_real_at
   use kj_element_cards, only: element_row, element_cards, read_element, MOST_NODES, card_walk_t, &
      start_walk
   use kj_draft, only: draft_t
   use kj_full_property, only: section_t, defaults_t, read_sections, read_defaults, A_SANDWICH, &
      A_SPRING, A_PULLEY, A_STACK, OTHER_SECTION, A_JOINT, material_t, read_materials
   use kj_solid_mass, only: brick_shares, wedge_shares, tetra_shares, tetra10_shares, &
      brick20_shares, shell16_shares, shell_area, triangle_area, triangle_shares, shell_inertia, &
      beam_inertia
   implicit none
   private

   public :: scales_t, element_t, new_scales, weigh_elements, weigh_block, first_element, &
      next_element, weigh

   !> Why the mass of the elements of a part is not known
   integer, parameter, public :: NO_PROBLEM = 0, NO_DENSITY = 1, NO_SECTION = 2, NO_PLIES = 3

   !> What elements are weighed with
   type :: scales_t
      type(material_t), allocatable :: material(:)
      type(section_t), allocatable :: section(:)
      type(lookup_t) :: material_id, section_id
      integer, allocatable :: part_material(:), part_section(:)   !! (parts) 0 = none
      real(wp), allocatable :: part_mass(:)      !! (parts) of their elements
      integer, allocatable :: part_elements(:)   !! (parts) number of them
      integer, allocatable :: problem(:)         !! (parts)
   end type scales_t

   !> One element while it is weighed
   type :: element_t
      integer :: row = 0                         !! of element_cards
      integer :: part = 0, id = 0
      integer :: line = 0                        !! its first
      integer :: raw(MOST_NODES) = 0             !! raw indices of its nodes, 0 = none
      integer :: unknown = 0, unknown_id = 0     !! last of its nodes that is not defined, 0 = none
      real(wp) :: mass(MOST_NODES) = 0.0_wp, inertia(MOST_NODES) = 0.0_wp
      type(card_walk_t) :: walk, start           !! behind it, and before it
   end type element_t

contains

   !> Materials, properties and what the parts make of them
   subroutine new_scales(draft, scales)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(out) :: scales

      type(defaults_t) :: defaults
      integer :: n, i

      call read_defaults(draft%deck, defaults)
      call read_materials(draft, scales%material, scales%material_id)
      call read_sections(draft, defaults, scales%section, scales%section_id)
      n = size(draft%part_block)
      allocate (scales%part_material(n), scales%part_section(n), scales%problem(n), &
         scales%part_elements(n), source=0)
      allocate (scales%part_mass(n), source=0.0_wp)
      do i = 1, n
         scales%part_section(i) = find(scales%section_id, draft%part_ids(1, i))
         scales%part_material(i) = find(scales%material_id, draft%part_ids(2, i))
         scales%problem(i) = problem_of(scales, i)
      end do
   end subroutine new_scales

   !> Why the mass of the elements of a part cannot be told
   pure integer function problem_of(scales, part) result(problem)
      type(scales_t), intent(in) :: scales
      integer, intent(in) :: part

      problem = NO_SECTION
      if (scales%part_section(part) == 0) return
      associate (s => scales%section(scales%part_section(part)))
         problem = NO_PLIES
         if (s%kind == A_STACK) return
         problem = NO_SECTION
         if (s%kind == OTHER_SECTION) return
         problem = NO_PROBLEM
         if (s%kind == A_SPRING .or. s%kind == A_PULLEY .or. s%kind == A_JOINT) return
         if (s%kind == A_SANDWICH) return        ! its layers have materials of their own
      end associate
      problem = NO_DENSITY
      if (scales%part_material(part) == 0) return
      if (scales%material(scales%part_material(part))%known) problem = NO_PROBLEM
   end function problem_of

   !> Add the mass and inertia of all springs, or of all other elements, to the nodes of the draft
   subroutine weigh_elements(draft, scales, springs)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(inout) :: scales
      logical, intent(in) :: springs

      integer :: block, part, n
      real(wp) :: total

      do block = 1, draft%deck%n_block
         if (element_row(draft%deck%block(block)%keyword) == 0) cycle
         if ((draft%deck%block(block)%keyword == KW_SPRING) .neqv. springs) cycle
         part = find(draft%part, draft%deck%block(block)%id)
         if (part == 0) cycle
         call weigh_block(draft, scales, block, 1.0_wp, .true., total, n)
         scales%part_mass(part) = scales%part_mass(part) + total
         scales%part_elements(part) = scales%part_elements(part) + n
      end do
   end subroutine weigh_elements

   !> Add the mass of the elements of a block, times a factor, to the nodes, their inertia if wanted
   subroutine weigh_block(draft, scales, block, factor, with_inertia, total, n)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales
      integer, intent(in) :: block
      real(wp), intent(in) :: factor
      logical, intent(in) :: with_inertia
      real(wp), intent(out) :: total             !! mass of the elements
      integer, intent(out) :: n                  !! number of them

      type(element_t) :: e, wrong
      integer :: i, n_wrong

      total = 0.0_wp
      n = 0
      n_wrong = 0
      call first_element(draft, block, e)
      do
         call next_element(draft, e)
         if (e%row == 0) exit
         n = n + 1
         if (e%unknown > 0) then
            n_wrong = n_wrong + 1
            if (n_wrong == 1) wrong = e
         end if
         call weigh(draft, scales, e)
         do i = 1, MOST_NODES
            if (e%raw(i) == 0) cycle
            draft%mass(e%raw(i)) = draft%mass(e%raw(i)) + factor*e%mass(i)
            if (with_inertia) &
               draft%inertia(e%raw(i)) = draft%inertia(e%raw(i)) + e%inertia(i)
            total = total + e%mass(i)
         end do
      end do
      if (n_wrong == 0) return
      wrong%walk = wrong%start
      call next_element(draft, wrong)            ! its cards may have left memory
      call report_node(draft, wrong, n_wrong)
   end subroutine weigh_block

   !> The finding of elements with a node that is not defined
   subroutine report_node(draft, e, n)
      type(draft_t), intent(inout) :: draft
      type(element_t), intent(in) :: e           !! the first of them
      integer, intent(in) :: n

      integer :: card, field

      field = e%unknown + 1                      ! the id stands before the nodes
      do card = 1, 2
         if (field <= element_cards(e%row)%ints(card)) exit
         field = field - element_cards(e%row)%ints(card)
      end do
      call add_deck_finding(draft%deck, e%line + card - 1, 10*field - 9, 10*field, SEV_ERROR, &
         'KJ-0078', 'node '//str(e%unknown_id)//' of element '//str(e%id)//' is not defined', &
         'no such node', str(n)//' elements of this block have such nodes')
   end subroutine report_node

   !> Stand before the first element of a block
   subroutine first_element(draft, block, e)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: block
      type(element_t), intent(out) :: e

      call start_walk(draft%deck, block, e%walk)
      e%part = find(draft%part, draft%deck%block(block)%id)
   end subroutine first_element

   !> The next element of its block: its nodes, no mass yet; row 0 when there is none
   subroutine next_element(draft, e)
      type(draft_t), intent(inout) :: draft
      type(element_t), intent(inout) :: e

      integer :: node(MOST_NODES), i
      logical :: there

      e%row = element_row(draft%deck%block(e%walk%block)%keyword)
      do
         e%start = e%walk
         call read_element(draft%deck, e%row, e%walk, e%id, node, there)
         if (e%id /= 0 .or. .not. there) exit
      end do
      if (.not. there) e%row = 0
      if (.not. there) return
      e%line = e%walk%line - count(element_cards(e%row)%ints > 0) + 1
      e%unknown = 0
      do i = 1, MOST_NODES
         e%raw(i) = 0
         if (node(i) > 0) e%raw(i) = find(draft%node, node(i))
         if (node(i) == 0 .or. e%raw(i) > 0) cycle
         e%unknown = i
         e%unknown_id = node(i)
      end do
      e%mass = 0.0_wp
      e%inertia = 0.0_wp
   end subroutine next_element

   !> Mass and inertia of the nodes of an element
   subroutine weigh(draft, scales, e)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales
      type(element_t), intent(inout) :: e

      real(wp) :: x(3, MOST_NODES), rho
      integer :: i, section, material

      if (e%part == 0) return
      section = scales%part_section(e%part)
      if (section == 0) return
      x = 0.0_wp
      do i = 1, MOST_NODES
         if (e%raw(i) > 0) x(:, i) = draft%x(e%raw(i), :)
      end do
      material = scales%part_material(e%part)
      rho = 0.0_wp
      if (material > 0) rho = scales%material(material)%density
      associate (s => scales%section(section))
         select case (element_cards(e%row)%keyword)
         case (KW_SHELL, KW_SH3N)
            call weigh_shell(draft, scales, s, rho, x, e)
         case (KW_BEAM, KW_TRUSS)
            e%mass(:2) = 0.5_wp*rho*s%area*norm2(x(:, 2) - x(:, 1))
            if (element_cards(e%row)%keyword == KW_BEAM) e%inertia(:2) = beam_inertia(s, &
               norm2(x(:, 2) - x(:, 1)), rho, nu_of(scales, material), nu_of(scales, material) > &
               -1.0_wp)
         case (KW_SPRING)
            call weigh_spring(s, x, e)
         case default
            call weigh_solid(s, rho, x, e)
         end select
      end associate
   end subroutine weigh

   !> Poisson's ratio; -1 where it is not known
   pure real(wp) function nu_of(scales, material) result(nu)
      type(scales_t), intent(in) :: scales
      integer, intent(in) :: material

      nu = -1.0_wp
      if (material == 0) return
      if (scales%material(material)%elastic) nu = scales%material(material)%nu
   end function nu_of

   !> A shell of one material, or of layers
   subroutine weigh_shell(draft, scales, s, rho, x, e)
      type(draft_t), intent(inout) :: draft
      type(scales_t), intent(in) :: scales
      type(section_t), intent(in) :: s
      real(wp), intent(in) :: rho, x(3, MOST_NODES)
      type(element_t), intent(inout) :: e

      real(wp) :: area, f, t, scale, share(4), m, density
      integer :: n, i, material

      n = 4
      if (element_cards(e%row)%keyword == KW_SH3N) n = 3
      share = 0.25_wp
      if (n == 3) then
         area = triangle_area(x(:, :3))
         share(:3) = triangle_shares(x(:, :3))
         share(4) = 0.0_wp
         f = 4.5_wp
      else
         if (e%raw(4) == 0) e%raw(4) = e%raw(3)
         area = shell_area(reshape([x(:, :3), draft%x(max(1, e%raw(4)), :)], [3, 4]))
         f = merge(12.0_wp, 9.0_wp, s%fine)
      end if
      call card_thickness(draft, e, t)
      if (.not. t > 0.0_wp) t = s%thickness
      if (.not. allocated(s%layer)) then
         e%mass(:n) = rho*t*area*share(:n)
         e%inertia(:n) = e%mass(:n)*shell_inertia(area, f, t, 0.0_wp)
         return
      end if
      scale = 1.0_wp
      if (s%thickness > 0.0_wp) scale = t/s%thickness
      do i = 1, size(s%layer)
         material = find(scales%material_id, s%layer(i)%material)
         density = rho
         if (material > 0) density = scales%material(material)%density
         m = density*s%layer(i)%thickness*scale*area
         e%mass(:n) = e%mass(:n) + m*share(:n)
         e%inertia(:n) = e%inertia(:n) + m*share(:n)*shell_inertia(area, f, &
            s%layer(i)%thickness*scale, s%layer(i)%z*scale)
      end do
   end subroutine weigh_shell

   !> Thickness on the card of a shell, columns 81 to 100; 0 when there is none
   subroutine card_thickness(draft, e, thickness)
      type(draft_t), intent(inout) :: draft
      type(element_t), intent(in) :: e
      real(wp), intent(out) :: thickness

      real(wp) :: factor(size(dimensions))
      type(cut_t) :: cut
      integer :: s, n, i

      thickness = 0.0_wp
      s = draft%deck%line_source(e%line)
      n = element_cards(e%row)%ints(1)           ! integers, then an angle
      associate (text => draft%deck%source(s)%text(draft%deck%line_first(e%line): &
         draft%deck%line_last(e%line)))
         if (len(text) < 81 .and. index(text, ',') == 0) return
         call cut_card(text, n + 2, [(10*i - 9, i=1, n), 61, 81], [(10*i, i=1, n), 80, 100], cut)
      end associate
      if (cut%last(n + 2) < cut%first(n + 2)) return
      factor = block_factors(draft%deck, e%walk%block)
      call read_real_at(draft%deck, e%line, cut%first(n + 2), cut%last(n + 2), 'Thick', &
         'thickness of the element', factor(D_LENGTH), thickness)
   end subroutine card_thickness

   !> Half of the mass to each end; of a pulley a quarter, a half, a quarter
   pure subroutine weigh_spring(s, x, e)
      type(section_t), intent(in) :: s
      real(wp), intent(in) :: x(3, MOST_NODES)
      type(element_t), intent(inout) :: e

      real(wp) :: scale

      if (s%kind == A_PULLEY) then
         scale = 1.0_wp
         if (s%per_length) scale = norm2(x(:, 2) - x(:, 1)) + norm2(x(:, 3) - x(:, 2))
         e%mass(:3) = scale*s%mass*[0.25_wp, 0.5_wp, 0.25_wp]
      else if (s%kind == A_SPRING) then
         scale = 1.0_wp
         if (s%per_length) scale = norm2(x(:, 2) - x(:, 1))
         e%mass(:2) = 0.5_wp*scale*s%mass
         e%inertia(:2) = 0.5_wp*scale*s%inertia
      end if
   end subroutine weigh_spring

   !> A solid; a brick of four nodes is a tetrahedron, one of six a wedge
   pure subroutine weigh_solid(s, rho, x, e)
      type(section_t), intent(in) :: s
      real(wp), intent(in) :: rho, x(3, MOST_NODES)
      type(element_t), intent(inout) :: e

      integer :: keyword

      keyword = element_cards(e%row)%keyword
      if (keyword == KW_BRICK) then
         if (all(e%raw(5:8) == 0)) then
            keyword = KW_TETRA4
         else if (all(e%raw(7:8) == 0)) then
            keyword = KW_PENTA6
         end if
      end if
      select case (keyword)
      case (KW_BRICK)
         e%mass(:8) = rho*brick_shares(x(:, :8), s%isolid)
      case (KW_TETRA4)
         e%mass(:4) = rho*tetra_shares(x(:, :4), s%imas)
      case (KW_PENTA6)
         e%mass(:6) = rho*wedge_shares(x(:, :6), s%imas)
      case (KW_TETRA10)
         e%mass(:10) = rho*tetra10_shares(x(:, :10), e%raw(:10) > 0, s%itetra10, s%imas)
      case (KW_BRIC20)
         e%mass = rho*brick20_shares(x, e%raw > 0)
      case (KW_SHEL16)
         e%mass(:16) = rho*shell16_shares(x(:, :16), e%raw(:16) > 0)
      end select
   end subroutine weigh_solid

end module kj_element_mass
