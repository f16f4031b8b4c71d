!> Decks that the accuracy tests write: bodies, joints, loads, a call each.
module accuracy_deck
   use kjoint, only: wp
   implicit none
   private

   public :: deck_t, new_deck, add_body, add_joint, add_motion, add_curve, add_gravity, add_load, &
      add_drive
   public :: ramp_curve, write_deck, turn_about, GLOBAL_AXES

   character(len=1), parameter :: EOL = new_line('a')
   real(wp), parameter :: GLOBAL_AXES(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, &
      0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
   integer, parameter :: FREE(6, 9) = reshape([ &
      0, 0, 0, 1, 1, 1,  0, 0, 0, 1, 0, 0,  1, 0, 0, 1, 0, 0, &
      0, 1, 1, 1, 0, 0,  0, 0, 0, 0, 1, 1,  1, 0, 0, 0, 0, 0, &
      0, 1, 1, 0, 0, 0,  0, 0, 0, 0, 0, 0,  1, 1, 1, 1, 1, 1], [6, 9])

   !> A body: main node 1000*id, secondary nodes 1000*id + 1 and so on
   type :: body_t
      character(len=:), allocatable :: card      !! /RBODY without its group
      integer :: n_node = 0
      logical :: held = .false.
   end type body_t

   !> A scene; kg, m, s
   type :: deck_t
      character(len=:), allocatable :: nodes, blocks
      type(body_t), allocatable :: body(:)
      integer :: n_body = 0, n_joint = 0, n_skew = 0, n_curve = 0, n_other = 0
      real(wp) :: t_stop = 1.0_wp, sample = 0.01_wp
      real(wp) :: dt_max = 0.0_wp                !! /DTIX, 0 = none
      real(wp) :: dt_ini = 0.0_wp                !! /DTIX, 0 = dt_max
   end type deck_t

contains

   subroutine new_deck(deck, t_stop, sample)
      type(deck_t), intent(out) :: deck
      real(wp), intent(in) :: t_stop, sample

      deck%nodes = ''
      deck%blocks = ''
      deck%t_stop = t_stop
      deck%sample = sample
      allocate (deck%body(200))
   end subroutine new_deck

   !> A rigid body with its centre of gravity at x; its id is deck%n_body afterwards
   subroutine add_body(deck, x, mass, inertia, held)
      type(deck_t), intent(inout) :: deck
      real(wp), intent(in) :: x(3), mass
      real(wp), intent(in) :: inertia(6)         !! xx yy zz xy yz xz
      logical, intent(in) :: held                !! all six dofs blocked

      integer :: id

      id = deck%n_body + 1
      deck%n_body = id
      deck%nodes = deck%nodes//node_card(1000*id, x)
      associate (b => deck%body(id))
         b%card = '/RBODY/'//int_text(id)//EOL//'body'//EOL//ints([1000*id, 0, 0, 0])//reals([mass])// &
            ints([id, 0, 3, 0])//EOL//reals(inertia(1:3))//EOL//reals(inertia(4:6))//EOL//ints([0, 0])//EOL
         b%held = held
      end associate
      call add_group(deck, 10000 + id, [1000*id])
      if (held) deck%blocks = deck%blocks//'/BCS/'//int_text(id)//EOL//'held'//EOL//'   111 111'// &
         ints([0, 10000 + id])//EOL
   end subroutine add_body

   !> Start velocity and angular velocity of a body
   subroutine add_motion(deck, body, v, w)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: body
      real(wp), intent(in) :: v(3), w(3)

      deck%n_other = deck%n_other + 2
      deck%blocks = deck%blocks//'/INIVEL/TRA/'//int_text(deck%n_other - 1)//EOL//'v'//EOL//reals(v)// &
         ints([10000 + body, 0])//EOL//'/INIVEL/ROT/'//int_text(deck%n_other)//EOL//'w'//EOL//reals(w)// &
         ints([10000 + body, 0])//EOL
   end subroutine add_motion

   !> A joint from x1 on body 1 to x2 on body 2
   subroutine add_joint(deck, type, skew_flag, body, x1, x2, e1, e2, kn, cr, k, c, curve, loose)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: type, skew_flag
      integer, intent(in) :: body(2)
      real(wp), intent(in) :: x1(3), x2(3)
      real(wp), intent(in) :: e1(3, 3), e2(3, 3) !! axes of the skews, columns
      real(wp), intent(in) :: kn, cr
      real(wp), intent(in) :: k(6), c(6)         !! of the free directions
      integer, intent(in), optional :: curve     !! function of the stiffness of a type with one free direction
      integer, intent(in), optional :: loose     !! body that has the third node of the second skew

      character(len=:), allocatable :: id
      integer :: node(2), law

      law = 0
      if (present(curve)) law = curve
      call add_end(deck, body(1), x1, e1, node(1))
      call add_end(deck, body(2), x2, e2, node(2), loose)
      deck%n_joint = deck%n_joint + 1
      id = int_text(deck%n_joint)
      deck%blocks = deck%blocks//'/PROP/KJOINT/'//id//EOL//'joint'//EOL//ints([type, skew_flag])//EOL// &
         ints([deck%n_skew - 1, deck%n_skew])//reals([0.0_wp, cr])//EOL//law_cards(type, kn, k, c, law)// &
         '/PART/'//id//EOL//'joint'//EOL//ints([deck%n_joint, 0, 0])//EOL// &
         '/SPRING/'//id//EOL//ints([900 + deck%n_joint, node])//EOL
   end subroutine add_joint

   !> Joint node with its moving skew on a body
   subroutine add_end(deck, body, x, e, node, loose)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: body
      real(wp), intent(in) :: x(3), e(3, 3)
      integer, intent(out) :: node
      integer, intent(in), optional :: loose     !! another body that has the third node

      integer :: owner, third

      owner = body
      if (present(loose)) owner = loose
      node = 1000*body + deck%body(body)%n_node + 1
      deck%body(body)%n_node = deck%body(body)%n_node + 2
      deck%body(owner)%n_node = deck%body(owner)%n_node + 1
      third = 1000*owner + deck%body(owner)%n_node
      deck%nodes = deck%nodes//node_card(node, x)//node_card(node + 1, x + e(:, 1))// &
         node_card(third, x + e(:, 2))
      deck%n_skew = deck%n_skew + 1
      deck%blocks = deck%blocks//'/SKEW/MOV/'//int_text(deck%n_skew)//EOL//'skew'//EOL// &
         ints([node, node + 1, third])//EOL
   end subroutine add_end

   !> Cards of /PROP/KJOINT from the fourth on
   function law_cards(type, kn, k, c, curve) result(text)
      integer, intent(in) :: type, curve
      real(wp), intent(in) :: kn, k(6), c(6)
      character(len=:), allocatable :: text

      real(wp), allocatable :: kf(:), cf(:)

      kf = pack(k, FREE(:, type) == 1)
      cf = pack(c, FREE(:, type) == 1)
      select case (type)
      case (1)
         text = reals([kn, kf])//EOL//ints([0, 0, 0])//EOL//reals(cf)//EOL//ints([0, 0, 0])//EOL
      case (4)
         text = reals([kn, kf(1:2)])//ints([0, 0])//EOL//reals(kf(3:3))//ints([0])//EOL//reals(cf)//EOL// &
            ints([0, 0, 0])//EOL
      case (8)
         text = reals([kn])//EOL
      case (9)
         text = reals(kf(1:3))//EOL//reals(kf(4:6))//EOL//ints([0, 0, 0])//EOL//ints([0, 0, 0])//EOL// &
            reals(cf(1:3))//EOL//reals(cf(4:6))//EOL//ints([0, 0, 0])//EOL//ints([0, 0, 0])//EOL
      case default
         text = reals([kn, kf])//ints(curve + 0*nint(kf))//EOL//reals(cf)//ints(0*nint(cf))//EOL
      end select
   end function law_cards

   !> A function; its id is deck%n_curve afterwards
   subroutine add_curve(deck, x, y)
      type(deck_t), intent(inout) :: deck
      real(wp), intent(in) :: x(:), y(:)

      integer :: i

      deck%n_curve = deck%n_curve + 1
      deck%blocks = deck%blocks//'/FUNCT/'//int_text(deck%n_curve)//EOL//'curve'//EOL
      do i = 1, size(x)
         deck%blocks = deck%blocks//reals([x(i), y(i)])//EOL
      end do
   end subroutine add_curve

   !> 0 to 1 over [0, span] by s^4 (35 - 84 s + 70 s^2 - 20 s^3): three continuous derivatives, as a
   !> table with points every dx
   subroutine ramp_curve(deck, span, dx)
      type(deck_t), intent(inout) :: deck
      real(wp), intent(in) :: span, dx

      real(wp), allocatable :: s(:)
      integer :: i

      s = [(i*dx/span, i=0, nint(span/dx))]
      call add_curve(deck, [s*span, 2.0_wp*span], &
         [s**4*(35.0_wp - 84.0_wp*s + 70.0_wp*s**2 - 20.0_wp*s**3), 1.0_wp])
   end subroutine ramp_curve

   !> Gravity along an axis on all bodies that are not held
   subroutine add_gravity(deck, dir, value, curve)
      type(deck_t), intent(inout) :: deck
      character(len=1), intent(in) :: dir
      real(wp), intent(in) :: value
      integer, intent(in) :: curve               !! 0: constant

      integer :: i

      deck%n_other = deck%n_other + 1
      call add_group(deck, 20000 + deck%n_other, &
         pack([(1000*i, i=1, deck%n_body)], .not. deck%body(:deck%n_body)%held))
      deck%blocks = deck%blocks//'/GRAV/'//int_text(deck%n_other)//EOL//'gravity'//EOL//ints([curve])// &
         '         '//dir//ints([0, 0, 20000 + deck%n_other])//repeat(' ', 10)//reals([1.0_wp, value])//EOL
   end subroutine add_gravity

   !> Concentrated load on the centre of gravity of a body; dir X Y Z XX YY ZZ
   subroutine add_load(deck, body, dir, value, curve)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: body, curve
      character(len=2), intent(in) :: dir
      real(wp), intent(in) :: value

      deck%n_other = deck%n_other + 1
      deck%blocks = deck%blocks//'/CLOAD/'//int_text(deck%n_other)//EOL//'load'//EOL//ints([curve])// &
         '        '//dir//ints([0, 0, 10000 + body])//repeat(' ', 10)//reals([1.0_wp, value])//EOL
   end subroutine add_load

   !> Imposed velocity of a body; dir X Y Z XX YY ZZ
   subroutine add_drive(deck, body, dir, value, curve)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: body, curve
      character(len=2), intent(in) :: dir
      real(wp), intent(in) :: value

      deck%n_other = deck%n_other + 1
      deck%blocks = deck%blocks//'/IMPVEL/'//int_text(deck%n_other)//EOL//'drive'//EOL//ints([curve])// &
         '        '//dir//ints([0, 0, 10000 + body, 0, 0])//EOL//reals([1.0_wp, value, 0.0_wp, 0.0_wp])//EOL
   end subroutine add_drive

   !> Write ROOT_0000.rad and ROOT_0001.rad
   subroutine write_deck(deck, root)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: root

      integer :: unit, i, k

      open (newunit=unit, file=root//'_0000.rad', action='write', status='replace')
      write (unit, '(a)') '#RADIOSS STARTER', '/BEGIN', 'TEST', '      2022         0', &
         '                  kg                   m                   s', &
         '                  kg                   m                   s', '/TITLE', 'accuracy test'
      write (unit, '(a)', advance='no') '/NODE'//EOL//deck%nodes
      do i = 1, deck%n_body
         associate (n => deck%body(i)%n_node)
            write (unit, '(a)') '/GRNOD/NODE/'//int_text(i), 'nodes of the body'
            write (unit, '(a)') ints([(1000*i + k, k=1, n)])
            write (unit, '(a)', advance='no') deck%body(i)%card
         end associate
      end do
      write (unit, '(a)', advance='no') deck%blocks
      write (unit, '(a)') '/END'
      close (unit)
      open (newunit=unit, file=root//'_0001.rad', action='write', status='replace')
      write (unit, '(a)') '/RUN/TEST/1', reals([deck%t_stop]), '/VERS/2022', '/TFILE/1', reals([deck%sample])
      if (deck%dt_max > 0.0_wp) write (unit, '(a)') '/DTIX', &
         reals([merge(deck%dt_ini, deck%dt_max, deck%dt_ini > 0.0_wp), deck%dt_max])
      close (unit)
   end subroutine write_deck

   subroutine add_group(deck, id, nodes)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: id, nodes(:)

      deck%blocks = deck%blocks//'/GRNOD/NODE/'//int_text(id)//EOL//'group'//EOL//ints(nodes)//EOL
   end subroutine add_group

   function node_card(id, x) result(text)
      integer, intent(in) :: id
      real(wp), intent(in) :: x(3)
      character(len=:), allocatable :: text

      text = ints([id])//reals(x)//EOL
   end function node_card

   !> Fields of ten columns, ten to a line
   function ints(values) result(text)
      integer, intent(in) :: values(:)
      character(len=:), allocatable :: text

      character(len=10) :: field
      integer :: i

      text = ''
      do i = 1, size(values)
         if (i > 1 .and. modulo(i, 10) == 1) text = text//EOL
         write (field, '(i10)') values(i)
         text = text//field
      end do
   end function ints

   !> Fields of twenty columns
   function reals(values) result(text)
      real(wp), intent(in) :: values(:)
      character(len=:), allocatable :: text

      character(len=24) :: field
      integer :: i

      text = ''
      do i = 1, size(values)
         write (field, '(f20.15)') values(i)
         if (abs(values(i)) >= 10.0_wp .or. abs(values(i)) < 1.0e-2_wp) write (field, '(es20.13)') values(i)
         if (abs(values(i)) >= 10.0_wp .and. abs(values(i)) < 1.0e7_wp) write (field, '(f20.10)') values(i)
         if (abs(values(i)) <= 0.0_wp) field = '                 0.0'
         text = text//field(:20)
      end do
   end function reals

   function int_text(i) result(text)
      integer, intent(in) :: i
      character(len=:), allocatable :: text

      character(len=12) :: buffer

      write (buffer, '(i0)') i
      text = trim(buffer)
   end function int_text

   !> Axes turned by an angle [rad] about a unit vector
   pure function turn_about(axis, angle) result(r)
      real(wp), intent(in) :: axis(3), angle
      real(wp) :: r(3, 3)

      real(wp) :: n(3), k(3, 3)

      n = axis/norm2(axis)
      k = reshape([0.0_wp, n(3), -n(2), -n(3), 0.0_wp, n(1), n(2), -n(1), 0.0_wp], [3, 3])
      r = GLOBAL_AXES + sin(angle)*k + (1.0_wp - cos(angle))*matmul(k, k)
   end function turn_about

end module accuracy_deck
