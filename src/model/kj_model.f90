!> Constant data of a run. Everything is in work units and refers to internal indices.
!>
!> Nodes are numbered so that loops are plain: main nodes of bodies first (body b is node b), then
!> the free nodes that can move by themselves, then the secondary nodes body by body: the ends of
!> joints and springs, which every cycle reads, and after them the others. The first two kinds are
!> the "leads": they carry mass and are integrated; secondary nodes follow.
module kj_model
   use kj_kinds, only: wp
   use kj_error, only: str, width_of
   use kj_text, only: text_t
   use kj_units, only: unit_system_t
   use kj_curve, only: curve_set_t
   use kj_joint_batch, only: joint_batch_t
   use kj_lead_map, only: lead_map_t
   implicit none
   private

   public :: model_t, skew_set_t, joint_title, body_title

   !> Skew axes; index 0 is the global frame
   type :: skew_set_t
      integer :: n = 0
      integer, allocatable :: id(:)            !! (n) user ids
      integer, allocatable :: node(:, :)       !! (3, n) nodes of a moving skew, 0 for a fixed one
      integer, allocatable :: dir(:)           !! (n) axis along node 1 -> node 2: 1 x, 2 y, 3 z
      real(wp), allocatable :: axes(:, :)      !! (0:n, 9) columns E1 E2 E3 at the start
      integer, allocatable :: needed(:)        !! moving skews that are read in every cycle
   end type skew_set_t

   !> Boundary conditions of one lead
   type, public :: bcs_t
      integer :: lead = 0
      integer :: skew = 0                      !! skew index, 0 = global
      logical :: fixed(6) = .false.            !! translations, rotations along the skew axes
   end type bcs_t

   integer, parameter, public :: BY_TIME = 1, BY_DISPLACEMENT = 2, BY_VELOCITY = 3

   !> One load card: concentrated load or gravity, on many nodes
   type, public :: load_t
      integer :: id = 0                        !! user id of the card
      integer :: curve = 0                     !! index, 0 = constant 1
      integer :: dir = 1                       !! 1-3 force or acceleration, 4-6 moment
      integer :: skew = 0
      integer :: abscissa = BY_TIME            !! BY_ constant
      real(wp) :: t_start = 0.0_wp             !! time of its sensor
      real(wp) :: t_stop = huge(1.0_wp)
      logical :: sensed = .false.
      real(wp) :: x_scale = 1.0_wp, y_scale = 1.0_wp
      integer, allocatable :: node(:)          !! node indices; of gravity leads only
   end type load_t

   integer, parameter, public :: IMPOSE_VELOCITY = 1, IMPOSE_DISPLACEMENT = 2, &
      IMPOSE_ACCELERATION = 3

   !> Imposed motion of one dof of one lead
   type, public :: motion_t
      integer :: kind = 0                      !! IMPOSE_ constant
      integer :: lead = 0
      integer :: dir = 1                       !! 1-6
      integer :: skew = 0
      integer :: curve = 0
      logical :: sensed = .false.
      real(wp) :: x_scale = 1.0_wp, y_scale = 1.0_wp
      real(wp) :: t_start = 0.0_wp, t_stop = huge(1.0_wp)
      real(wp) :: t_sensor = 0.0_wp, t_off = huge(1.0_wp)   !! times of its sensor
   end type motion_t

   !> Place of a joint or spring in the batches, and what messages and histories say of it
   type, public :: joint_ref_t
      integer :: id = 0, property = 0, part = 0     !! user ids
      integer :: row = 0                            !! row of kj_joint_types
      integer :: batch = 0, place = 0
      integer :: node(2) = 0                        !! node indices
   end type joint_ref_t

   integer, parameter, public :: SCALE_NONE = 0, SCALE_MASS = 1, SCALE_MASS_NEXT = 2, STOP_BELOW = 3

   !> Engine controls
   type, public :: control_t
      real(wp) :: t_stop = 0.0_wp
      real(wp) :: sample = 1.0e30_wp           !! time-history interval
      real(wp) :: dt_factor = 0.0_wp           !! scale of the nodal time step
      real(wp) :: dt_min = 0.0_wp
      integer :: below_min = SCALE_NONE        !! what happens to a node below dt_min
      real(wp) :: dt_ini = 0.0_wp              !! /DTIX, 0 = not given
      real(wp) :: dt_max = 1.0e20_wp
      logical :: nodal_step = .true.           !! by a TYPE33 joint or /DT/NODA
      !> the step of the leads of TYPE45 joints and of TYPE8 springs, without nodal_step
      logical :: joint_step = .false.
      logical :: element_step = .false.        !! of TYPE4 springs, without /DT/NODA
      integer :: print_every = 100
      integer :: run_number = 1                !! above 1 a run goes on from a saved state
      real(wp) :: stop_energy = huge(1.0_wp)   !! energy error, as a fraction, that ends the run
      logical :: stop_saves = .false.          !! its state is saved then
      logical :: checkpoint = .false.          !! its state is saved at its end
      integer :: checkpoint_cycles = huge(1)   !! and every so many cycles
      integer :: threads = 1
      integer :: least_share = 500             !! joints or leads that a thread needs to be worth it
   end type control_t

   !> The scene
   type :: model_t
      character(len=:), allocatable :: title
      type(unit_system_t) :: units
      type(control_t) :: control
      integer :: n_node = 0, n_body = 0, n_lead = 0, n_joint = 0, n_spring = 0
      integer :: n_element = 0                     !! joints and springs
      ! nodes
      integer, allocatable :: node_id(:)           !! (n_node) user ids
      integer, allocatable :: lead(:)              !! (n_node) the lead that carries the node
      real(wp), allocatable :: x0(:, :)            !! (n_node, 3) main nodes already at their place
      real(wp), allocatable :: v0(:, :)            !! (n_node, 3)
      real(wp), allocatable :: w0(:, :)            !! (n_lead, 3)
      real(wp), allocatable :: mass(:)             !! (n_lead)
      real(wp), allocatable :: inertia(:)          !! (n_lead) nodal: smallest principal for a body
      real(wp), allocatable :: node_mass(:), node_inertia(:)   !! (n_node) own, of secondary nodes
      ! bodies
      integer, allocatable :: body_id(:)           !! (n_body) user ids
      integer, allocatable :: n_secondary(:)       !! (n_body) how many nodes each body carries
      real(wp), allocatable :: principal(:, :)     !! (n_body, 3) inertia, descending
      real(wp), allocatable :: axes(:, :)          !! (n_body, 9) principal axes, columns, W
      integer, allocatable :: ispher(:)            !! (n_body)
      type(text_t), allocatable :: body_name(:)
      ! everything else
      type(skew_set_t) :: skews
      type(curve_set_t) :: curves
      type(joint_batch_t), allocatable :: batch(:)
      !> (n_element) joints in deck order, then springs in deck order
      type(joint_ref_t), allocatable :: joint(:)
      type(text_t), allocatable :: joint_name(:)   !! (n_element) title of the part
      type(lead_map_t) :: map
      type(bcs_t), allocatable :: bcs(:)
      type(load_t), allocatable :: gravity(:), cload(:)
      type(motion_t), allocatable :: motion(:)
      ! what the history holds, ascending user id: indices into joint(:), bodies, nodes
      integer, allocatable :: th_joint(:), th_spring(:), th_body(:), th_node(:)
      integer, allocatable :: th_node_skew(:)      !! skew index of each, 0 = global
      type(text_t), allocatable :: th_node_name(:)
   end type model_t

contains

   !> Letters of a title, by the names of all (perhaps none) and the place of one; without its id
   pure integer function name_length(name, k) result(n)
      type(text_t), allocatable, intent(in) :: name(:)
      integer, intent(in) :: k

      n = 0
      if (.not. allocated(name)) return
      if (len_trim(name(k)%s) > 0) n = len_trim(name(k)%s) + 3
   end function name_length

   !> A joint or spring as people know it: "pin C (903)"; its id where it has no name
   pure function joint_title(model, j) result(title)
      type(model_t), intent(in) :: model
      integer, intent(in) :: j
      character(len=name_length(model%joint_name, j) + width_of(model%joint(j)%id)) :: title

      title = str(model%joint(j)%id)
      if (len(title) > len_trim(title)) title = trim(model%joint_name(j)%s)//' ('//trim(title)//')'
   end function joint_title

   !> The same of a rigid body
   pure function body_title(model, b) result(title)
      type(model_t), intent(in) :: model
      integer, intent(in) :: b
      character(len=name_length(model%body_name, b) + width_of(model%body_id(b))) :: title

      title = str(model%body_id(b))
      if (len(title) > len_trim(title)) title = trim(model%body_name(b)%s)//' ('//trim(title)//')'
   end function body_title

end module kj_model
