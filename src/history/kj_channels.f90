!> THE table of output channels: name and group in the history file, what they mean, and where
!> the Radioss time history (T01) keeps them. kj_sample computes them, kj_sink_h5 writes them.
module kj_channels
   use kj_units, only: NUM => D_NUMBER, LEN => D_LENGTH, MASS => D_MASS, TIME => D_TIME, &
      FORCE => D_FORCE, MOMENT => D_MOMENT, VEL => D_VELOCITY, ANGVEL => D_ANGULAR_VELOCITY, &
      ACC => D_ACCELERATION, ANGACC => D_ANGULAR_ACCELERATION, ENERGY => D_ENERGY, &
      ANGLE => D_ANGLE, MOMTM => D_MOMENTUM, ANGMOM => D_ANGULAR_MOMENTUM
   implicit none
   private

   public :: channel_t, group_t, find_channel, find_t01, sampled_at

   !> Owners: which group of the file a channel stands in, one series per owner
   integer, parameter, public :: OF_RUN = 1, OF_JOINT = 2, OF_BODY = 3, OF_NODE = 4, &
      OF_SPRING = 5

   !> A group of the file: the place of one kind of owner
   type :: group_t
      character(len=10) :: path      !! group in the file; '' is the root
      character(len=6)  :: entity    !! name of the entity dimension and of its scale
      integer           :: t01_type  !! type code of the T01 file, negative where there is none
   end type group_t

   type(group_t), parameter, public :: groups(5) = [ &
      group_t('',           '',      -1), &
      group_t('joint',      'joint',  6), &
      group_t('rigid_body', 'body', 103), &
      group_t('node',       'node',   0), &
      group_t('spring',     'spring', -2)]

   !> Time level of a sample under the legacy formulation; consistent samples everything at t
   integer, parameter, public :: AT_T = 1, AT_HALF = 2, AT_NEXT = 3

   !> Type of the dataset
   integer, parameter, public :: AS_F64 = 1, AS_I64 = 2, AS_I32 = 3, AS_I8 = 4
   integer, parameter, public :: STORED_BYTES(4) = [8, 8, 4, 1]    !! of these

   !> One row of the channel table
   type :: channel_t
      integer           :: owner       !! OF_ constant
      character(len=20) :: name        !! dataset name
      integer           :: n_comp      !! 1, 3 (axis), 4 (quaternion) or 6 (axis6)
      integer           :: kind        !! AS_ constant
      integer           :: dim         !! D_ constant, gives the unit
      character(len=20) :: class       !! @channel_class
      character(len=6)  :: frame       !! @frame: joint, global or ''
      integer           :: at          !! AT_ constant, time level under legacy
      integer           :: t01         !! code of the first component in T01, 0 = not there
      character(len=12) :: radioss     !! @radioss_name
      character(len=60) :: meaning     !! @long_name
   end type channel_t

   ! the same constants by short names, so that a row is one line
   integer, parameter :: RUN = OF_RUN, JOINT = OF_JOINT, BODY = OF_BODY, NODE = OF_NODE, &
      SPRING = OF_SPRING, &
      F64 = AS_F64, I64 = AS_I64, I32 = AS_I32, I8 = AS_I8, T = AT_T, HALF = AT_HALF, NEXT = AT_NEXT
   character(len=6), parameter :: W = 'global', J = 'joint'

   type(channel_t), parameter, public :: channels(*) = [ &
      ! owner, name, n_comp, kind, dim, class, frame, at, t01, radioss, meaning
      channel_t(RUN, 'time', 1, F64, TIME, 'time', '', T, 0, 'TIME', 'time'), &
      channel_t(RUN, 'cycle', 1, I64, NUM, 'control', '', T, 0, '', 'cycle number'), &
      channel_t(RUN, 'time_step', 1, F64, TIME, 'control', '', T, 7, 'DT', 'coming time step'), &
      channel_t(RUN, 'kinetic_energy_trans', 1, F64, ENERGY, 'energy', '', T, 2, 'KE', 'translational kinetic energy'), &
      channel_t(RUN, 'kinetic_energy_rot', 1, F64, ENERGY, 'energy', '', T, 8, 'RKE', 'rotational kinetic energy'), &
      channel_t(RUN, 'internal_energy', 1, F64, ENERGY, 'energy', '', T, 1, 'IE', 'work done on all joints and springs'), &
      channel_t(RUN, 'external_work', 1, F64, ENERGY, 'energy', '', T, 9, 'EFW', 'work of loads and imposed motion'), &
      channel_t(RUN, 'potential_energy', 1, F64, ENERGY, 'energy', '', T, 0, '', 'potential of constant gravity'), &
      channel_t(RUN, 'energy_error', 1, F64, NUM, 'energy', '', T, 0, '', 'energy error as a fraction'), &
      channel_t(RUN, 'momentum_x', 1, F64, MOMTM, 'momentum', W, T, 3, 'XMOM', 'linear momentum, x'), &
      channel_t(RUN, 'momentum_y', 1, F64, MOMTM, 'momentum', W, T, 4, 'YMOM', 'linear momentum, y'), &
      channel_t(RUN, 'momentum_z', 1, F64, MOMTM, 'momentum', W, T, 5, 'ZMOM', 'linear momentum, z'), &
      channel_t(RUN, 'angular_momentum_x', 1, F64, ANGMOM, 'momentum', W, T, 0, '', 'angular momentum about the origin, x'), &
      channel_t(RUN, 'angular_momentum_y', 1, F64, ANGMOM, 'momentum', W, T, 0, '', 'angular momentum about the origin, y'), &
      channel_t(RUN, 'angular_momentum_z', 1, F64, ANGMOM, 'momentum', W, T, 0, '', 'angular momentum about the origin, z'), &
      channel_t(RUN, 'mass', 1, F64, MASS, 'control', '', T, 6, 'MASS', 'total mass'), &
      channel_t(RUN, 'time_step_owner_kind', 1, I8, NUM, 'flag', '', T, 0, '', 'kind of what limits the step'), &
      channel_t(RUN, 'time_step_owner', 1, I32, NUM, 'flag', '', T, 0, '', 'user id of what limits the step'), &
      channel_t(RUN, 'final', 1, I8, NUM, 'flag', '', T, 0, '', '1 on a last state after the last sample time'), &
      channel_t(JOINT, 'position', 3, F64, LEN, 'displacement', W, T, 0, '', 'where the joint acts, midway between its nodes'), &
      channel_t(JOINT, 'force', 3, F64, FORCE, 'force', J, T, 2, 'FX FY FZ', 'joint force on node 1'), &
      channel_t(JOINT, 'moment', 3, F64, MOMENT, 'moment', J, T, 5, 'MX MY MZ', 'joint moment on node 1'), &
      channel_t(JOINT, 'displacement', 3, F64, LEN, 'displacement', J, T, 8, 'LX LY LZ', 'displacement of node 2 from node 1'), &
      channel_t(JOINT, 'rotation', 3, F64, ANGLE, 'rotation', J, T, 11, 'RX RY RZ', 'rotation of end 2 relative to end 1'), &
      channel_t(JOINT, 'velocity', 3, F64, VEL, 'velocity', J, HALF, 0, '', 'rate of the displacement'), &
      channel_t(JOINT, 'angular_velocity', 3, F64, ANGVEL, 'angular_velocity', J, HALF, 0, '', 'rate of the rotation'), &
      channel_t(JOINT, 'internal_energy', 1, F64, ENERGY, 'energy', '', T, 14, 'IE', 'work done on the joint'), &
      channel_t(JOINT, 'elastic_energy', 1, F64, ENERGY, 'energy', '', T, 0, '', 'energy stored in the elastic laws'), &
      channel_t(JOINT, 'dissipated_energy', 1, F64, ENERGY, 'energy', '', T, 0, '', 'internal less elastic energy'), &
      channel_t(JOINT, 'length', 1, F64, LEN, 'displacement', '', T, 65, 'LENGTH', 'distance of the two nodes'), &
      channel_t(JOINT, 'violation_trans', 1, F64, LEN, 'displacement', '', T, 0, '', 'norm of the blocked displacements'), &
      channel_t(JOINT, 'violation_rot', 1, F64, ANGLE, 'rotation', '', T, 0, '', 'norm of the blocked rotations'), &
      channel_t(JOINT, 'frame', 4, F64, NUM, 'rotation', W, T, 0, '', 'joint frame: world from joint'), &
      channel_t(JOINT, 'orthogonality', 1, F64, ANGLE, 'rotation', '', T, 0, '', 'loss of orthogonality of the joint frame'), &
      channel_t(JOINT, 'state', 6, I8, NUM, 'flag', J, T, 0, '', 'what each direction does'), &
      channel_t(JOINT, 'friction_energy', 1, F64, ENERGY, 'energy', '', T, 0, '', 'energy that sliding friction took'), &
      channel_t(JOINT, 'gap', 3, F64, LEN, 'displacement', J, T, 0, '', 'way to the nearest stop, NaN where there is none'), &
      channel_t(JOINT, 'gap_rot', 3, F64, ANGLE, 'rotation', J, T, 0, '', 'angle to the nearest stop, NaN where there is none'), &
      channel_t(BODY, 'position', 3, F64, LEN, 'displacement', W, T, 16, 'X Y Z', 'position of the main node'), &
      channel_t(BODY, 'velocity', 3, F64, VEL, 'velocity', W, HALF, 22, 'VX VY VZ', 'velocity of the main node'), &
      channel_t(BODY, 'angular_velocity', 3, F64, ANGVEL, 'angular_velocity', W, HALF, 28, 'VRX VRY VRZ', 'angular velocity'), &
      channel_t(BODY, 'acceleration', 3, F64, ACC, 'acceleration', W, T, 25, 'AX AY AZ', 'acceleration of the main node'), &
      channel_t(BODY, 'angular_acceleration', 3, F64, ANGACC, 'acceleration', W, T, 31, 'ARX ARY ARZ', 'angular acceleration'), &
      channel_t(BODY, 'force', 3, F64, FORCE, 'force', W, T, 0, '', 'force of joints, loads and gravity'), &
      channel_t(BODY, 'moment', 3, F64, MOMENT, 'moment', W, T, 0, '', 'moment of joints and loads about the centre of gravity'), &
      channel_t(BODY, 'impulse', 3, F64, MOMTM, 'force', W, T, 1, 'FX FY FZ', 'impulse of forces on secondary nodes'), &
      channel_t(BODY, 'angular_impulse', 3, F64, ANGMOM, 'moment', W, T, 4, 'MX MY MZ', 'impulse of moments on secondary nodes'), &
      channel_t(BODY, 'rotation_sum', 3, F64, ANGLE, 'rotation', W, NEXT, 7, 'RX RY RZ', 'sum of angular velocity times step'), &
      channel_t(BODY, 'orientation', 4, F64, NUM, 'rotation', W, T, 0, '', 'rotation from the initial pose'), &
      channel_t(BODY, 'kinetic_energy', 1, F64, ENERGY, 'energy', '', T, 0, '', 'kinetic energy of the body'), &
      channel_t(NODE, 'position', 3, F64, LEN, 'displacement', W, T, 16, 'X Y Z', 'position'), &
      channel_t(NODE, 'displacement', 3, F64, LEN, 'displacement', W, T, 1, 'DX DY DZ', 'displacement'), &
      channel_t(NODE, 'velocity', 3, F64, VEL, 'velocity', W, HALF, 4, 'VX VY VZ', 'velocity'), &
      channel_t(NODE, 'angular_velocity', 3, F64, ANGVEL, 'angular_velocity', W, HALF, 10, 'VRX VRY VRZ', 'angular velocity'), &
      channel_t(NODE, 'acceleration', 3, F64, ACC, 'acceleration', W, T, 7, 'AX AY AZ', 'acceleration'), &
      channel_t(NODE, 'angular_acceleration', 3, F64, ANGACC, 'acceleration', W, T, 13, 'ARX ARY ARZ', 'angular acceleration'), &
      channel_t(SPRING, 'force', 3, F64, FORCE, 'force', J, T, 0, 'FX FY FZ', 'spring force on node 1, spring axes'), &
      channel_t(SPRING, 'moment', 3, F64, MOMENT, 'moment', J, T, 0, 'MX MY MZ', 'spring moment on node 1'), &
      channel_t(SPRING, 'displacement', 3, F64, LEN, 'displacement', J, T, 0, 'LX LY LZ', 'displacement of node 2 from node 1'), &
      channel_t(SPRING, 'rotation', 3, F64, ANGLE, 'rotation', J, T, 0, 'RX RY RZ', 'rotation of end 2 relative to end 1'), &
      channel_t(SPRING, 'internal_energy', 1, F64, ENERGY, 'energy', '', T, 0, 'IE', 'work done on the spring'), &
      channel_t(SPRING, 'length', 1, F64, LEN, 'displacement', '', T, 0, 'LENGTH', 'distance of its nodes')]

   !> Rows of the channel table, found by owner and name; 0 would be none
   character(len=20), parameter :: N(*) = channels%name
   logical, parameter :: OF_R(*) = channels%owner == RUN, OF_J(*) = channels%owner == JOINT, &
      OF_B(*) = channels%owner == BODY, OF_N(*) = channels%owner == NODE, &
      OF_S(*) = channels%owner == SPRING
   integer, parameter, public :: &
      CH_TIME = findloc(N, 'time', 1, OF_R), CH_CYCLE = findloc(N, 'cycle', 1, OF_R), &
      CH_TIME_STEP = findloc(N, 'time_step', 1, OF_R), &
      CH_KE_TRANS = findloc(N, 'kinetic_energy_trans', 1, OF_R), &
      CH_KE_ROT = findloc(N, 'kinetic_energy_rot', 1, OF_R), &
      CH_IE = findloc(N, 'internal_energy', 1, OF_R), &
      CH_WORK = findloc(N, 'external_work', 1, OF_R), &
      CH_POTENTIAL = findloc(N, 'potential_energy', 1, OF_R), &
      CH_ENERGY_ERROR = findloc(N, 'energy_error', 1, OF_R), &
      CH_MOM_X = findloc(N, 'momentum_x', 1, OF_R), CH_MOM_Y = findloc(N, 'momentum_y', 1, OF_R), &
      CH_MOM_Z = findloc(N, 'momentum_z', 1, OF_R), &
      CH_ANG_X = findloc(N, 'angular_momentum_x', 1, OF_R), &
      CH_ANG_Y = findloc(N, 'angular_momentum_y', 1, OF_R), &
      CH_ANG_Z = findloc(N, 'angular_momentum_z', 1, OF_R), &
      CH_MASS = findloc(N, 'mass', 1, OF_R), &
      CH_OWNER_KIND = findloc(N, 'time_step_owner_kind', 1, OF_R), &
      CH_OWNER = findloc(N, 'time_step_owner', 1, OF_R), CH_FINAL = findloc(N, 'final', 1, OF_R), &
      CH_J_POS = findloc(N, 'position', 1, OF_J), &
      CH_J_FORCE = findloc(N, 'force', 1, OF_J), CH_J_MOMENT = findloc(N, 'moment', 1, OF_J), &
      CH_J_DISP = findloc(N, 'displacement', 1, OF_J), &
      CH_J_ROT = findloc(N, 'rotation', 1, OF_J), CH_J_VEL = findloc(N, 'velocity', 1, OF_J), &
      CH_J_ANGVEL = findloc(N, 'angular_velocity', 1, OF_J), &
      CH_J_IE = findloc(N, 'internal_energy', 1, OF_J), &
      CH_J_ELASTIC = findloc(N, 'elastic_energy', 1, OF_J), &
      CH_J_DISSIPATED = findloc(N, 'dissipated_energy', 1, OF_J), &
      CH_J_LENGTH = findloc(N, 'length', 1, OF_J), &
      CH_J_VIOL_T = findloc(N, 'violation_trans', 1, OF_J), &
      CH_J_VIOL_R = findloc(N, 'violation_rot', 1, OF_J), &
      CH_J_FRAME = findloc(N, 'frame', 1, OF_J), &
      CH_J_ORTHO = findloc(N, 'orthogonality', 1, OF_J), &
      CH_J_STATE = findloc(N, 'state', 1, OF_J), &
      CH_J_FRICTION = findloc(N, 'friction_energy', 1, OF_J), &
      CH_J_GAP = findloc(N, 'gap', 1, OF_J), CH_J_GAP_ROT = findloc(N, 'gap_rot', 1, OF_J), &
      CH_B_POS = findloc(N, 'position', 1, OF_B), CH_B_VEL = findloc(N, 'velocity', 1, OF_B), &
      CH_B_ANGVEL = findloc(N, 'angular_velocity', 1, OF_B), &
      CH_B_ACC = findloc(N, 'acceleration', 1, OF_B), &
      CH_B_ANGACC = findloc(N, 'angular_acceleration', 1, OF_B), &
      CH_B_FORCE = findloc(N, 'force', 1, OF_B), CH_B_MOMENT = findloc(N, 'moment', 1, OF_B), &
      CH_B_IMPULSE = findloc(N, 'impulse', 1, OF_B), &
      CH_B_ANGIMP = findloc(N, 'angular_impulse', 1, OF_B), &
      CH_B_ROTSUM = findloc(N, 'rotation_sum', 1, OF_B), &
      CH_B_ORIENT = findloc(N, 'orientation', 1, OF_B), &
      CH_B_KE = findloc(N, 'kinetic_energy', 1, OF_B), &
      CH_N_POS = findloc(N, 'position', 1, OF_N), &
      CH_N_DISP = findloc(N, 'displacement', 1, OF_N), &
      CH_N_VEL = findloc(N, 'velocity', 1, OF_N), &
      CH_N_ANGVEL = findloc(N, 'angular_velocity', 1, OF_N), &
      CH_N_ACC = findloc(N, 'acceleration', 1, OF_N), &
      CH_N_ANGACC = findloc(N, 'angular_acceleration', 1, OF_N), &
      CH_S_FORCE = findloc(N, 'force', 1, OF_S), CH_S_MOMENT = findloc(N, 'moment', 1, OF_S), &
      CH_S_DISP = findloc(N, 'displacement', 1, OF_S), &
      CH_S_ROT = findloc(N, 'rotation', 1, OF_S), &
      CH_S_IE = findloc(N, 'internal_energy', 1, OF_S), &
      CH_S_LENGTH = findloc(N, 'length', 1, OF_S)

