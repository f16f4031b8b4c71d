!> THE table of fields of all cards: where each stands, what it is called and what it means. The
!> reader, `kjoint list keywords` and the manual are all driven by it.
!> One file: every card is a row of one table, which tests walk as a whole.
module kj_card_fields
   use kj_units, only: D_DAMPING, D_FORCE, D_INERTIA, D_LENGTH, D_MASS, D_NUMBER, D_ROT_DAMPING, &
      D_ROT_STIFFNESS, D_STIFFNESS, D_VELOCITY, D_ACCELERATION, D_ANGULAR_VELOCITY, D_TIME, D_MOMENT
   use kj_keywords, only: KW_ANALY, KW_BCS, KW_BEGIN, KW_BOX_RECTA, KW_CLOAD, KW_FRAME_FIX, &
      KW_FRAME_MOV, KW_FRAME_MOV2, KW_FRAME_NOD, KW_FUNCT, KW_GRAV, KW_GRNOD_BOX, KW_GRNOD_GENE, &
      KW_GRNOD_GEN_INCR, KW_GRNOD_GRNOD, KW_GRNOD_NODE, KW_GRNOD_NODENS, KW_GRNOD_PART, &
      KW_IMPACC, KW_IMPDISP, KW_IMPVEL, KW_INIVEL_AXIS, KW_INIVEL_ROT, KW_INIVEL_TG, &
      KW_INIVEL_TRA, KW_KJOINT, KW_KJOINT2, KW_MAT_VOID, KW_MOVE_FUNCT, KW_NODE, KW_PART, &
      KW_RANDOM, KW_RBODY, KW_SENSOR_TIME, KW_SET_GENERAL, KW_SKEW_FIX, KW_SKEW_MOV, &
      KW_SKEW_MOV2, KW_SPRING, KW_SPRING4, KW_SPRING8, KW_SPRING13, &
      KW_TH_NODE, KW_TH_PART, KW_TH_RBODY, &
      KW_TH_SPRING, KW_UNIT, KW_UNIT_LENGTH, KW_UNIT_MASS, KW_UNIT_TIME, N_KEYWORD
   use kj_field, only: field_t, EACH, ONCE, ROWS, DOFS, IDS, PAIRS, TRIPLES, NAMES, CLAUSES
   use kj_full_fields, only: full_fields
   use kj_joint_types, only: joint_types, find_joint_type, NDOF
   implicit none
   private

   public :: field_t, field_range, list_free_dofs, rotational, has_variant, EACH, ONCE, ROWS, &
      DOFS, IDS, PAIRS, TRIPLES, NAMES, CLAUSES

   !> /PROP/TYPE33 = /PROP/KJOINT; the variant is the joint type
   type(field_t), parameter :: joint_fields(*) = [ &
   !       keyword, variant, card, times, columns, name, kind, dimension, since, meaning
   field_t(KW_KJOINT, EACH, 1,  ONCE,  1,  10, 'type',      'i', D_NUMBER,        0, 'number of the joint type'), &
   field_t(KW_KJOINT, EACH, 1,  ONCE, 11,  20, 'skew_flag', 'i', D_NUMBER,        0, '0 mean frame, 1 frame of skew_1'), &
   field_t(KW_KJOINT, EACH, 2,  ONCE,  1,  10, 'skew_1',    'i', D_NUMBER,        0, 'moving skew on body 1'), &
   field_t(KW_KJOINT, EACH, 2,  ONCE, 11,  20, 'skew_2',    'i', D_NUMBER,        0, 'moving skew on body 2, 0 = none'), &
   field_t(KW_KJOINT, EACH, 2,  ONCE, 21,  40, 'Xk',        'r', D_STIFFNESS,     0, 'stiffness for contacts'), &
   field_t(KW_KJOINT, EACH, 2,  ONCE, 41,  60, 'Cr',        'r', D_NUMBER,        0, 'twice the damping ratio'), &
   field_t(KW_KJOINT, 1, 3,  ONCE,  1,  20, 'Kn',        'r', D_STIFFNESS,     0, 'stiffness of the blocked directions'), &
   field_t(KW_KJOINT, 1, 3,  ONCE, 21,  40, 'Krx',       'r', D_ROT_STIFFNESS, 0, 'stiffness about x, or scale of f_Krx'), &
   field_t(KW_KJOINT, 1, 3,  ONCE, 41,  60, 'Kry',       'r', D_ROT_STIFFNESS, 0, 'stiffness about y, or scale of f_Kry'), &
   field_t(KW_KJOINT, 1, 3,  ONCE, 61,  80, 'Krz',       'r', D_ROT_STIFFNESS, 0, 'stiffness about z, or scale of f_Krz'), &
   field_t(KW_KJOINT, 1, 4,  ONCE,  1,  10, 'f_Krx',     'i', D_NUMBER,        0, 'function of moment about x'), &
   field_t(KW_KJOINT, 1, 4,  ONCE, 11,  20, 'f_Kry',     'i', D_NUMBER,        0, 'function of moment about y'), &
   field_t(KW_KJOINT, 1, 4,  ONCE, 21,  30, 'f_Krz',     'i', D_NUMBER,        0, 'function of moment about z'), &
   field_t(KW_KJOINT, 1, 5,  ONCE,  1,  20, 'Crx',       'r', D_ROT_DAMPING,   0, 'damping about x, or scale of f_Crx'), &
   field_t(KW_KJOINT, 1, 5,  ONCE, 21,  40, 'Cry',       'r', D_ROT_DAMPING,   0, 'damping about y, or scale of f_Cry'), &
   field_t(KW_KJOINT, 1, 5,  ONCE, 41,  60, 'Crz',       'r', D_ROT_DAMPING,   0, 'damping about z, or scale of f_Crz'), &
   field_t(KW_KJOINT, 1, 6,  ONCE,  1,  10, 'f_Crx',     'i', D_NUMBER,        0, 'function of damping about x'), &
   field_t(KW_KJOINT, 1, 6,  ONCE, 11,  20, 'f_Cry',     'i', D_NUMBER,        0, 'function of damping about y'), &
   field_t(KW_KJOINT, 1, 6,  ONCE, 21,  30, 'f_Crz',     'i', D_NUMBER,        0, 'function of damping about z'), &
   field_t(KW_KJOINT, 2, 3,  ONCE,  1,  20, 'Kn',        'r', D_STIFFNESS,     0, 'stiffness of the blocked directions'), &
   field_t(KW_KJOINT, 2, 3,  ONCE, 21,  40, 'Krx',       'r', D_ROT_STIFFNESS, 0, 'stiffness about x, or scale of f_Krx'), &
   field_t(KW_KJOINT, 2, 3,  ONCE, 41,  50, 'f_Krx',     'i', D_NUMBER,        0, 'function of moment about x'), &
   field_t(KW_KJOINT, 2, 4,  ONCE,  1,  20, 'Crx',       'r', D_ROT_DAMPING,   0, 'damping about x, or scale of f_Crx'), &
   field_t(KW_KJOINT, 2, 4,  ONCE, 21,  30, 'f_Crx',     'i', D_NUMBER,        0, 'function of damping about x'), &
   field_t(KW_KJOINT, 3, 3,  ONCE,  1,  20, 'Kn',        'r', D_STIFFNESS,     0, 'stiffness of the blocked directions'), &
   field_t(KW_KJOINT, 3, 3,  ONCE, 21,  40, 'Ktx',       'r', D_STIFFNESS,     0, 'stiffness along x, or scale of f_Ktx'), &
   field_t(KW_KJOINT, 3, 3,  ONCE, 41,  60, 'Krx',       'r', D_ROT_STIFFNESS, 0, 'stiffness about x, or scale of f_Krx'), &
   field_t(KW_KJOINT, 3, 3,  ONCE, 61,  70, 'f_Ktx',     'i', D_NUMBER,        0, 'function of force along x'), &
   field_t(KW_KJOINT, 3, 3,  ONCE, 71,  80, 'f_Krx',     'i', D_NUMBER,        0, 'function of moment about x'), &
   field_t(KW_KJOINT, 3, 4,  ONCE,  1,  20, 'Ctx',       'r', D_DAMPING,       0, 'damping along x, or scale of f_Ctx'), &
   field_t(KW_KJOINT, 3, 4,  ONCE, 21,  40, 'Crx',       'r', D_ROT_DAMPING,   0, 'damping about x, or scale of f_Crx'), &
   field_t(KW_KJOINT, 3, 4,  ONCE, 41,  50, 'f_Ctx',     'i', D_NUMBER,        0, 'function of damping along x'), &
   field_t(KW_KJOINT, 3, 4,  ONCE, 51,  60, 'f_Crx',     'i', D_NUMBER,        0, 'function of damping about x'), &
   field_t(KW_KJOINT, 4, 3,  ONCE,  1,  20, 'Kn',        'r', D_STIFFNESS,     0, 'stiffness of the blocked directions'), &
   field_t(KW_KJOINT, 4, 3,  ONCE, 21,  40, 'Kty',       'r', D_STIFFNESS,     0, 'stiffness along y, or scale of f_Kty'), &
   field_t(KW_KJOINT, 4, 3,  ONCE, 41,  60, 'Ktz',       'r', D_STIFFNESS,     0, 'stiffness along z, or scale of f_Ktz'), &
   field_t(KW_KJOINT, 4, 3,  ONCE, 61,  70, 'f_Kty',     'i', D_NUMBER,        0, 'function of force along y'), &
   field_t(KW_KJOINT, 4, 3,  ONCE, 71,  80, 'f_Ktz',     'i', D_NUMBER,        0, 'function of force along z'), &
   field_t(KW_KJOINT, 4, 4,  ONCE,  1,  20, 'Krx',       'r', D_ROT_STIFFNESS, 0, 'stiffness about x, or scale of f_Krx'), &
   field_t(KW_KJOINT, 4, 4,  ONCE, 21,  30, 'f_Krx',     'i', D_NUMBER,        0, 'function of moment about x'), &
   field_t(KW_KJOINT, 4, 5,  ONCE,  1,  20, 'Cty',       'r', D_DAMPING,       0, 'damping along y, or scale of f_Cty'), &
   field_t(KW_KJOINT, 4, 5,  ONCE, 21,  40, 'Ctz',       'r', D_DAMPING,       0, 'damping along z, or scale of f_Ctz'), &
   field_t(KW_KJOINT, 4, 5,  ONCE, 41,  60, 'Crx',       'r', D_ROT_DAMPING,   0, 'damping about x, or scale of f_Crx'), &
   field_t(KW_KJOINT, 4, 6,  ONCE,  1,  10, 'f_Cty',     'i', D_NUMBER,        0, 'function of damping along y'), &
   field_t(KW_KJOINT, 4, 6,  ONCE, 11,  20, 'f_Ctz',     'i', D_NUMBER,        0, 'function of damping along z'), &
   field_t(KW_KJOINT, 4, 6,  ONCE, 21,  30, 'f_Crx',     'i', D_NUMBER,        0, 'function of damping about x'), &
   field_t(KW_KJOINT, 5, 3,  ONCE,  1,  20, 'Kn',        'r', D_STIFFNESS,     0, 'stiffness of the blocked directions'), &
   field_t(KW_KJOINT, 5, 3,  ONCE, 21,  40, 'Kry',       'r', D_ROT_STIFFNESS, 0, 'stiffness about y, or scale of f_Kry'), &
   field_t(KW_KJOINT, 5, 3,  ONCE, 41,  60, 'Krz',       'r', D_ROT_STIFFNESS, 0, 'stiffness about z, or scale of f_Krz'), &
   field_t(KW_KJOINT, 5, 3,  ONCE, 61,  70, 'f_Kry',     'i', D_NUMBER,        0, 'function of moment about y'), &
   field_t(KW_KJOINT, 5, 3,  ONCE, 71,  80, 'f_Krz',     'i', D_NUMBER,        0, 'function of moment about z'), &
   field_t(KW_KJOINT, 5, 4,  ONCE,  1,  20, 'Cry',       'r', D_ROT_DAMPING,   0, 'damping about y, or scale of f_Cry'), &
   field_t(KW_KJOINT, 5, 4,  ONCE, 21,  40, 'Crz',       'r', D_ROT_DAMPING,   0, 'damping about z, or scale of f_Crz'), &
   field_t(KW_KJOINT, 5, 4,  ONCE, 41,  50, 'f_Cry',     'i', D_NUMBER,        0, 'function of damping about y'), &
   field_t(KW_KJOINT, 5, 4,  ONCE, 51,  60, 'f_Crz',     'i', D_NUMBER,        0, 'function of damping about z'), &
   field_t(KW_KJOINT, 6, 3,  ONCE,  1,  20, 'Kn',        'r', D_STIFFNESS,     0, 'stiffness of the blocked directions'), &
   field_t(KW_KJOINT, 6, 3,  ONCE, 21,  40, 'Ktx',       'r', D_STIFFNESS,     0, 'stiffness along x, or scale of f_Ktx'), &
   field_t(KW_KJOINT, 6, 3,  ONCE, 41,  50, 'f_Ktx',     'i', D_NUMBER,        0, 'function of force along x'), &
   field_t(KW_KJOINT, 6, 4,  ONCE,  1,  20, 'Ctx',       'r', D_DAMPING,       0, 'damping along x, or scale of f_Ctx'), &
   field_t(KW_KJOINT, 6, 4,  ONCE, 21,  30, 'f_Ctx',     'i', D_NUMBER,        0, 'function of damping along x'), &
   field_t(KW_KJOINT, 7, 3,  ONCE,  1,  20, 'Kn',        'r', D_STIFFNESS,     0, 'stiffness of the blocked directions'), &
   field_t(KW_KJOINT, 7, 3,  ONCE, 21,  40, 'Kty',       'r', D_STIFFNESS,     0, 'stiffness along y, or scale of f_Kty'), &
   field_t(KW_KJOINT, 7, 3,  ONCE, 41,  60, 'Ktz',       'r', D_STIFFNESS,     0, 'stiffness along z, or scale of f_Ktz'), &
   field_t(KW_KJOINT, 7, 3,  ONCE, 61,  70, 'f_Kty',     'i', D_NUMBER,        0, 'function of force along y'), &
   field_t(KW_KJOINT, 7, 3,  ONCE, 71,  80, 'f_Ktz',     'i', D_NUMBER,        0, 'function of force along z'), &
   field_t(KW_KJOINT, 7, 4,  ONCE,  1,  20, 'Cty',       'r', D_DAMPING,       0, 'damping along y, or scale of f_Cty'), &
   field_t(KW_KJOINT, 7, 4,  ONCE, 21,  40, 'Ctz',       'r', D_DAMPING,       0, 'damping along z, or scale of f_Ctz'), &
   field_t(KW_KJOINT, 7, 4,  ONCE, 41,  50, 'f_Cty',     'i', D_NUMBER,        0, 'function of damping along y'), &
   field_t(KW_KJOINT, 7, 4,  ONCE, 51,  60, 'f_Ctz',     'i', D_NUMBER,        0, 'function of damping along z'), &
   field_t(KW_KJOINT, 8, 3,  ONCE,  1,  20, 'Kn',        'r', D_STIFFNESS,     0, 'stiffness of the blocked directions'), &
   field_t(KW_KJOINT, 9, 3,  ONCE,  1,  20, 'Ktx',       'r', D_STIFFNESS,     0, 'stiffness along x, or scale of f_Ktx'), &
   field_t(KW_KJOINT, 9, 3,  ONCE, 21,  40, 'Kty',       'r', D_STIFFNESS,     0, 'stiffness along y, or scale of f_Kty'), &
   field_t(KW_KJOINT, 9, 3,  ONCE, 41,  60, 'Ktz',       'r', D_STIFFNESS,     0, 'stiffness along z, or scale of f_Ktz'), &
   field_t(KW_KJOINT, 9, 4,  ONCE,  1,  20, 'Krx',       'r', D_ROT_STIFFNESS, 0, 'stiffness about x, or scale of f_Krx'), &
   field_t(KW_KJOINT, 9, 4,  ONCE, 21,  40, 'Kry',       'r', D_ROT_STIFFNESS, 0, 'stiffness about y, or scale of f_Kry'), &
   field_t(KW_KJOINT, 9, 4,  ONCE, 41,  60, 'Krz',       'r', D_ROT_STIFFNESS, 0, 'stiffness about z, or scale of f_Krz'), &
   field_t(KW_KJOINT, 9, 5,  ONCE,  1,  10, 'f_Ktx',     'i', D_NUMBER,        0, 'function of force along x'), &
   field_t(KW_KJOINT, 9, 5,  ONCE, 11,  20, 'f_Kty',     'i', D_NUMBER,        0, 'function of force along y'), &
   field_t(KW_KJOINT, 9, 5,  ONCE, 21,  30, 'f_Ktz',     'i', D_NUMBER,        0, 'function of force along z'), &
   field_t(KW_KJOINT, 9, 6,  ONCE,  1,  10, 'f_Krx',     'i', D_NUMBER,        0, 'function of moment about x'), &
   field_t(KW_KJOINT, 9, 6,  ONCE, 11,  20, 'f_Kry',     'i', D_NUMBER,        0, 'function of moment about y'), &
   field_t(KW_KJOINT, 9, 6,  ONCE, 21,  30, 'f_Krz',     'i', D_NUMBER,        0, 'function of moment about z'), &
   field_t(KW_KJOINT, 9, 7,  ONCE,  1,  20, 'Ctx',       'r', D_DAMPING,       0, 'damping along x, or scale of f_Ctx'), &
   field_t(KW_KJOINT, 9, 7,  ONCE, 21,  40, 'Cty',       'r', D_DAMPING,       0, 'damping along y, or scale of f_Cty'), &
   field_t(KW_KJOINT, 9, 7,  ONCE, 41,  60, 'Ctz',       'r', D_DAMPING,       0, 'damping along z, or scale of f_Ctz'), &
   field_t(KW_KJOINT, 9, 8,  ONCE,  1,  20, 'Crx',       'r', D_ROT_DAMPING,   0, 'damping about x, or scale of f_Crx'), &
   field_t(KW_KJOINT, 9, 8,  ONCE, 21,  40, 'Cry',       'r', D_ROT_DAMPING,   0, 'damping about y, or scale of f_Cry'), &
   field_t(KW_KJOINT, 9, 8,  ONCE, 41,  60, 'Crz',       'r', D_ROT_DAMPING,   0, 'damping about z, or scale of f_Crz'), &
   field_t(KW_KJOINT, 9, 9,  ONCE,  1,  10, 'f_Ctx',     'i', D_NUMBER,        0, 'function of damping along x'), &
   field_t(KW_KJOINT, 9, 9,  ONCE, 11,  20, 'f_Cty',     'i', D_NUMBER,        0, 'function of damping along y'), &
   field_t(KW_KJOINT, 9, 9,  ONCE, 21,  30, 'f_Ctz',     'i', D_NUMBER,        0, 'function of damping along z'), &
   field_t(KW_KJOINT, 9, 10, ONCE,  1,  10, 'f_Crx',     'i', D_NUMBER,        0, 'function of damping about x'), &
   field_t(KW_KJOINT, 9, 10, ONCE, 11,  20, 'f_Cry',     'i', D_NUMBER,        0, 'function of damping about y'), &
   field_t(KW_KJOINT, 9, 10, ONCE, 21,  30, 'f_Crz',     'i', D_NUMBER,        0, 'function of damping about z')]

   !> /PROP/TYPE45 = /PROP/KJOINT2, springs and rigid bodies
   type(field_t), parameter :: property_fields(*) = [ &
   !       keyword, variant, card, times, columns, name, kind, dimension, since, meaning
   field_t(KW_KJOINT2, EACH, 1,  ONCE,  1,  10, 'type',      'i', D_NUMBER,    0, 'number of the joint type'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 11,  30, 'Kn',        'r', D_STIFFNESS, 0, 'blocking stiffness, 0 = automatic'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 31,  50, 'SCF',       'r', D_NUMBER,    0, 'scale of the blocked rotations, 0 = 10'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 51,  70, 'Cr',        'r', D_NUMBER,    0, 'twice the damping ratio'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 71,  80, 'sens_id',   'i', D_NUMBER,    0, 'sensor that locks the joint'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 81,  90, 'skew_1',    'i', D_NUMBER,    0, 'axes of end 1'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 91, 100, 'skew_2',    'i', D_NUMBER,    0, 'axes of end 2'), &
   field_t(KW_KJOINT2, EACH, 2,  DOFS,  1,  20, 'K',         'r', D_STIFFNESS, 0, 'stiffness, or scale of f_K'), &
   field_t(KW_KJOINT2, EACH, 2,  DOFS, 21,  30, 'f_K',       'i', D_NUMBER,    0, 'function of force'), &
   field_t(KW_KJOINT2, EACH, 2,  DOFS, 31,  50, 'SA-',       'r', D_LENGTH,    0, 'lower stop, 0 = none; rotations in rad'), &
   field_t(KW_KJOINT2, EACH, 2,  DOFS, 51,  70, 'SA+',       'r', D_LENGTH,    0, 'upper stop, 0 = none; rotations in rad'), &
   field_t(KW_KJOINT2, EACH, 2,  DOFS, 71,  80, 'Icomb',     'i', D_NUMBER, 2019, 'combination of stops'), &
   field_t(KW_KJOINT2, EACH, 3,  DOFS,  1,  20, 'C',         'r', D_DAMPING,   0, 'damping, or scale of f_C'), &
   field_t(KW_KJOINT2, EACH, 3,  DOFS, 21,  30, 'f_C',       'i', D_NUMBER,    0, 'function of damping'), &
   field_t(KW_KJOINT2, EACH, 4,  DOFS,  1,  20, 'Kfr',       'r', D_STIFFNESS, 0, 'stiffness of friction, stops; 0 = blocking'), &
   field_t(KW_KJOINT2, EACH, 4,  DOFS, 21,  40, 'FM',        'r', D_FORCE,     0, 'limit of friction, or scale of f_FM'), &
   field_t(KW_KJOINT2, EACH, 4,  DOFS, 41,  50, 'f_FM',      'i', D_NUMBER,    0, 'function of the limit of friction'), &
   field_t(KW_SPRING4, EACH, 1,  ONCE,  1,  20, 'Mass',      'r', D_MASS,      0, 'mass, half to each node'), &
   field_t(KW_SPRING4, EACH, 1,  ONCE, 51,  60, 'sens_id',   'i', D_NUMBER,    0, 'sensor that switches the spring'), &
   field_t(KW_SPRING4, EACH, 1,  ONCE, 61,  70, 'Isflag',    'i', D_NUMBER,    0, 'how the sensor acts'), &
   field_t(KW_SPRING4, EACH, 1,  ONCE, 71,  80, 'Ileng',     'i', D_NUMBER,    0, '1: per unit of length'), &
   field_t(KW_SPRING4, EACH, 2,  ONCE,  1,  20, 'K',         'r', D_STIFFNESS, 0, 'stiffness'), &
   field_t(KW_SPRING4, EACH, 2,  ONCE, 21,  40, 'C',         'r', D_DAMPING,   0, 'damping'), &
   field_t(KW_SPRING4, EACH, 2,  ONCE, 41,  60, 'A',         'r', D_FORCE,     0, 'scale of fct1'), &
   field_t(KW_SPRING4, EACH, 2,  ONCE, 61,  80, 'B',         'r', D_FORCE,     0, 'scale of the logarithm of the rate'), &
   field_t(KW_SPRING4, EACH, 2,  ONCE, 81, 100, 'D',         'r', D_VELOCITY,  0, 'reference rate of the logarithm'), &
   field_t(KW_SPRING4, EACH, 3,  ONCE,  1,  10, 'fct1',      'i', D_NUMBER,    0, 'function of force'), &
   field_t(KW_SPRING4, EACH, 3,  ONCE, 11,  20, 'H',         'i', D_NUMBER,    0, 'hardening rule'), &
   field_t(KW_SPRING4, EACH, 3,  ONCE, 21,  30, 'fct2',      'i', D_NUMBER,    0, 'function of the rate factor'), &
   field_t(KW_SPRING4, EACH, 3,  ONCE, 31,  40, 'fct3',      'i', D_NUMBER,    0, 'function of unloading'), &
   field_t(KW_SPRING4, EACH, 3,  ONCE, 41,  50, 'fct4',      'i', D_NUMBER,    0, 'function of damping'), &
   field_t(KW_SPRING4, EACH, 3,  ONCE, 61,  80, 'delta_min', 'r', D_LENGTH,    0, 'negative failure limit'), &
   field_t(KW_SPRING4, EACH, 3,  ONCE, 81, 100, 'delta_max', 'r', D_LENGTH,    0, 'positive failure limit'), &
   field_t(KW_SPRING4, EACH, 4,  ONCE,  1,  20, 'F',         'r', D_VELOCITY,  0, 'scale of the abscissa of fct2 and fct4'), &
   field_t(KW_SPRING4, EACH, 4,  ONCE, 21,  40, 'E',         'r', D_FORCE,     0, 'scale of fct2'), &
   field_t(KW_SPRING4, EACH, 4,  ONCE, 41,  60, 'Ascale',    'r', D_LENGTH,    0, 'scale of the abscissa of fct1'), &
   field_t(KW_SPRING4, EACH, 4,  ONCE, 61,  80, 'Hscale',    'r', D_FORCE,     0, 'scale of fct4'), &
   field_t(KW_SPRING8, EACH, 1,  ONCE,  1,  20, 'Mass',      'r', D_MASS,      0, 'mass, half to each node'), &
   field_t(KW_SPRING8, EACH, 1,  ONCE, 21,  40, 'Inertia',   'r', D_INERTIA,   0, 'inertia, half to each node'), &
   field_t(KW_SPRING8, EACH, 1,  ONCE, 41,  50, 'skew_id',   'i', D_NUMBER,    0, 'axes of the laws'), &
   field_t(KW_SPRING8, EACH, 1,  ONCE, 51,  60, 'sens_id',   'i', D_NUMBER,    0, 'sensor that switches the spring'), &
   field_t(KW_SPRING8, EACH, 1,  ONCE, 61,  70, 'Isflag',    'i', D_NUMBER,    0, 'how the sensor acts'), &
   field_t(KW_SPRING8, EACH, 1,  ONCE, 71,  80, 'Ifail',     'i', D_NUMBER,    0, 'failure rule'), &
   field_t(KW_SPRING8, EACH, 1,  ONCE, 81,  90, 'Ifail2',    'i', D_NUMBER,    0, 'failure criterion'), &
   field_t(KW_SPRING8, EACH, 1,  ONCE, 91, 100, 'Iequil',    'i', D_NUMBER,    0, '1: forces in equilibrium'), &
   field_t(KW_SPRING8, EACH, 2,  DOFS,  1,  20, 'K',         'r', D_STIFFNESS, 0, 'stiffness'), &
   field_t(KW_SPRING8, EACH, 2,  DOFS, 21,  40, 'C',         'r', D_DAMPING,   0, 'damping'), &
   field_t(KW_SPRING8, EACH, 2,  DOFS, 41,  60, 'A',         'r', D_FORCE,     0, 'scale of fct1'), &
   field_t(KW_SPRING8, EACH, 2,  DOFS, 61,  80, 'B',         'r', D_FORCE,     0, 'scale of the logarithm of the rate'), &
   field_t(KW_SPRING8, EACH, 2,  DOFS, 81, 100, 'D',         'r', D_VELOCITY,  0, 'reference rate of the logarithm'), &
   field_t(KW_SPRING8, EACH, 3,  DOFS,  1,  10, 'fct1',      'i', D_NUMBER,    0, 'function of force'), &
   field_t(KW_SPRING8, EACH, 3,  DOFS, 11,  20, 'H',         'i', D_NUMBER,    0, 'hardening rule'), &
   field_t(KW_SPRING8, EACH, 3,  DOFS, 21,  30, 'fct2',      'i', D_NUMBER,    0, 'function of the rate factor'), &
   field_t(KW_SPRING8, EACH, 3,  DOFS, 31,  40, 'fct3',      'i', D_NUMBER,    0, 'function of unloading'), &
   field_t(KW_SPRING8, EACH, 3,  DOFS, 41,  50, 'fct4',      'i', D_NUMBER,    0, 'function of damping'), &
   field_t(KW_SPRING8, EACH, 3,  DOFS, 61,  80, 'delta_min', 'r', D_LENGTH,    0, 'negative failure limit'), &
   field_t(KW_SPRING8, EACH, 3,  DOFS, 81, 100, 'delta_max', 'r', D_LENGTH,    0, 'positive failure limit'), &
   field_t(KW_SPRING8, EACH, 4,  DOFS,  1,  20, 'F',         'r', D_VELOCITY,  0, 'scale of the abscissa of fct2 and fct4'), &
   field_t(KW_SPRING8, EACH, 4,  DOFS, 21,  40, 'E',         'r', D_FORCE,     0, 'scale of fct2'), &
   field_t(KW_SPRING8, EACH, 4,  DOFS, 41,  60, 'Ascale',    'r', D_LENGTH,    0, 'scale of the abscissa of fct1'), &
   field_t(KW_SPRING8, EACH, 4,  DOFS, 61,  80, 'Hscale',    'r', D_FORCE,     0, 'scale of fct4'), &
   field_t(KW_SPRING8, EACH, 20, ONCE,  1,  10, 'Fsmooth',   'i', D_NUMBER,    0, '1: failure is smoothed'), &
   field_t(KW_SPRING8, EACH, 20, ONCE, 11,  30, 'Fcut',      'r', D_NUMBER,    0, 'cutting frequency of that'), &
   field_t(KW_SPRING13, EACH, 1, ONCE,   1,  20, 'Mass', 'r', D_MASS, 0, 'mass, half to each node'), &
   field_t(KW_SPRING13, EACH, 1, ONCE,  21,  40, 'Inertia', 'r', D_INERTIA, 0, 'inertia, half to each node'), &
   field_t(KW_SPRING13, EACH, 1, ONCE,  41,  50, 'skew_id', 'i', D_NUMBER, 0, 'its y axis, without a third node'), &
   field_t(KW_SPRING13, EACH, 1, ONCE,  51,  60, 'sens_id', 'i', D_NUMBER, 0, 'sensor that switches the spring'), &
   field_t(KW_SPRING13, EACH, 1, ONCE,  61,  70, 'Isflag', 'i', D_NUMBER, 0, 'how the sensor acts'), &
   field_t(KW_SPRING13, EACH, 1, ONCE,  71,  80, 'Ifail', 'i', D_NUMBER, 0, 'failure rule'), &
   field_t(KW_SPRING13, EACH, 1, ONCE,  81,  90, 'Ileng', 'i', D_NUMBER, 0, '1: per unit of length'), &
   field_t(KW_SPRING13, EACH, 1, ONCE,  91, 100, 'Ifail2', 'i', D_NUMBER, 0, 'failure criterion'), &
   field_t(KW_SPRING13,EACH, 2,  DOFS,  1,  20, 'K',         'r', D_STIFFNESS, 0, 'stiffness'), &
   field_t(KW_SPRING13,EACH, 2,  DOFS, 21,  40, 'C',         'r', D_DAMPING,   0, 'damping'), &
   field_t(KW_SPRING13,EACH, 2,  DOFS, 41,  60, 'A',         'r', D_FORCE,     0, 'scale of fct1'), &
   field_t(KW_SPRING13,EACH, 2,  DOFS, 61,  80, 'B',         'r', D_FORCE,     0, 'scale of the logarithm of the rate'), &
   field_t(KW_SPRING13,EACH, 2,  DOFS, 81, 100, 'D',         'r', D_VELOCITY,  0, 'reference rate of the logarithm'), &
   field_t(KW_SPRING13,EACH, 3,  DOFS,  1,  10, 'fct1',      'i', D_NUMBER,    0, 'function of force'), &
   field_t(KW_SPRING13,EACH, 3,  DOFS, 11,  20, 'H',         'i', D_NUMBER,    0, 'hardening rule'), &
   field_t(KW_SPRING13,EACH, 3,  DOFS, 21,  30, 'fct2',      'i', D_NUMBER,    0, 'function of the rate factor'), &
   field_t(KW_SPRING13,EACH, 3,  DOFS, 31,  40, 'fct3',      'i', D_NUMBER,    0, 'function of unloading'), &
   field_t(KW_SPRING13,EACH, 3,  DOFS, 41,  50, 'fct4',      'i', D_NUMBER,    0, 'function of damping'), &
   field_t(KW_SPRING13,EACH, 3,  DOFS, 61,  80, 'delta_min', 'r', D_LENGTH,    0, 'negative failure limit'), &
   field_t(KW_SPRING13,EACH, 3,  DOFS, 81, 100, 'delta_max', 'r', D_LENGTH,    0, 'positive failure limit'), &
   field_t(KW_SPRING13,EACH, 4,  DOFS,  1,  20, 'F',         'r', D_VELOCITY,  0, 'scale of the abscissa of fct2 and fct4'), &
   field_t(KW_SPRING13,EACH, 4,  DOFS, 21,  40, 'E',         'r', D_FORCE,     0, 'scale of fct2'), &
   field_t(KW_SPRING13,EACH, 4,  DOFS, 41,  60, 'Ascale',    'r', D_LENGTH,    0, 'scale of the abscissa of fct1'), &
   field_t(KW_SPRING13,EACH, 4,  DOFS, 61,  80, 'Hscale',    'r', D_FORCE,     0, 'scale of fct4'), &
   field_t(KW_SPRING13, EACH, 20, ONCE,   1,  20, 'V0', 'r', D_VELOCITY, 0, 'reference rate of failure'), &
   field_t(KW_SPRING13, EACH, 20, ONCE,  21,  40, 'W0', 'r', D_ANGULAR_VELOCITY, 0, 'the same of rotations'), &
   field_t(KW_SPRING13, EACH, 20, ONCE,  41,  60, 'Fcut', 'r', D_NUMBER, 0, 'cutting frequency of the criterion of failure'), &
   field_t(KW_SPRING13, EACH, 20, ONCE,  61,  70, 'Fsmooth', 'i', D_NUMBER, 0, '1: failure is smoothed'), &
   field_t(KW_SPRING13, EACH, 21, ONCE,   1,  20, 'c_tx', 'r', D_LENGTH, 0, 'limit of failure, for the rate'), &
   field_t(KW_SPRING13, EACH, 21, ONCE,  21,  40, 'n_tx', 'r', D_NUMBER, 0, 'power of the rate'), &
   field_t(KW_SPRING13, EACH, 21, ONCE,  41,  60, 'alpha_tx', 'r', D_NUMBER, 0, 'weight in the sum'), &
   field_t(KW_SPRING13, EACH, 21, ONCE,  61,  80, 'beta_tx', 'r', D_NUMBER, 0, 'power in the sum'), &
   field_t(KW_SPRING13, EACH, 22, ONCE,   1,  20, 'c_ty', 'r', D_LENGTH, 0, 'limit of failure, for the rate'), &
   field_t(KW_SPRING13, EACH, 22, ONCE,  21,  40, 'n_ty', 'r', D_NUMBER, 0, 'power of the rate'), &
   field_t(KW_SPRING13, EACH, 22, ONCE,  41,  60, 'alpha_ty', 'r', D_NUMBER, 0, 'weight in the sum'), &
   field_t(KW_SPRING13, EACH, 22, ONCE,  61,  80, 'beta_ty', 'r', D_NUMBER, 0, 'power in the sum'), &
   field_t(KW_SPRING13, EACH, 23, ONCE,   1,  20, 'c_tz', 'r', D_LENGTH, 0, 'limit of failure, for the rate'), &
   field_t(KW_SPRING13, EACH, 23, ONCE,  21,  40, 'n_tz', 'r', D_NUMBER, 0, 'power of the rate'), &
   field_t(KW_SPRING13, EACH, 23, ONCE,  41,  60, 'alpha_tz', 'r', D_NUMBER, 0, 'weight in the sum'), &
   field_t(KW_SPRING13, EACH, 23, ONCE,  61,  80, 'beta_tz', 'r', D_NUMBER, 0, 'power in the sum'), &
   field_t(KW_SPRING13, EACH, 24, ONCE,   1,  20, 'c_rx', 'r', D_NUMBER, 0, 'limit of failure, for the rate'), &
   field_t(KW_SPRING13, EACH, 24, ONCE,  21,  40, 'n_rx', 'r', D_NUMBER, 0, 'power of the rate'), &
   field_t(KW_SPRING13, EACH, 24, ONCE,  41,  60, 'alpha_rx', 'r', D_NUMBER, 0, 'weight in the sum'), &
   field_t(KW_SPRING13, EACH, 24, ONCE,  61,  80, 'beta_rx', 'r', D_NUMBER, 0, 'power in the sum'), &
   field_t(KW_SPRING13, EACH, 25, ONCE,   1,  20, 'c_ry', 'r', D_NUMBER, 0, 'limit of failure, for the rate'), &
   field_t(KW_SPRING13, EACH, 25, ONCE,  21,  40, 'n_ry', 'r', D_NUMBER, 0, 'power of the rate'), &
   field_t(KW_SPRING13, EACH, 25, ONCE,  41,  60, 'alpha_ry', 'r', D_NUMBER, 0, 'weight in the sum'), &
   field_t(KW_SPRING13, EACH, 25, ONCE,  61,  80, 'beta_ry', 'r', D_NUMBER, 0, 'power in the sum'), &
   field_t(KW_SPRING13, EACH, 26, ONCE,   1,  20, 'c_rz', 'r', D_NUMBER, 0, 'limit of failure, for the rate'), &
   field_t(KW_SPRING13, EACH, 26, ONCE,  21,  40, 'n_rz', 'r', D_NUMBER, 0, 'power of the rate'), &
   field_t(KW_SPRING13, EACH, 26, ONCE,  41,  60, 'alpha_rz', 'r', D_NUMBER, 0, 'weight in the sum'), &
   field_t(KW_SPRING13, EACH, 26, ONCE,  61,  80, 'beta_rz', 'r', D_NUMBER, 0, 'power in the sum'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE,  1,  10, 'node_id',   'i', D_NUMBER,    0, 'main node, 0 = created'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 11,  20, 'sens_id',   'i', D_NUMBER,    0, 'sensor that activates the body'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 21,  30, 'skew_id',   'i', D_NUMBER,    0, 'axes of the inertia'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 31,  40, 'Ispher',    'i', D_NUMBER,    0, '1 spherical, 2 corrected, 3 as given'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 41,  60, 'Mass',      'r', D_MASS,      0, 'mass added at the main node'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 61,  70, 'grnod_id',  'i', D_NUMBER,    0, 'group of the secondary nodes'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 71,  80, 'Ikrem',     'i', D_NUMBER,    0, '1: nodes stay in rigid walls'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 81, 90, 'ICoG',      'i', D_NUMBER,    0, 'centre: 1 of all nodes, 2 secondary, 3-4 main'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 91, 100, 'surf_id',   'i', D_NUMBER,    0, 'enveloping surface'), &
   field_t(KW_RBODY,   EACH, 2,  ONCE,  1,  20, 'Jxx',       'r', D_INERTIA,   0, 'added inertia, xx'), &
   field_t(KW_RBODY,   EACH, 2,  ONCE, 21,  40, 'Jyy',       'r', D_INERTIA,   0, 'added inertia, yy'), &
   field_t(KW_RBODY,   EACH, 2,  ONCE, 41,  60, 'Jzz',       'r', D_INERTIA,   0, 'added inertia, zz'), &
   field_t(KW_RBODY,   EACH, 3,  ONCE,  1,  20, 'Jxy',       'r', D_INERTIA,   0, 'added inertia, entry xy of the matrix'), &
   field_t(KW_RBODY,   EACH, 3,  ONCE, 21,  40, 'Jyz',       'r', D_INERTIA,   0, 'added inertia, entry yz of the matrix'), &
   field_t(KW_RBODY,   EACH, 3,  ONCE, 41,  60, 'Jxz',       'r', D_INERTIA,   0, 'added inertia, entry xz of the matrix'), &
   field_t(KW_RBODY,   EACH, 4,  ONCE,  1,  10, 'Ioptoff',   'i', D_NUMBER,    0, 'output of switched bodies'), &
   field_t(KW_RBODY,   EACH, 4,  ONCE, 11,  20, 'Iexpams',   'i', D_NUMBER,    0, 'mass scaling of other solvers'), &
   field_t(KW_RBODY,   EACH, 4,  ONCE, 21,  30, 'Ifail',     'i', D_NUMBER,    0, '1: secondary nodes can fail'), &
   field_t(KW_RBODY,   EACH, 5,  ONCE,  1,  20, 'FN',        'r', D_FORCE,     0, 'normal force of failure'), &
   field_t(KW_RBODY,   EACH, 5,  ONCE, 21,  40, 'FT',        'r', D_FORCE,     0, 'shear force of failure'), &
   field_t(KW_RBODY,   EACH, 5,  ONCE, 41,  60, 'expN',      'r', D_NUMBER,    0, 'exponent of the normal force'), &
   field_t(KW_RBODY,   EACH, 5,  ONCE, 61,  80, 'expT',      'r', D_NUMBER,    0, 'exponent of the shear force')]

   !> Control, nodes, parts, groups, boxes, skews, frames and functions
   type(field_t), parameter :: scene_fields(*) = [ &
   !       keyword, variant, card, times, columns, name, kind, dimension, since, meaning
   field_t(KW_BEGIN,          EACH, 1, ONCE,     1,  10, 'invers',       'i', D_NUMBER, 0, 'format version'), &
   field_t(KW_BEGIN,          EACH, 1, ONCE,    11,  20, 'irun',         'i', D_NUMBER, 0, 'run number, not used'), &
   field_t(KW_BEGIN,          EACH, 2, ONCE,     1,  20, 'mass_input',   'a', D_NUMBER, 0, 'unit of mass: code or SI value'), &
   field_t(KW_BEGIN,          EACH, 2, ONCE,    21,  40, 'length_input', 'a', D_NUMBER, 0, 'unit of length: code or SI value'), &
   field_t(KW_BEGIN,          EACH, 2, ONCE,    41,  60, 'time_input',   'a', D_NUMBER, 0, 'unit of time: code or SI value'), &
   field_t(KW_BEGIN,          EACH, 3, ONCE,     1,  20, 'mass_work',    'a', D_NUMBER, 0, 'unit of mass: code or SI value'), &
   field_t(KW_BEGIN,          EACH, 3, ONCE,    21,  40, 'length_work',  'a', D_NUMBER, 0, 'unit of length: code or SI value'), &
   field_t(KW_BEGIN,          EACH, 3, ONCE,    41,  60, 'time_work',    'a', D_NUMBER, 0, 'unit of time: code or SI value'), &
   field_t(KW_UNIT,           EACH, 1, ONCE,     1,  20, 'mass',         'a', D_NUMBER, 0, 'unit of mass: code or SI value'), &
   field_t(KW_UNIT,           EACH, 1, ONCE,    21,  40, 'length',       'a', D_NUMBER, 0, 'unit of length: code or SI value'), &
   field_t(KW_UNIT,           EACH, 1, ONCE,    41,  60, 'time',         'a', D_NUMBER, 0, 'unit of time: code or SI value'), &
   field_t(KW_UNIT_MASS,      EACH, 1, ONCE,     1,  20, 'mass',         'a', D_NUMBER, 0, 'unit of mass: code or SI value'), &
   field_t(KW_UNIT_LENGTH,    EACH, 1, ONCE,     1,  20, 'length',       'a', D_NUMBER, 0, 'unit of length: code or SI value'), &
   field_t(KW_UNIT_TIME,      EACH, 1, ONCE,     1,  20, 'time',         'a', D_NUMBER, 0, 'unit of time: code or SI value'), &
   field_t(KW_NODE,           EACH, 1, ROWS,     1,  10, 'id',           'i', D_NUMBER, 0, 'node id'), &
   field_t(KW_NODE,           EACH, 1, ROWS,    11,  30, 'X',            'r', D_LENGTH, 0, 'x coordinate'), &
   field_t(KW_NODE,           EACH, 1, ROWS,    31,  50, 'Y',            'r', D_LENGTH, 0, 'y coordinate'), &
   field_t(KW_NODE,           EACH, 1, ROWS,    51,  70, 'Z',            'r', D_LENGTH, 0, 'z coordinate'), &
   field_t(KW_PART,           EACH, 1, ONCE,     1,  10, 'prop_id',      'i', D_NUMBER, 0, 'property'), &
   field_t(KW_PART,           EACH, 1, ONCE,    11,  20, 'mat_id',       'i', D_NUMBER, 0, 'material, 0 for springs and joints'), &
   field_t(KW_PART,           EACH, 1, ONCE,    21,  30, 'subset_id',    'i', D_NUMBER, 0, 'subset'), &
   field_t(KW_PART,           EACH, 1, ONCE,    31,  50, 'thick',        'r', D_LENGTH, 0, 'virtual thickness'), &
   field_t(KW_PART,           EACH, 1, ONCE,    51,  70, 'Irigid',       'i', D_NUMBER, 2612, '1: rigid part, three more cards'), &
   field_t(KW_PART,           EACH, 2, ONCE,     1,  10, 'node_id',      'i', D_NUMBER, 2612, 'main node, 0 = created'), &
   field_t(KW_PART,           EACH, 2, ONCE,    11,  20, 'skew_id',      'i', D_NUMBER, 2612, 'axes of the inertia'), &
   field_t(KW_PART,           EACH, 2, ONCE,    21,  40, 'Mass',         'r', D_MASS,   2612, 'mass added at the main node'), &
   field_t(KW_PART,           EACH, 2, ONCE,    51,  60, 'sens_id',      'i', D_NUMBER, 2612, 'sensor that activates the body'), &
   field_t(KW_PART,           EACH, 3, ONCE,     1,  20, 'Jxx',          'r', D_INERTIA, 2612, 'added inertia, xx'), &
   field_t(KW_PART,           EACH, 3, ONCE,    21,  40, 'Jyy',          'r', D_INERTIA, 2612, 'added inertia, yy'), &
   field_t(KW_PART,           EACH, 3, ONCE,    41,  60, 'Jzz',          'r', D_INERTIA, 2612, 'added inertia, zz'), &
   field_t(KW_PART,           EACH, 4, ONCE,     1,  20, 'Jxy',          'r', D_INERTIA, 2612, 'added inertia, xy'), &
   field_t(KW_PART,           EACH, 4, ONCE,    21,  40, 'Jyz',          'r', D_INERTIA, 2612, 'added inertia, yz'), &
   field_t(KW_PART,           EACH, 4, ONCE,    41,  60, 'Jxz',          'r', D_INERTIA, 2612, 'added inertia, xz'), &
   field_t(KW_SPRING,         EACH, 1, ROWS,     1,  10, 'id',           'i', D_NUMBER, 0, 'spring id'), &
   field_t(KW_SPRING,         EACH, 1, ROWS,    11,  20, 'n1',           'i', D_NUMBER, 0, 'node 1'), &
   field_t(KW_SPRING,         EACH, 1, ROWS,    21,  30, 'n2',           'i', D_NUMBER, 0, 'node 2'), &
   field_t(KW_SPRING,         EACH, 1, ROWS,    31,  40, 'n3',           'i', D_NUMBER, 0, 'node 3'), &
   field_t(KW_SPRING,         EACH, 1, ROWS,    41,  50, 'n4',           'i', D_NUMBER, 0, 'node 4'), &
   field_t(KW_SPRING,         EACH, 1, ROWS,    51,  60, 'n5',           'i', D_NUMBER, 0, 'node 5'), &
   field_t(KW_SPRING,         EACH, 1, ROWS,    61,  70, 'n6',           'i', D_NUMBER, 0, 'node 6'), &
   field_t(KW_SPRING,         EACH, 1, ROWS,    91, 100, 'skew_id',      'i', D_NUMBER, 0, 'axes of springs of type 8'), &
   field_t(KW_MAT_VOID,       EACH, 1, ONCE,     1,  20, 'rho',          'r', D_NUMBER, 0, 'density, not used'), &
   field_t(KW_MAT_VOID,       EACH, 1, ONCE,    21,  40, 'E',            'r', D_NUMBER, 0, 'modulus, not used'), &
   field_t(KW_MAT_VOID,       EACH, 1, ONCE,    41,  60, 'nu',           'r', D_NUMBER, 0, 'ratio of Poisson, not used'), &
   field_t(KW_GRNOD_NODE,     EACH, 1, IDS,      1, 100, 'id',           'i', D_NUMBER, 0, 'node ids'), &
   field_t(KW_GRNOD_NODENS,   EACH, 1, IDS,      1, 100, 'id',           'i', D_NUMBER, 0, 'node ids'), &
   field_t(KW_GRNOD_GRNOD,    EACH, 1, IDS,      1, 100, 'id',           'i', D_NUMBER, 0, 'ids of groups, negative = removed'), &
   field_t(KW_GRNOD_GENE,     EACH, 1, PAIRS,    1, 100, 'id',           'i', D_NUMBER, 0, 'first and last id of ranges'), &
   field_t(KW_GRNOD_GEN_INCR, EACH, 1, TRIPLES,  1,  30, 'id',           'i', D_NUMBER, 0, 'first, last, increment'), &
   field_t(KW_GRNOD_PART,     EACH, 1, IDS,      1, 100, 'id',           'i', D_NUMBER, 0, 'part ids'), &
   field_t(KW_GRNOD_BOX,      EACH, 1, IDS,      1, 100, 'id',           'i', D_NUMBER, 0, 'box ids'), &
   field_t(KW_BOX_RECTA,      EACH, 1, ONCE,     1,  10, 'n1',           'i', D_NUMBER, 0, 'node at corner 1, 0 = none'), &
   field_t(KW_BOX_RECTA,      EACH, 1, ONCE,    11,  20, 'n2',           'i', D_NUMBER, 0, 'node at corner 2, 0 = none'), &
   field_t(KW_BOX_RECTA,      EACH, 1, ONCE,    21,  30, 'skew_id',      'i', D_NUMBER, 0, 'axes of the box'), &
   field_t(KW_BOX_RECTA,      EACH, 2, ONCE,     1,  20, 'X1',           'r', D_LENGTH, 0, 'corner 1, x'), &
   field_t(KW_BOX_RECTA,      EACH, 2, ONCE,    21,  40, 'Y1',           'r', D_LENGTH, 0, 'corner 1, y'), &
   field_t(KW_BOX_RECTA,      EACH, 2, ONCE,    41,  60, 'Z1',           'r', D_LENGTH, 0, 'corner 1, z'), &
   field_t(KW_BOX_RECTA,      EACH, 3, ONCE,     1,  20, 'X2',           'r', D_LENGTH, 0, 'corner 2, x'), &
   field_t(KW_BOX_RECTA,      EACH, 3, ONCE,    21,  40, 'Y2',           'r', D_LENGTH, 0, 'corner 2, y'), &
   field_t(KW_BOX_RECTA,      EACH, 3, ONCE,    41,  60, 'Z2',           'r', D_LENGTH, 0, 'corner 2, z'), &
   field_t(KW_SET_GENERAL,    EACH, 1, CLAUSES,  1,  10, 'clause',       'a', D_NUMBER, 0, 'NODE, PART, ...; blank goes on'), &
   field_t(KW_SET_GENERAL,    EACH, 1, CLAUSES, 11, 100, 'id',           'i', D_NUMBER, 0, 'ids of the clause'), &
   field_t(KW_SKEW_FIX,       EACH, 1, ONCE,     1,  20, 'Ox',           'r', D_LENGTH, 0, 'origin, x'), &
   field_t(KW_SKEW_FIX,       EACH, 1, ONCE,    21,  40, 'Oy',           'r', D_LENGTH, 0, 'origin, y'), &
   field_t(KW_SKEW_FIX,       EACH, 1, ONCE,    41,  60, 'Oz',           'r', D_LENGTH, 0, 'origin, z'), &
   field_t(KW_SKEW_FIX,       EACH, 2, ONCE,     1,  20, 'Yx',           'r', D_NUMBER, 0, 'y axis, component x'), &
   field_t(KW_SKEW_FIX,       EACH, 2, ONCE,    21,  40, 'Yy',           'r', D_NUMBER, 0, 'y axis, component y'), &
   field_t(KW_SKEW_FIX,       EACH, 2, ONCE,    41,  60, 'Yz',           'r', D_NUMBER, 0, 'y axis, component z'), &
   field_t(KW_SKEW_FIX,       EACH, 3, ONCE,     1,  20, 'Zx',           'r', D_NUMBER, 0, 'z axis, component x'), &
   field_t(KW_SKEW_FIX,       EACH, 3, ONCE,    21,  40, 'Zy',           'r', D_NUMBER, 0, 'z axis, component y'), &
   field_t(KW_SKEW_FIX,       EACH, 3, ONCE,    41,  60, 'Zz',           'r', D_NUMBER, 0, 'z axis, component z'), &
   field_t(KW_SKEW_MOV,       EACH, 1, ONCE,     1,  10, 'n1',           'i', D_NUMBER, 0, 'node 1, origin'), &
   field_t(KW_SKEW_MOV,       EACH, 1, ONCE,    11,  20, 'n2',           'i', D_NUMBER, 0, 'node 2'), &
   field_t(KW_SKEW_MOV,       EACH, 1, ONCE,    21,  30, 'n3',           'i', D_NUMBER, 0, 'node 3'), &
   field_t(KW_SKEW_MOV,       EACH, 1, ONCE,    31,  40, 'dir',          'a', D_NUMBER, 0, 'axis from n1 to n2: X, Y or Z'), &
   field_t(KW_SKEW_MOV2,      EACH, 1, ONCE,     1,  10, 'n1',           'i', D_NUMBER, 0, 'node 1, origin'), &
   field_t(KW_SKEW_MOV2,      EACH, 1, ONCE,    11,  20, 'n2',           'i', D_NUMBER, 0, 'node 2'), &
   field_t(KW_SKEW_MOV2,      EACH, 1, ONCE,    21,  30, 'n3',           'i', D_NUMBER, 0, 'node 3'), &
   field_t(KW_FRAME_FIX,      EACH, 1, ONCE,     1,  20, 'Ox',           'r', D_LENGTH, 0, 'origin, x'), &
   field_t(KW_FRAME_FIX,      EACH, 1, ONCE,    21,  40, 'Oy',           'r', D_LENGTH, 0, 'origin, y'), &
   field_t(KW_FRAME_FIX,      EACH, 1, ONCE,    41,  60, 'Oz',           'r', D_LENGTH, 0, 'origin, z'), &
   field_t(KW_FRAME_FIX,      EACH, 2, ONCE,     1,  20, 'Yx',           'r', D_NUMBER, 0, 'y axis, component x'), &
   field_t(KW_FRAME_FIX,      EACH, 2, ONCE,    21,  40, 'Yy',           'r', D_NUMBER, 0, 'y axis, component y'), &
   field_t(KW_FRAME_FIX,      EACH, 2, ONCE,    41,  60, 'Yz',           'r', D_NUMBER, 0, 'y axis, component z'), &
   field_t(KW_FRAME_FIX,      EACH, 3, ONCE,     1,  20, 'Zx',           'r', D_NUMBER, 0, 'z axis, component x'), &
   field_t(KW_FRAME_FIX,      EACH, 3, ONCE,    21,  40, 'Zy',           'r', D_NUMBER, 0, 'z axis, component y'), &
   field_t(KW_FRAME_FIX,      EACH, 3, ONCE,    41,  60, 'Zz',           'r', D_NUMBER, 0, 'z axis, component z'), &
   field_t(KW_FRAME_MOV,      EACH, 1, ONCE,     1,  10, 'n1',           'i', D_NUMBER, 0, 'node 1, origin'), &
   field_t(KW_FRAME_MOV,      EACH, 1, ONCE,    11,  20, 'n2',           'i', D_NUMBER, 0, 'node 2'), &
   field_t(KW_FRAME_MOV,      EACH, 1, ONCE,    21,  30, 'n3',           'i', D_NUMBER, 0, 'node 3'), &
   field_t(KW_FRAME_MOV,      EACH, 1, ONCE,    31,  40, 'dir',          'a', D_NUMBER, 0, 'axis from n1 to n2: X, Y or Z'), &
   field_t(KW_FRAME_MOV2,     EACH, 1, ONCE,     1,  10, 'n1',           'i', D_NUMBER, 0, 'node 1, origin'), &
   field_t(KW_FRAME_MOV2,     EACH, 1, ONCE,    11,  20, 'n2',           'i', D_NUMBER, 0, 'node 2'), &
   field_t(KW_FRAME_MOV2,     EACH, 1, ONCE,    21,  30, 'n3',           'i', D_NUMBER, 0, 'node 3'), &
   field_t(KW_FRAME_NOD,      EACH, 1, ONCE,     1,  10, 'n1',           'i', D_NUMBER, 0, 'node 1, origin'), &
   field_t(KW_FRAME_NOD,      EACH, 1, ONCE,    11,  20, 'n2',           'i', D_NUMBER, 0, 'node 2'), &
   field_t(KW_FRAME_NOD,      EACH, 1, ONCE,    21,  30, 'n3',           'i', D_NUMBER, 0, 'node 3'), &
   field_t(KW_FRAME_NOD,      EACH, 2, ONCE,     1,  20, 'Yx',           'r', D_NUMBER, 0, 'y axis, component x'), &
   field_t(KW_FRAME_NOD,      EACH, 2, ONCE,    21,  40, 'Yy',           'r', D_NUMBER, 0, 'y axis, component y'), &
   field_t(KW_FRAME_NOD,      EACH, 2, ONCE,    41,  60, 'Yz',           'r', D_NUMBER, 0, 'y axis, component z'), &
   field_t(KW_FRAME_NOD,      EACH, 3, ONCE,     1,  20, 'Zx',           'r', D_NUMBER, 0, 'z axis, component x'), &
   field_t(KW_FRAME_NOD,      EACH, 3, ONCE,    21,  40, 'Zy',           'r', D_NUMBER, 0, 'z axis, component y'), &
   field_t(KW_FRAME_NOD,      EACH, 3, ONCE,    41,  60, 'Zz',           'r', D_NUMBER, 0, 'z axis, component z'), &
   field_t(KW_FUNCT,          EACH, 1, ROWS,     1,  20, 'x',            'r', D_NUMBER, 0, 'abscissa'), &
   field_t(KW_FUNCT,          EACH, 1, ROWS,    21,  40, 'y',            'r', D_NUMBER, 0, 'ordinate'), &
   field_t(KW_MOVE_FUNCT,     EACH, 1, ONCE,     1,  20, 'Ascale_x',     'r', D_NUMBER, 0, 'scale of the abscissa'), &
   field_t(KW_MOVE_FUNCT,     EACH, 1, ONCE,    21,  40, 'Fscale_y',     'r', D_NUMBER, 0, 'scale of the ordinate'), &
   field_t(KW_MOVE_FUNCT,     EACH, 1, ONCE,    41,  60, 'Ashift_x',     'r', D_NUMBER, 0, 'shift of the abscissa'), &
   field_t(KW_MOVE_FUNCT,     EACH, 1, ONCE,    61,  80, 'Fshift_y',     'r', D_NUMBER, 0, 'shift of the ordinate')]

   !> Conditions, loads, initial velocities, masses, sensors, histories, the rest
   type(field_t), parameter :: load_fields(*) = [ &
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
   field_t(KW_CLOAD,       EACH, 1, ONCE,  11,  20, 'dir',      'a', D_NUMBER,           0, 'along X Y Z, about XX YY ZZ'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  21,  30, 'skew_id',  'i', D_NUMBER,           0, 'axes of the direction'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  31,  40, 'sens_id',  'i', D_NUMBER,           0, 'switching sensor'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  41,  50, 'grnod_id', 'i', D_NUMBER,           0, 'group of nodes'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  51,  60, 'Itypfun',  'i', D_NUMBER,           2023, 'abscissa: 0, 1 t; 2 u; 3 v'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  61,  80, 'Ascale',   'r', D_TIME,             0, 'scale of the abscissa, 0 = 1'), &
   field_t(KW_CLOAD,       EACH, 1, ONCE,  81, 100, 'Fscale',   'r', D_NUMBER,           0, 'scale of the function, 0 = 1'), &
   field_t(KW_IMPVEL,      EACH, 1, ONCE,   1,  10, 'fct_id',   'i', D_NUMBER,           0, 'function of time'), &
   field_t(KW_IMPVEL,      EACH, 1, ONCE,  11,  20, 'dir',      'a', D_NUMBER,           0, 'along X Y Z, about XX YY ZZ'), &
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
   field_t(KW_IMPDISP,     EACH, 1, ONCE,  11,  20, 'dir',      'a', D_NUMBER,           0, 'along X Y Z, about XX YY ZZ'), &
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
   field_t(KW_IMPACC,      EACH, 1, ONCE,  11,  20, 'dir',      'a', D_NUMBER,           0, 'along X Y Z, about XX YY ZZ'), &
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

   !> All fields; those of one keyword stand together
   type(field_t), parameter, public :: fields(*) = &
      [joint_fields, property_fields, scene_fields, load_fields, full_fields]

contains

   !> First and last row of each keyword in the table of fields; 1 and 0 when it has none
   pure subroutine field_range(first, last)
      integer, intent(out) :: first(N_KEYWORD), last(N_KEYWORD)

      integer :: i, k

      first = 1
      last = 0
      do i = 1, size(fields)
         k = fields(i)%keyword
         if (last(k) == 0) first(k) = i
         last(k) = i
      end do
   end subroutine field_range

   !> The keyword has fields for this type in the header
   pure logical function has_variant(keyword, variant)
      integer, intent(in) :: keyword, variant

      has_variant = any(fields%keyword == keyword .and. &
         (fields%variant == variant .or. fields%variant == EACH))
   end function has_variant

   !> Directions whose cards (times = DOFS) stand in a block
   pure subroutine list_free_dofs(keyword, joint_type, n, dof)
      integer, intent(in) :: keyword           !! KW_KJOINT2, or a spring of six laws
      integer, intent(in) :: joint_type        !! of KJOINT2; 0 directions when there is none
      integer, intent(out) :: n, dof(NDOF)     !! the first n are set: 1 tx, ..., 6 rz

      integer :: i, row

      n = 0
      dof = 0
      row = find_joint_type(joint_type)
      do i = 1, NDOF
         if (keyword == KW_KJOINT2) then
            if (row == 0) return
            if (joint_types(row)%free(i) == 0) cycle
         end if
         n = n + 1
         dof(n) = i
      end do
   end subroutine list_free_dofs

   !> Dimension of a field for a rotation, given that for a translation
   pure integer function rotational(dim) result(other)
      integer, intent(in) :: dim               !! D_ constant

      integer, parameter :: PAIR(2, 5) = reshape([D_LENGTH, D_NUMBER, D_STIFFNESS, &
         D_ROT_STIFFNESS, D_DAMPING, D_ROT_DAMPING, D_FORCE, D_MOMENT, D_VELOCITY, &
         D_ANGULAR_VELOCITY], [2, 5])
      integer :: i

      other = dim
      do i = 1, size(PAIR, 2)
         if (PAIR(1, i) == dim) other = PAIR(2, i)
      end do
   end function rotational

end module kj_card_fields
