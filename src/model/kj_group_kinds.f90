!> THE table of what the ids of a /GRNOD and of the clauses of a /SET stand for.
module kj_group_kinds
   use kj_error, only: SEV_ERROR, SEV_WARNING
   use kj_keywords, only: KW_GRBEAM, KW_GRBRIC, KW_GRNOD_BOX, KW_GRNOD_GENE, KW_GRNOD_GEN_INCR, &
      KW_GRNOD_GRBEAM, KW_GRNOD_GRBRIC, KW_GRNOD_GRNOD, KW_GRNOD_GRSH3N, KW_GRNOD_GRSHEL, &
      KW_GRNOD_GRSPRI, KW_GRNOD_GRTRUS, KW_GRNOD_LINE, KW_GRNOD_MAT, KW_GRNOD_NODE, &
      KW_GRNOD_NODENS, KW_GRNOD_PART, KW_GRNOD_PROP, KW_GRNOD_SUBMODEL, KW_GRNOD_SUBSET, &
      KW_GRNOD_SURF, KW_GRSH3N, KW_GRSHEL, KW_GRSPRI, KW_GRTRUS
   implicit none
   private

   !> What an id stands for
   integer, parameter, public :: A_NODE = 1, A_PART = 2, AN_ELEMENT = 3, A_BOX = 4, A_GROUP = 5, &
      AN_ELEMENT_GROUP = 6, A_SURFACE = 7, A_LINE = 8, A_SUBMODEL = 9, A_BODY = 10, &
      A_SEGMENT = 11, ALL_NODES = 12

   !> A kind of group, or a clause of a set
   type, public :: kind_t
      integer           :: keyword    !! KW_ constant, 0 = a clause alone
      character(len=6)  :: clause     !! of a /SET, '' = none
      integer           :: of         !! A_ constant
      integer           :: together   !! ids that belong together: 1, 2 first and last, 3 increment
      integer           :: which      !! KW_ constant of the groups of these elements
      character(len=13) :: what       !! an id names: node, part, subset, ...
      character(len=7)  :: missing    !! message on an id that is not defined
      integer           :: severity   !! of it
   end type kind_t

   type(kind_t), parameter, public :: kinds(*) = [ &
      kind_t(KW_GRNOD_NODE,     'NODE',   A_NODE,     1, 0,         'node',       'KJ-0078', SEV_ERROR),   &
      kind_t(KW_GRNOD_NODENS,   '',       A_NODE,     1, 0,         'node',       'KJ-0078', SEV_ERROR),   &
      kind_t(KW_GRNOD_GENE,     '',       A_NODE,     2, 0,         'node',       '',        SEV_ERROR),   &
      kind_t(KW_GRNOD_GEN_INCR, '',       A_NODE,     3, 0,         'node',       '',        SEV_ERROR),   &
      kind_t(KW_GRNOD_PART,     'PART',   A_PART,     1, 0,         'part',       'KJ-0194', SEV_WARNING), &
      kind_t(KW_GRNOD_SUBSET,   'SUBS',   A_PART,     1, 0,         'subset',     'KJ-0194', SEV_WARNING), &
      kind_t(KW_GRNOD_MAT,      'MAT',    A_PART,     1, 0,         'material',   'KJ-0194', SEV_WARNING), &
      kind_t(KW_GRNOD_PROP,     'PROP',   A_PART,     1, 0,         'property',   'KJ-0194', SEV_WARNING), &
      kind_t(KW_GRNOD_SUBMODEL, 'SUBM',   A_SUBMODEL, 1, 0,         'submodel',   'KJ-0194', SEV_WARNING), &
      kind_t(0,                 'SPRING', AN_ELEMENT, 1, KW_GRSPRI, 'element',    'KJ-9140', SEV_WARNING), &
      kind_t(0,                 'SHELL',  AN_ELEMENT, 1, KW_GRSHEL, 'element',    'KJ-9140', SEV_WARNING), &
      kind_t(0,                 'SH3N',   AN_ELEMENT, 1, KW_GRSH3N, 'element',    'KJ-9140', SEV_WARNING), &
      kind_t(0,                 'SOLID',  AN_ELEMENT, 1, KW_GRBRIC, 'element',    'KJ-9140', SEV_WARNING), &
      kind_t(0,                 'BEAM',   AN_ELEMENT, 1, KW_GRBEAM, 'element',    'KJ-9140', SEV_WARNING), &
      kind_t(0,                 'TRUSS',  AN_ELEMENT, 1, KW_GRTRUS, 'element',    'KJ-9140', SEV_WARNING), &
      kind_t(KW_GRNOD_BOX,      'BOX',    A_BOX,      1, 0,         'box',        'KJ-9135', SEV_WARNING), &
      kind_t(KW_GRNOD_GRNOD,    'SET',    A_GROUP,    1, 0,         'node group', 'KJ-0174', SEV_WARNING), &
      kind_t(0,                 'SETCOL', A_GROUP,    1, 0,         'node group', 'KJ-0174', SEV_WARNING), &
      kind_t(0,                 'RBODY',  A_BODY,     1, 0,         'rigid body', 'KJ-9408', SEV_WARNING), &
      kind_t(0,                 'SEG',    A_SEGMENT,  1, 0,         'node',       'KJ-0078', SEV_ERROR),   &
      kind_t(0,                 'ALL',    ALL_NODES,  1, 0,         'node',       '',        SEV_WARNING), &
      kind_t(KW_GRNOD_GRSHEL,   '',       AN_ELEMENT_GROUP, 1, KW_GRSHEL, 'element group', 'KJ-9408', SEV_WARNING), &
      kind_t(KW_GRNOD_GRSH3N,   '',       AN_ELEMENT_GROUP, 1, KW_GRSH3N, 'element group', 'KJ-9408', SEV_WARNING), &
      kind_t(KW_GRNOD_GRBRIC,   '',       AN_ELEMENT_GROUP, 1, KW_GRBRIC, 'element group', 'KJ-9408', SEV_WARNING), &
      kind_t(KW_GRNOD_GRBEAM,   '',       AN_ELEMENT_GROUP, 1, KW_GRBEAM, 'element group', 'KJ-9408', SEV_WARNING), &
      kind_t(KW_GRNOD_GRTRUS,   '',       AN_ELEMENT_GROUP, 1, KW_GRTRUS, 'element group', 'KJ-9408', SEV_WARNING), &
      kind_t(KW_GRNOD_GRSPRI,   '',       AN_ELEMENT_GROUP, 1, KW_GRSPRI, 'element group', 'KJ-9408', SEV_WARNING), &
      kind_t(KW_GRNOD_SURF,     '',       A_SURFACE,  1, 0,         'surface',    'KJ-9408', SEV_WARNING), &
      kind_t(KW_GRNOD_LINE,     '',       A_LINE,     1, 0,         'line',       'KJ-9408', SEV_WARNING)]

end module kj_group_kinds