contains

   !> Row of the channel with this owner and name, 0 when there is none
   pure integer function find_channel(owner, name) result(row)
      integer, intent(in) :: owner            !! OF_ constant
      character(len=*), intent(in) :: name

      row = findloc(channels%name, name, 1, channels%owner == owner)
   end function find_channel

   !> Row and component of a T01 variable code, 0 when our layout has none
   pure subroutine find_t01(owner, code, row, comp)
      integer, intent(in) :: owner, code      !! OF_ constant, T01 code
      integer, intent(out) :: row, comp

      do row = 1, size(channels)
         if (channels(row)%owner /= owner .or. channels(row)%t01 == 0) cycle
         comp = code - channels(row)%t01 + 1
         if (comp >= 1 .and. comp <= channels(row)%n_comp) return
      end do
      row = 0
      comp = 0
   end subroutine find_t01

   !> Value of @sampled_at: "t", "t-dt/2" or "t+dt"
   pure function sampled_at(row, legacy) result(text)
      integer, intent(in) :: row
      logical, intent(in) :: legacy
      character(len=:), allocatable :: text

      text = 't'
      if (.not. legacy) return
      if (channels(row)%at == AT_HALF) text = 't-dt/2'
      if (channels(row)%at == AT_NEXT) text = 't+dt'
   end function sampled_at

end module kj_channels
