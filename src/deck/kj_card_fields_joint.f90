!> Fields of the cards of joints, springs and rigid bodies.
module kj_card_fields_joint
   use kj_units, only: D_DAMPING, D_FORCE, D_INERTIA, D_LENGTH, D_MASS, D_NUMBER, D_ROT_DAMPING, &
      D_ROT_STIFFNESS, D_STIFFNESS, D_VELOCITY
   use kj_card_field, only: field_t, EACH, ONCE, DOFS
   use kj_keywords, only: KW_KJOINT, KW_KJOINT2, KW_SPRING4, KW_SPRING8, KW_RBODY
   implicit none
   private

   !> /PROP/TYPE33 = /PROP/KJOINT; the variant is the joint type
   type(field_t), parameter, public :: joint_fields(*) = [ &
   !       keyword, variant, card, times, columns, name, kind, dimension, since, meaning
   field_t(KW_KJOINT, EACH, 1,  ONCE,  1,  10, 'type',      'i', D_NUMBER,        0, 'number of the joint type'), &
   field_t(KW_KJOINT, EACH, 1,  ONCE, 11,  20, 'skew_flag', 'i', D_NUMBER,        0, '0 mean frame, 1 frame of skew_1'), &
   field_t(KW_KJOINT, EACH, 2,  ONCE,  1,  10, 'skew_1',    'i', D_NUMBER,        0, 'moving skew on body 1'), &
   field_t(KW_KJOINT, EACH, 2,  ONCE, 11,  20, 'skew_2',    'i', D_NUMBER,        0, 'moving skew on body 2, 0 = none'), &
   field_t(KW_KJOINT, EACH, 2,  ONCE, 21,  40, 'Xk',        'r', D_STIFFNESS,     0, 'stiffness for contacts'), &
   field_t(KW_KJOINT, EACH, 2,  ONCE, 41,  60, 'Cr',        'r', D_NUMBER,        0, 'critical damping ratio'), &
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
   type(field_t), parameter, public :: property_fields(*) = [ &
   !       keyword, variant, card, times, columns, name, kind, dimension, since, meaning
   field_t(KW_KJOINT2, EACH, 1,  ONCE,  1,  10, 'type',      'i', D_NUMBER,    0, 'number of the joint type'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 11,  30, 'Kn',        'r', D_STIFFNESS, 0, 'blocking stiffness, 0 = automatic'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 31,  50, 'SCF',       'r', D_NUMBER,    0, 'scale of the blocked rotations'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 51,  70, 'Cr',        'r', D_NUMBER,    0, 'critical damping ratio'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 71,  80, 'sens_id',   'i', D_NUMBER,    0, 'sensor that locks the joint'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 81,  90, 'skew_1',    'i', D_NUMBER,    0, 'axes of end 1'), &
   field_t(KW_KJOINT2, EACH, 1,  ONCE, 91, 100, 'skew_2',    'i', D_NUMBER,    0, 'axes of end 2'), &
   field_t(KW_KJOINT2, EACH, 2,  DOFS,  1,  20, 'K',         'r', D_STIFFNESS, 0, 'stiffness, or scale of f_K'), &
   field_t(KW_KJOINT2, EACH, 2,  DOFS, 21,  30, 'f_K',       'i', D_NUMBER,    0, 'function of force'), &
   field_t(KW_KJOINT2, EACH, 2,  DOFS, 31,  50, 'SA-',       'r', D_LENGTH,    0, 'lower stop, 0 = none'), &
   field_t(KW_KJOINT2, EACH, 2,  DOFS, 51,  70, 'SA+',       'r', D_LENGTH,    0, 'upper stop, 0 = none'), &
   field_t(KW_KJOINT2, EACH, 2,  DOFS, 71,  80, 'Icomb',     'i', D_NUMBER,    0, 'combination of stops'), &
   field_t(KW_KJOINT2, EACH, 3,  DOFS,  1,  20, 'C',         'r', D_DAMPING,   0, 'damping, or scale of f_C'), &
   field_t(KW_KJOINT2, EACH, 3,  DOFS, 21,  30, 'f_C',       'i', D_NUMBER,    0, 'function of damping'), &
   field_t(KW_KJOINT2, EACH, 4,  DOFS,  1,  20, 'Kfr',       'r', D_STIFFNESS, 0, 'stiffness of friction'), &
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
   field_t(KW_SPRING8, EACH, 20, ONCE,  1,  10, 'Fsmooth',   'i', D_NUMBER,    0, '1: rates are filtered'), &
   field_t(KW_SPRING8, EACH, 20, ONCE, 11,  30, 'Fcut',      'r', D_NUMBER,    0, 'cutting frequency of the filter'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE,  1,  10, 'node_id',   'i', D_NUMBER,    0, 'main node, 0 = created'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 11,  20, 'sens_id',   'i', D_NUMBER,    0, 'sensor that activates the body'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 21,  30, 'skew_id',   'i', D_NUMBER,    0, 'axes of the inertia'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 31,  40, 'Ispher',    'i', D_NUMBER,    0, '1 spherical, 2 corrected, 3 as given'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 41,  60, 'Mass',      'r', D_MASS,      0, 'mass added at the main node'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 61,  70, 'grnod_id',  'i', D_NUMBER,    0, 'group of the secondary nodes'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 71,  80, 'Ikrem',     'i', D_NUMBER,    0, '1: nodes stay in rigid walls'), &
   field_t(KW_RBODY,   EACH, 1,  ONCE, 81,  90, 'ICoG',      'i', D_NUMBER,    0, 'rule of the centre of gravity, 1 to 4'), &
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

end module kj_card_fields_joint
