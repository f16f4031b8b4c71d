!> Fields of the cards of loads, conditions, sensors and histories.
module kj_card_fields_load
   use kj_units, only: D_ACCELERATION, D_ANGULAR_VELOCITY, D_LENGTH, D_MASS, D_NUMBER, D_TIME, &
      D_VELOCITY
   use kj_card_field, only: field_t, EACH, ONCE, ROWS, IDS, NAMES
   use kj_keywords, only: KW_BCS, KW_GRAV, KW_CLOAD, KW_IMPVEL, KW_IMPDISP, KW_IMPACC, &
      KW_INIVEL_TRA, KW_INIVEL_ROT, KW_INIVEL_TG, KW_INIVEL_AXIS, KW_ADMAS, KW_SENSOR_TIME, &
      KW_TH_NODE, KW_TH_SPRING, KW_TH_RBODY, KW_TH_PART, KW_ANALY, KW_RANDOM
   implicit none
   private

   !> Conditions, loads, initial velocities, masses, sensors, histories, the rest
   type(field_t), parameter, public :: load_fields(*) = [ &
   !       keyword, variant, card, times, columns, name, kind, dimension, since, meaning
   field_t(KW_BCS,         EACH, 1, ONCE,   4,   4, 'Tx',       'i', D_NUMBER,           0, '1: translation along x blocked'), &
   field_t(KW_BCS,         EACH, 1, ONCE,   5,   5, 'Ty',       'i', D_NUMBER,           0, '1: translation along y blocked'), &
   field_t(KW_BCS,         EACH, 1, ONCE,   6,   6, 'Tz',       'i', D_NUMBER,           0, '1: translation along z blocked'), &
   field_t(KW_BCS,         EACH, 1, ONCE,   8,   8, 'Rx',       'i', D_NUMBER,           0, '1: rotation about x blocked'), &
   field_t(KW_BCS,         EACH, 1, ONCE,   9,   9, 'Ry',       'i', D_NUMBER,           0, '1: rotation about y blocked'), &
   field_t(KW_BCS,         EACH, 1, ONCE,  10,  10, 'Rz',       'i', D_NUMBER,           0, '1: rotation about z blocked'), &
   field_t(KW_BCS,         EACH, 1, ONCE,  11,  20, 'skew_id',  'i', D_NUMBER,           0, 'axes of the directions'), &
   field_t(KW_BCS,         EACH, 1, ONCE,  21,  30, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_GRAV,        EACH, 1, ONCE,   1,  10, 'fct_id',   'i', D_NUMBER,           0, 'function of time, 0 = constant'), &
   field_t(KW_GRAV,        EACH, 1, ONCE,  11,  20, 'dir',      'a', D_NUMBER,           0, 'direction: X, Y, Z'), &
   field_t(KW_GRAV,        EACH, 1, ONCE,  21,  30, 'skew_id',  'i', D_NUMBER,           0, 'axes of the direction'), &
   field_t(KW_GRAV,        EACH, 1, ONCE,  31,  40, 'sens_id',  'i', D_NUMBER,           0, 'switching sensor'), &
   field_t(KW_GRAV,        EACH, 1, ONCE,  41,  50, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes, 0 = all'), &
   field_t(KW_GRAV,        EACH, 1, ONCE,  61,  80, 'Ascale',   'r', D_TIME,             0, 'scale of the abscissa, 0 = 1'), &
   field_t(KW_GRAV,        EACH, 1, ONCE,  81, 100, 'Fscale',   'r', D_ACCELERATION,     0, 'scale of the function, 0 = 1'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,   1,  10, 'fct_id',   'i', D_NUMBER,           0, 'function of time'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  11,  20, 'dir',      'a', D_NUMBER,           0, 'X, Y, Z, XX, YY or ZZ'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  21,  30, 'skew_id',  'i', D_NUMBER,           0, 'axes of the direction'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  31,  40, 'sens_id',  'i', D_NUMBER,           0, 'switching sensor'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  41,  50, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  51,  60, 'Itypfun',  'i', D_NUMBER,           2023, 'abscissa: 0, 1 t; 2 u; 3 v'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  61,  80, 'Ascale',   'r', D_TIME,             0, 'scale of the abscissa, 0 = 1'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  81, 100, 'Fscale',   'r', D_NUMBER,           0, 'scale of the function, 0 = 1'), &
   field_t(KW_IMPVEL,      EACH, 1, ONCE,   1,  10, 'fct_id',   'i', D_NUMBER,           0, 'function of time'), &
   field_t(KW_IMPVEL,      EACH, 1, ONCE,  11,  20, 'dir',      'a', D_NUMBER,           0, 'X, Y, Z, XX, YY or ZZ'), &
   field_t(KW_IMPVEL,      EACH, 1, ONCE,  21,  30, 'skew_id',  'i', D_NUMBER,           0, 'axes of the direction'), &
   field_t(KW_IMPVEL,      EACH, 1, ONCE,  31,  40, 'sens_id',  'i', D_NUMBER,           0, 'switching sensor'), &
   field_t(KW_IMPVEL,      EACH, 1, ONCE,  41,  50, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_IMPVEL,      EACH, 1, ONCE,  51,  60, 'frame_id', 'i', D_NUMBER,           0, 'frame of the motion'), &
   field_t(KW_IMPVEL,      EACH, 1, ONCE,  61,  70, 'Icoor',    'i', D_NUMBER,           0, '1: cylindrical coordinates'), &
   field_t(KW_IMPVEL,      EACH, 2, ONCE,   1,  20, 'Ascale',   'r', D_TIME,             0, 'scale of the abscissa, 0 = 1'), &
   field_t(KW_IMPVEL,      EACH, 2, ONCE,  21,  40, 'Fscale',   'r', D_NUMBER,           0, 'scale of the function, 0 = 1'), &
   field_t(KW_IMPVEL,      EACH, 2, ONCE,  41,  60, 'Tstart',   'r', D_TIME,             0, 'start'), &
   field_t(KW_IMPVEL,      EACH, 2, ONCE,  61,  80, 'Tstop',    'r', D_TIME,             0, 'end, 0 = never'), &
   field_t(KW_IMPDISP,     EACH, 1, ONCE,   1,  10, 'fct_id',   'i', D_NUMBER,           0, 'function of time'), &
   field_t(KW_IMPDISP,     EACH, 1, ONCE,  11,  20, 'dir',      'a', D_NUMBER,           0, 'X, Y, Z, XX, YY or ZZ'), &
   field_t(KW_IMPDISP,     EACH, 1, ONCE,  21,  30, 'skew_id',  'i', D_NUMBER,           0, 'axes of the direction'), &
   field_t(KW_IMPDISP,     EACH, 1, ONCE,  31,  40, 'sens_id',  'i', D_NUMBER,           0, 'switching sensor'), &
   field_t(KW_IMPDISP,     EACH, 1, ONCE,  41,  50, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_IMPDISP,     EACH, 1, ONCE,  51,  60, 'frame_id', 'i', D_NUMBER,           0, 'frame of the motion'), &
   field_t(KW_IMPDISP,     EACH, 1, ONCE,  61,  70, 'Icoor',    'i', D_NUMBER,           0, '1: cylindrical coordinates'), &
   field_t(KW_IMPDISP,     EACH, 2, ONCE,   1,  20, 'Ascale',   'r', D_TIME,             0, 'scale of the abscissa, 0 = 1'), &
   field_t(KW_IMPDISP,     EACH, 2, ONCE,  21,  40, 'Fscale',   'r', D_NUMBER,           0, 'scale of the function, 0 = 1'), &
   field_t(KW_IMPDISP,     EACH, 2, ONCE,  41,  60, 'Tstart',   'r', D_TIME,             0, 'start'), &
   field_t(KW_IMPDISP,     EACH, 2, ONCE,  61,  80, 'Tstop',    'r', D_TIME,             0, 'end, 0 = never'), &
   field_t(KW_IMPACC,      EACH, 1, ONCE,   1,  10, 'fct_id',   'i', D_NUMBER,           0, 'function of time'), &
   field_t(KW_IMPACC,      EACH, 1, ONCE,  11,  20, 'dir',      'a', D_NUMBER,           0, 'X, Y, Z, XX, YY or ZZ'), &
   field_t(KW_IMPACC,      EACH, 1, ONCE,  21,  30, 'skew_id',  'i', D_NUMBER,           0, 'axes of the direction'), &
   field_t(KW_IMPACC,      EACH, 1, ONCE,  31,  40, 'sens_id',  'i', D_NUMBER,           0, 'switching sensor'), &
   field_t(KW_IMPACC,      EACH, 1, ONCE,  41,  50, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_IMPACC,      EACH, 2, ONCE,   1,  20, 'Ascale',   'r', D_TIME,             0, 'scale of the abscissa, 0 = 1'), &
   field_t(KW_IMPACC,      EACH, 2, ONCE,  21,  40, 'Fscale',   'r', D_NUMBER,           0, 'scale of the function, 0 = 1'), &
   field_t(KW_IMPACC,      EACH, 2, ONCE,  41,  60, 'Tstart',   'r', D_TIME,             0, 'start'), &
   field_t(KW_IMPACC,      EACH, 2, ONCE,  61,  80, 'Tstop',    'r', D_TIME,             0, 'end, 0 = never'), &
   field_t(KW_INIVEL_TRA,  EACH, 1, ONCE,   1,  20, 'Vx',       'r', D_VELOCITY,         0, 'velocity, x'), &
   field_t(KW_INIVEL_TRA,  EACH, 1, ONCE,  21,  40, 'Vy',       'r', D_VELOCITY,         0, 'velocity, y'), &
   field_t(KW_INIVEL_TRA,  EACH, 1, ONCE,  41,  60, 'Vz',       'r', D_VELOCITY,         0, 'velocity, z'), &
   field_t(KW_INIVEL_TRA,  EACH, 1, ONCE,  61,  70, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_INIVEL_TRA,  EACH, 1, ONCE,  71,  80, 'skew_id',  'i', D_NUMBER,           0, 'axes of the velocity'), &
   field_t(KW_INIVEL_TRA,  EACH, 2, ONCE,   1,  20, 'Tstart',   'r', D_TIME,             2025, 'start'), &
   field_t(KW_INIVEL_TRA,  EACH, 2, ONCE,  21,  30, 'sens_id',  'i', D_NUMBER,           2025, 'starting sensor'), &
   field_t(KW_INIVEL_ROT,  EACH, 1, ONCE,   1,  20, 'Vx',       'r', D_ANGULAR_VELOCITY, 0, 'angular velocity, x'), &
   field_t(KW_INIVEL_ROT,  EACH, 1, ONCE,  21,  40, 'Vy',       'r', D_ANGULAR_VELOCITY, 0, 'angular velocity, y'), &
   field_t(KW_INIVEL_ROT,  EACH, 1, ONCE,  41,  60, 'Vz',       'r', D_ANGULAR_VELOCITY, 0, 'angular velocity, z'), &
   field_t(KW_INIVEL_ROT,  EACH, 1, ONCE,  61,  70, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_INIVEL_ROT,  EACH, 1, ONCE,  71,  80, 'skew_id',  'i', D_NUMBER,           0, 'axes of the velocity'), &
   field_t(KW_INIVEL_ROT,  EACH, 2, ONCE,   1,  20, 'Tstart',   'r', D_TIME,             2025, 'start'), &
   field_t(KW_INIVEL_ROT,  EACH, 2, ONCE,  21,  30, 'sens_id',  'i', D_NUMBER,           2025, 'starting sensor'), &
   field_t(KW_INIVEL_TG,   EACH, 1, ONCE,   1,  20, 'Vx',       'r', D_VELOCITY,         0, 'velocity, x'), &
   field_t(KW_INIVEL_TG,   EACH, 1, ONCE,  21,  40, 'Vy',       'r', D_VELOCITY,         0, 'velocity, y'), &
   field_t(KW_INIVEL_TG,   EACH, 1, ONCE,  41,  60, 'Vz',       'r', D_VELOCITY,         0, 'velocity, z'), &
   field_t(KW_INIVEL_TG,   EACH, 1, ONCE,  61,  70, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_INIVEL_TG,   EACH, 1, ONCE,  71,  80, 'skew_id',  'i', D_NUMBER,           0, 'axes of the velocity'), &
   field_t(KW_INIVEL_TG,   EACH, 2, ONCE,   1,  20, 'Tstart',   'r', D_TIME,             2025, 'start'), &
   field_t(KW_INIVEL_TG,   EACH, 2, ONCE,  21,  30, 'sens_id',  'i', D_NUMBER,           2025, 'starting sensor'), &
   field_t(KW_INIVEL_AXIS, EACH, 1, ONCE,   1,  10, 'dir',      'a', D_NUMBER,           0, 'axis: X, Y or Z'), &
   field_t(KW_INIVEL_AXIS, EACH, 1, ONCE,  11,  20, 'frame_id', 'i', D_NUMBER,           0, 'frame of the axis, 0 = global'), &
   field_t(KW_INIVEL_AXIS, EACH, 1, ONCE,  21,  30, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_INIVEL_AXIS, EACH, 2, ONCE,   1,  20, 'Vxt',      'r', D_VELOCITY,         0, 'velocity, x'), &
   field_t(KW_INIVEL_AXIS, EACH, 2, ONCE,  21,  40, 'Vyt',      'r', D_VELOCITY,         0, 'velocity, y'), &
   field_t(KW_INIVEL_AXIS, EACH, 2, ONCE,  41,  60, 'Vzt',      'r', D_VELOCITY,         0, 'velocity, z'), &
   field_t(KW_INIVEL_AXIS, EACH, 2, ONCE,  61,  80, 'Vr',       'r', D_ANGULAR_VELOCITY, 0, 'angular velocity'), &
   field_t(KW_INIVEL_AXIS, EACH, 3, ONCE,   1,  20, 'Tstart',   'r', D_TIME,             2025, 'start'), &
   field_t(KW_INIVEL_AXIS, EACH, 3, ONCE,  21,  30, 'sens_id',  'i', D_NUMBER,           2025, 'starting sensor'), &
   field_t(KW_ADMAS,       0, 1, ONCE,   1,  20, 'mass',     'r', D_MASS,             0, 'mass on each node'), &
   field_t(KW_ADMAS,       0, 1, ONCE,  21,  30, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_ADMAS,       1, 1, ONCE,   1,  20, 'mass',     'r', D_MASS,             0, 'mass shared by the nodes'), &
   field_t(KW_ADMAS,       1, 1, ONCE,  21,  30, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_ADMAS,       5, 1, ROWS,   1,  20, 'mass',     'r', D_MASS,             0, 'mass'), &
   field_t(KW_ADMAS,       5, 1, ROWS,  21,  30, 'node_id',  'i', D_NUMBER,           0, 'node'), &
   field_t(KW_SENSOR_TIME, EACH, 1, ONCE,   1,  20, 'Tdelay',   'r', D_TIME,             0, 'start'), &
   field_t(KW_SENSOR_TIME, EACH, 2, ONCE,   1,  20, 'Tstop',    'r', D_TIME,             2023, 'end, 0 = never'), &
   field_t(KW_TH_NODE,     EACH, 1, NAMES,  1, 100, 'variable', 'a', D_NUMBER,           0, 'names, as DEF'), &
   field_t(KW_TH_NODE,     EACH, 2, ROWS,   1,  10, 'id',       'i', D_NUMBER,           0, 'node id'), &
   field_t(KW_TH_NODE,     EACH, 2, ROWS,  11,  20, 'skew_id',  'i', D_NUMBER,           0, 'axes of the components'), &
   field_t(KW_TH_NODE,     EACH, 2, ROWS,  21, 100, 'name',     'a', D_NUMBER,           0, 'name'), &
   field_t(KW_TH_SPRING,   EACH, 1, NAMES,  1, 100, 'variable', 'a', D_NUMBER,           0, 'names, as DEF'), &
   field_t(KW_TH_SPRING,   EACH, 2, ROWS,   1,  10, 'id',       'i', D_NUMBER,           0, 'spring id'), &
   field_t(KW_TH_SPRING,   EACH, 2, ROWS,  21, 100, 'name',     'a', D_NUMBER,           0, 'name'), &
   field_t(KW_TH_RBODY,    EACH, 1, NAMES,  1, 100, 'variable', 'a', D_NUMBER,           0, 'names, as DEF'), &
   field_t(KW_TH_RBODY,    EACH, 2, IDS,    1, 100, 'id',       'i', D_NUMBER,           0, 'body ids; a first 0 = all'), &
   field_t(KW_TH_PART,     EACH, 1, NAMES,  1, 100, 'variable', 'a', D_NUMBER,           0, 'names, as DEF'), &
   field_t(KW_TH_PART,     EACH, 2, IDS,    1, 100, 'id',       'i', D_NUMBER,           0, 'part ids; a first 0 = all'), &
   field_t(KW_ANALY,       EACH, 1, ONCE,   1,  10, 'N2D3D',    'i', D_NUMBER,           0, '0: 3D'), &
   field_t(KW_ANALY,       EACH, 1, ONCE,  11,  20, 'Itemp',    'i', D_NUMBER,           0, 'not used'), &
   field_t(KW_ANALY,       EACH, 1, ONCE,  21,  30, 'Iparith',  'i', D_NUMBER,           0, 'sums of other solvers'), &
   field_t(KW_RANDOM,      EACH, 1, ONCE,   1,  20, 'Xalea',    'r', D_LENGTH,           0, 'largest disturbance'), &
   field_t(KW_RANDOM,      EACH, 1, ONCE,  21,  40, 'Seed',     'r', D_NUMBER,           0, 'seed of the disturbance')]

end module kj_card_fields_load
