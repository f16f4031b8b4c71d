!> Fields of the cards that full decks have besides those of a mechanism: selections of nodes,
!> moves, RBE2, masses of parts and surfaces. A part of THE table of kj_card_fields.
module kj_full_fields
   use kj_units, only: D_AREA_DENSITY, D_LENGTH, D_MASS, D_NUMBER
   use kj_keywords, only: KW_ADMAS, KW_BOX_CYLIN, KW_BOX_SPHER, KW_GRNOD_GRBEAM, &
      KW_GRNOD_GRBRIC, KW_GRNOD_GRSH3N, KW_GRNOD_GRSHEL, KW_GRNOD_GRSPRI, KW_GRNOD_GRTRUS, &
      KW_GRNOD_LINE, KW_GRNOD_MAT, KW_GRNOD_PROP, KW_GRNOD_SUBMODEL, KW_GRNOD_SUBSET, &
      KW_GRNOD_SURF, KW_RBE2, KW_SET_COLLECT, KW_TRANS_MATRIX, KW_TRANS_POSITION, KW_TRANS_ROT, &
      KW_TRANS_SCA, KW_TRANS_SYM, KW_TRANS_TRA
   use kj_field, only: field_t, EACH, ONCE, ROWS, IDS, CLAUSES
   implicit none
   private

   type(field_t), parameter, public :: full_fields(*) = [ &
   ! keyword, variant, card, times, columns, name, kind, dimension, since, meaning
   field_t(KW_RBE2, EACH, 1, ONCE, 1, 10, 'node_id', 'i', D_NUMBER, 0, 'main node'), &
   field_t(KW_RBE2, EACH, 1, ONCE, 14, 14, 'Tx', 'i', D_NUMBER, 0, '1: translation along x coupled'), &
   field_t(KW_RBE2, EACH, 1, ONCE, 15, 15, 'Ty', 'i', D_NUMBER, 0, '1: translation along y coupled'), &
   field_t(KW_RBE2, EACH, 1, ONCE, 16, 16, 'Tz', 'i', D_NUMBER, 0, '1: translation along z coupled'), &
   field_t(KW_RBE2, EACH, 1, ONCE, 18, 18, 'Rx', 'i', D_NUMBER, 0, '1: rotation about x coupled'), &
   field_t(KW_RBE2, EACH, 1, ONCE, 19, 19, 'Ry', 'i', D_NUMBER, 0, '1: rotation about y coupled'), &
   field_t(KW_RBE2, EACH, 1, ONCE, 20, 20, 'Rz', 'i', D_NUMBER, 0, '1: rotation about z coupled'), &
   field_t(KW_RBE2, EACH, 1, ONCE, 21, 30, 'skew_id', 'i', D_NUMBER, 0, 'axes of the directions'), &
   field_t(KW_RBE2, EACH, 1, ONCE, 31, 40, 'grnod_id', 'i', D_NUMBER, 0, 'group of the secondary nodes'), &
   field_t(KW_RBE2, EACH, 1, ONCE, 41, 50, 'Iflag', 'i', D_NUMBER, 0, 'form of the coupling'), &
   field_t(KW_GRNOD_SUBSET, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'subset ids'), &
   field_t(KW_GRNOD_MAT, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'material ids'), &
   field_t(KW_GRNOD_PROP, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'property ids'), &
   field_t(KW_GRNOD_SUBMODEL, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'submodel ids'), &
   field_t(KW_GRNOD_GRSHEL, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'ids of groups of shells'), &
   field_t(KW_GRNOD_GRSH3N, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'ids of groups of triangles'), &
   field_t(KW_GRNOD_GRBRIC, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'ids of groups of solids'), &
   field_t(KW_GRNOD_GRBEAM, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'ids of groups of beams'), &
   field_t(KW_GRNOD_GRTRUS, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'ids of groups of trusses'), &
   field_t(KW_GRNOD_GRSPRI, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'ids of groups of springs'), &
   field_t(KW_GRNOD_SURF, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'ids of surfaces'), &
   field_t(KW_GRNOD_LINE, EACH, 1, IDS, 1, 100, 'id', 'i', D_NUMBER, 0, 'ids of lines'), &
   field_t(KW_BOX_SPHER, EACH, 1, ONCE, 1, 10, 'n1', 'i', D_NUMBER, 0, 'node at the centre, 0 = none'), &
   field_t(KW_BOX_SPHER, EACH, 1, ONCE, 31, 50, 'Diameter', 'r', D_LENGTH, 0, 'diameter of the sphere'), &
   field_t(KW_BOX_SPHER, EACH, 2, ONCE, 1, 20, 'X1', 'r', D_LENGTH, 0, 'centre, x'), &
   field_t(KW_BOX_SPHER, EACH, 2, ONCE, 21, 40, 'Y1', 'r', D_LENGTH, 0, 'centre, y'), &
   field_t(KW_BOX_SPHER, EACH, 2, ONCE, 41, 60, 'Z1', 'r', D_LENGTH, 0, 'centre, z'), &
   field_t(KW_BOX_CYLIN, EACH, 1, ONCE, 1, 10, 'n1', 'i', D_NUMBER, 0, 'node at end 1 of the axis, 0 = none'), &
   field_t(KW_BOX_CYLIN, EACH, 1, ONCE, 11, 20, 'n2', 'i', D_NUMBER, 0, 'node at end 2 of the axis, 0 = none'), &
   field_t(KW_BOX_CYLIN, EACH, 1, ONCE, 31, 50, 'Diameter', 'r', D_LENGTH, 0, 'diameter of the cylinder'), &
   field_t(KW_BOX_CYLIN, EACH, 2, ONCE, 1, 20, 'X1', 'r', D_LENGTH, 0, 'end 1 of the axis, x'), &
   field_t(KW_BOX_CYLIN, EACH, 2, ONCE, 21, 40, 'Y1', 'r', D_LENGTH, 0, 'end 1 of the axis, y'), &
   field_t(KW_BOX_CYLIN, EACH, 2, ONCE, 41, 60, 'Z1', 'r', D_LENGTH, 0, 'end 1 of the axis, z'), &
   field_t(KW_BOX_CYLIN, EACH, 3, ONCE, 1, 20, 'X2', 'r', D_LENGTH, 0, 'end 2 of the axis, x'), &
   field_t(KW_BOX_CYLIN, EACH, 3, ONCE, 21, 40, 'Y2', 'r', D_LENGTH, 0, 'end 2 of the axis, y'), &
   field_t(KW_BOX_CYLIN, EACH, 3, ONCE, 41, 60, 'Z2', 'r', D_LENGTH, 0, 'end 2 of the axis, z'), &
   field_t(KW_SET_COLLECT, EACH, 1, CLAUSES, 1, 10, 'clause', 'a', D_NUMBER, 0, 'NODE, PART, ...; blank goes on'), &
   field_t(KW_SET_COLLECT, EACH, 1, CLAUSES, 11, 100, 'id', 'i', D_NUMBER, 0, 'ids of the clause'), &
   field_t(KW_TRANS_TRA, EACH, 1, ONCE, 1, 10, 'grnod_id', 'i', D_NUMBER, 0, 'group of nodes'), &
   field_t(KW_TRANS_TRA, EACH, 1, ONCE, 11, 30, 'Tx', 'r', D_LENGTH, 0, 'translation, x'), &
   field_t(KW_TRANS_TRA, EACH, 1, ONCE, 31, 50, 'Ty', 'r', D_LENGTH, 0, 'translation, y'), &
   field_t(KW_TRANS_TRA, EACH, 1, ONCE, 51, 70, 'Tz', 'r', D_LENGTH, 0, 'translation, z'), &
   field_t(KW_TRANS_TRA, EACH, 1, ONCE, 71, 80, 'n1', 'i', D_NUMBER, 0, 'node 1'), &
   field_t(KW_TRANS_TRA, EACH, 1, ONCE, 81, 90, 'n2', 'i', D_NUMBER, 0, 'node 2'), &
   field_t(KW_TRANS_TRA, EACH, 1, ONCE, 91, 100, 'submodel', 'i', D_NUMBER, 0, 'submodel whose nodes are moved'), &
   field_t(KW_TRANS_TRA, EACH, 2, ONCE, 1, 10, 'skew_id', 'i', D_NUMBER, 2026, 'axes of the translation'), &
   field_t(KW_TRANS_ROT, EACH, 1, ONCE, 1, 10, 'grnod_id', 'i', D_NUMBER, 0, 'group of nodes'), &
   field_t(KW_TRANS_ROT, EACH, 1, ONCE, 11, 30, 'X1', 'r', D_LENGTH, 0, 'point 1, x'), &
   field_t(KW_TRANS_ROT, EACH, 1, ONCE, 31, 50, 'Y1', 'r', D_LENGTH, 0, 'point 1, y'), &
   field_t(KW_TRANS_ROT, EACH, 1, ONCE, 51, 70, 'Z1', 'r', D_LENGTH, 0, 'point 1, z'), &
   field_t(KW_TRANS_ROT, EACH, 1, ONCE, 71, 80, 'n1', 'i', D_NUMBER, 0, 'node 1'), &
   field_t(KW_TRANS_ROT, EACH, 1, ONCE, 81, 90, 'n2', 'i', D_NUMBER, 0, 'node 2'), &
   field_t(KW_TRANS_ROT, EACH, 1, ONCE, 91, 100, 'submodel', 'i', D_NUMBER, 0, 'submodel whose nodes are moved'), &
   field_t(KW_TRANS_ROT, EACH, 2, ONCE, 11, 30, 'X2', 'r', D_LENGTH, 0, 'point 2, x'), &
   field_t(KW_TRANS_ROT, EACH, 2, ONCE, 31, 50, 'Y2', 'r', D_LENGTH, 0, 'point 2, y'), &
   field_t(KW_TRANS_ROT, EACH, 2, ONCE, 51, 70, 'Z2', 'r', D_LENGTH, 0, 'point 2, z'), &
   field_t(KW_TRANS_ROT, EACH, 2, ONCE, 71, 90, 'Angle', 'r', D_NUMBER, 0, 'angle in degrees'), &
   field_t(KW_TRANS_SYM, EACH, 1, ONCE, 1, 10, 'grnod_id', 'i', D_NUMBER, 0, 'group of nodes'), &
   field_t(KW_TRANS_SYM, EACH, 1, ONCE, 11, 30, 'X1', 'r', D_LENGTH, 0, 'point 1, x'), &
   field_t(KW_TRANS_SYM, EACH, 1, ONCE, 31, 50, 'Y1', 'r', D_LENGTH, 0, 'point 1, y'), &
   field_t(KW_TRANS_SYM, EACH, 1, ONCE, 51, 70, 'Z1', 'r', D_LENGTH, 0, 'point 1, z'), &
   field_t(KW_TRANS_SYM, EACH, 1, ONCE, 71, 80, 'n1', 'i', D_NUMBER, 0, 'node 1'), &
   field_t(KW_TRANS_SYM, EACH, 1, ONCE, 81, 90, 'n2', 'i', D_NUMBER, 0, 'node 2'), &
   field_t(KW_TRANS_SYM, EACH, 1, ONCE, 91, 100, 'submodel', 'i', D_NUMBER, 2026, 'submodel whose nodes are moved'), &
   field_t(KW_TRANS_SYM, EACH, 2, ONCE, 11, 30, 'X2', 'r', D_LENGTH, 0, 'point 2, x'), &
   field_t(KW_TRANS_SYM, EACH, 2, ONCE, 31, 50, 'Y2', 'r', D_LENGTH, 0, 'point 2, y'), &
   field_t(KW_TRANS_SYM, EACH, 2, ONCE, 51, 70, 'Z2', 'r', D_LENGTH, 0, 'point 2, z'), &
   field_t(KW_TRANS_SCA, EACH, 1, ONCE, 1, 10, 'grnod_id', 'i', D_NUMBER, 0, 'group of nodes'), &
   field_t(KW_TRANS_SCA, EACH, 1, ONCE, 11, 30, 'Sx', 'r', D_NUMBER, 0, 'scale, 0 = 1, x'), &
   field_t(KW_TRANS_SCA, EACH, 1, ONCE, 31, 50, 'Sy', 'r', D_NUMBER, 0, 'scale, 0 = 1, y'), &
   field_t(KW_TRANS_SCA, EACH, 1, ONCE, 51, 70, 'Sz', 'r', D_NUMBER, 0, 'scale, 0 = 1, z'), &
   field_t(KW_TRANS_SCA, EACH, 1, ONCE, 71, 80, 'n1', 'i', D_NUMBER, 0, 'node 1'), &
   field_t(KW_TRANS_SCA, EACH, 1, ONCE, 91, 100, 'submodel', 'i', D_NUMBER, 2026, 'submodel whose nodes are moved'), &
   field_t(KW_TRANS_MATRIX, EACH, 1, ONCE, 1, 10, 'grnod_id', 'i', D_NUMBER, 0, 'group of nodes'), &
   field_t(KW_TRANS_MATRIX, EACH, 1, ONCE, 11, 30, 'M11', 'r', D_NUMBER, 0, 'row 1, x'), &
   field_t(KW_TRANS_MATRIX, EACH, 1, ONCE, 31, 50, 'M12', 'r', D_NUMBER, 0, 'row 1, y'), &
   field_t(KW_TRANS_MATRIX, EACH, 1, ONCE, 51, 70, 'M13', 'r', D_NUMBER, 0, 'row 1, z'), &
   field_t(KW_TRANS_MATRIX, EACH, 1, ONCE, 71, 90, 'Tx', 'r', D_LENGTH, 0, 'translation, x'), &
   field_t(KW_TRANS_MATRIX, EACH, 1, ONCE, 91, 100, 'submodel', 'i', D_NUMBER, 0, 'submodel whose nodes are moved'), &
   field_t(KW_TRANS_MATRIX, EACH, 2, ONCE, 11, 30, 'M21', 'r', D_NUMBER, 0, 'row 2, x'), &
   field_t(KW_TRANS_MATRIX, EACH, 2, ONCE, 31, 50, 'M22', 'r', D_NUMBER, 0, 'row 2, y'), &
   field_t(KW_TRANS_MATRIX, EACH, 2, ONCE, 51, 70, 'M23', 'r', D_NUMBER, 0, 'row 2, z'), &
   field_t(KW_TRANS_MATRIX, EACH, 2, ONCE, 71, 90, 'Ty', 'r', D_LENGTH, 0, 'translation, y'), &
   field_t(KW_TRANS_MATRIX, EACH, 3, ONCE, 11, 30, 'M31', 'r', D_NUMBER, 0, 'row 3, x'), &
   field_t(KW_TRANS_MATRIX, EACH, 3, ONCE, 31, 50, 'M32', 'r', D_NUMBER, 0, 'row 3, y'), &
   field_t(KW_TRANS_MATRIX, EACH, 3, ONCE, 51, 70, 'M33', 'r', D_NUMBER, 0, 'row 3, z'), &
   field_t(KW_TRANS_MATRIX, EACH, 3, ONCE, 71, 90, 'Tz', 'r', D_LENGTH, 0, 'translation, z'), &
   field_t(KW_TRANS_POSITION, EACH, 1, ONCE, 1, 10, 'grnod_id', 'i', D_NUMBER, 0, 'group of nodes'), &
   field_t(KW_TRANS_POSITION, EACH, 1, ONCE, 11, 20, 'n1', 'i', D_NUMBER, 0, 'node 1'), &
   field_t(KW_TRANS_POSITION, EACH, 1, ONCE, 21, 30, 'n2', 'i', D_NUMBER, 0, 'node 2'), &
   field_t(KW_TRANS_POSITION, EACH, 1, ONCE, 31, 40, 'n3', 'i', D_NUMBER, 0, 'node 3'), &
   field_t(KW_TRANS_POSITION, EACH, 1, ONCE, 41, 50, 'n4', 'i', D_NUMBER, 0, 'node 4'), &
   field_t(KW_TRANS_POSITION, EACH, 1, ONCE, 51, 60, 'n5', 'i', D_NUMBER, 0, 'node 5'), &
   field_t(KW_TRANS_POSITION, EACH, 1, ONCE, 61, 70, 'n6', 'i', D_NUMBER, 0, 'node 6'), &
   field_t(KW_TRANS_POSITION, EACH, 1, ONCE, 91, 100, 'submodel', 'i', D_NUMBER, 0, 'submodel whose nodes are moved'), &
   field_t(KW_TRANS_POSITION, EACH, 2, ONCE, 11, 30, 'X1', 'r', D_LENGTH, 0, 'point 1, x'), &
   field_t(KW_TRANS_POSITION, EACH, 2, ONCE, 31, 50, 'Y1', 'r', D_LENGTH, 0, 'point 1, y'), &
   field_t(KW_TRANS_POSITION, EACH, 2, ONCE, 51, 70, 'Z1', 'r', D_LENGTH, 0, 'point 1, z'), &
   field_t(KW_TRANS_POSITION, EACH, 3, ONCE, 11, 30, 'X2', 'r', D_LENGTH, 0, 'point 2, x'), &
   field_t(KW_TRANS_POSITION, EACH, 3, ONCE, 31, 50, 'Y2', 'r', D_LENGTH, 0, 'point 2, y'), &
   field_t(KW_TRANS_POSITION, EACH, 3, ONCE, 51, 70, 'Z2', 'r', D_LENGTH, 0, 'point 2, z'), &
   field_t(KW_TRANS_POSITION, EACH, 4, ONCE, 11, 30, 'X3', 'r', D_LENGTH, 0, 'point 3, x'), &
   field_t(KW_TRANS_POSITION, EACH, 4, ONCE, 31, 50, 'Y3', 'r', D_LENGTH, 0, 'point 3, y'), &
   field_t(KW_TRANS_POSITION, EACH, 4, ONCE, 51, 70, 'Z3', 'r', D_LENGTH, 0, 'point 3, z'), &
   field_t(KW_TRANS_POSITION, EACH, 5, ONCE, 11, 30, 'X4', 'r', D_LENGTH, 0, 'point 4, x'), &
   field_t(KW_TRANS_POSITION, EACH, 5, ONCE, 31, 50, 'Y4', 'r', D_LENGTH, 0, 'point 4, y'), &
   field_t(KW_TRANS_POSITION, EACH, 5, ONCE, 51, 70, 'Z4', 'r', D_LENGTH, 0, 'point 4, z'), &
   field_t(KW_TRANS_POSITION, EACH, 6, ONCE, 11, 30, 'X5', 'r', D_LENGTH, 0, 'point 5, x'), &
   field_t(KW_TRANS_POSITION, EACH, 6, ONCE, 31, 50, 'Y5', 'r', D_LENGTH, 0, 'point 5, y'), &
   field_t(KW_TRANS_POSITION, EACH, 6, ONCE, 51, 70, 'Z5', 'r', D_LENGTH, 0, 'point 5, z'), &
   field_t(KW_TRANS_POSITION, EACH, 7, ONCE, 11, 30, 'X6', 'r', D_LENGTH, 0, 'point 6, x'), &
   field_t(KW_TRANS_POSITION, EACH, 7, ONCE, 31, 50, 'Y6', 'r', D_LENGTH, 0, 'point 6, y'), &
   field_t(KW_TRANS_POSITION, EACH, 7, ONCE, 51, 70, 'Z6', 'r', D_LENGTH, 0, 'point 6, z'), &
   field_t(KW_ADMAS, 0, 1, ONCE, 1, 20, 'mass', 'r', D_MASS, 0, 'mass on each node'), &
   field_t(KW_ADMAS, 0, 1, ONCE, 21, 30, 'grnod_id', 'i', D_NUMBER, 0, 'group of nodes'), &
   field_t(KW_ADMAS, 1, 1, ONCE, 1, 20, 'mass', 'r', D_MASS, 0, 'mass shared by the nodes'), &
   field_t(KW_ADMAS, 1, 1, ONCE, 21, 30, 'grnod_id', 'i', D_NUMBER, 0, 'group of nodes'), &
   field_t(KW_ADMAS, 2, 1, ONCE, 1, 20, 'mass', 'r', D_AREA_DENSITY, 0, 'mass per unit of area'), &
   field_t(KW_ADMAS, 2, 1, ONCE, 21, 30, 'surf_id', 'i', D_NUMBER, 0, 'surface'), &
   field_t(KW_ADMAS, 3, 1, ONCE, 1, 20, 'mass', 'r', D_MASS, 0, 'mass added'), &
   field_t(KW_ADMAS, 3, 1, ONCE, 21, 30, 'grpart_id', 'i', D_NUMBER, 0, 'group of parts'), &
   field_t(KW_ADMAS, 4, 1, ONCE, 1, 20, 'mass', 'r', D_MASS, 0, 'mass in the end'), &
   field_t(KW_ADMAS, 4, 1, ONCE, 21, 30, 'grpart_id', 'i', D_NUMBER, 0, 'group of parts'), &
   field_t(KW_ADMAS, 4, 1, ONCE, 31, 40, 'Iflag', 'i', D_NUMBER, 0, 'rule of sharing'), &
   field_t(KW_ADMAS, 5, 1, ROWS, 1, 20, 'mass', 'r', D_MASS, 0, 'mass'), &
   field_t(KW_ADMAS, 5, 1, ROWS, 21, 30, 'node_id', 'i', D_NUMBER, 0, 'node'), &
   field_t(KW_ADMAS, 6, 1, ROWS, 1, 20, 'mass', 'r', D_MASS, 0, 'mass added'), &
   field_t(KW_ADMAS, 6, 1, ROWS, 21, 30, 'part_id', 'i', D_NUMBER, 0, 'part'), &
   field_t(KW_ADMAS, 7, 1, ROWS, 1, 20, 'mass', 'r', D_MASS, 0, 'mass in the end'), &
   field_t(KW_ADMAS, 7, 1, ROWS, 21, 30, 'part_id', 'i', D_NUMBER, 0, 'part'), &
   field_t(KW_ADMAS, 7, 1, ROWS, 31, 40, 'Iflag', 'i', D_NUMBER, 0, 'rule of sharing')]

end module kj_full_fields
