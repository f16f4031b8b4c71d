!> Fields of the cards of control, nodes, parts, groups, axes and functions.
module kj_card_fields_scene
   use kj_units, only: D_LENGTH, D_NUMBER
   use kj_card_field, only: field_t, EACH, ONCE, ROWS, IDS, PAIRS, TRIPLES, CLAUSES
   use kj_keywords, only: KW_BEGIN, KW_UNIT, KW_NODE, KW_PART, KW_SPRING, KW_MAT_VOID, &
      KW_GRNOD_NODE, KW_GRNOD_NODENS, KW_GRNOD_GRNOD, KW_GRNOD_GENE, KW_GRNOD_GEN_INCR, &
      KW_GRNOD_PART, KW_GRNOD_BOX, KW_BOX_RECTA, KW_SET_GENERAL, KW_SKEW_FIX, KW_SKEW_MOV, &
      KW_SKEW_MOV2, KW_FRAME_FIX, KW_FRAME_MOV, KW_FRAME_MOV2, KW_FRAME_NOD, KW_FUNCT, KW_MOVE_FUNCT
   implicit none
   private

   !> Control, nodes, parts, groups, boxes, skews, frames and functions
   type(field_t), parameter, public :: scene_fields(*) = [ &
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
   field_t(KW_NODE,           EACH, 1, ROWS,     1,  10, 'id',           'i', D_NUMBER, 0, 'node id'), &
   field_t(KW_NODE,           EACH, 1, ROWS,    11,  30, 'X',            'r', D_LENGTH, 0, 'x coordinate'), &
   field_t(KW_NODE,           EACH, 1, ROWS,    31,  50, 'Y',            'r', D_LENGTH, 0, 'y coordinate'), &
   field_t(KW_NODE,           EACH, 1, ROWS,    51,  70, 'Z',            'r', D_LENGTH, 0, 'z coordinate'), &
   field_t(KW_PART,           EACH, 1, ONCE,     1,  10, 'prop_id',      'i', D_NUMBER, 0, 'property'), &
   field_t(KW_PART,           EACH, 1, ONCE,    11,  20, 'mat_id',       'i', D_NUMBER, 0, 'material, 0 for springs and joints'), &
   field_t(KW_PART,           EACH, 1, ONCE,    21,  30, 'subset_id',    'i', D_NUMBER, 0, 'subset'), &
   field_t(KW_PART,           EACH, 1, ONCE,    31,  50, 'thick',        'r', D_LENGTH, 0, 'virtual thickness'), &
   field_t(KW_PART,           EACH, 1, ONCE,    51,  60, 'Irigid',       'i', D_NUMBER, 2612, '1: rigid part'), &
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

end module kj_card_fields_scene
