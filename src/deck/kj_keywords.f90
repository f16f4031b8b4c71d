!> THE table of keywords of the starter deck: how each is written, what its header holds and
!> whether kjoint reads it. The cards of the keywords stand in kj_card_fields.
module kj_keywords
   use kj_spelling, only: upper, edit_distance
   implicit none
   private

   public :: keyword_t, find_keyword, keyword_row, nearest_keyword

   !> Keywords with cards of their own (or without cards but with a meaning of their own)
   integer, parameter, public :: &
      KW_BEGIN = 1, KW_TITLE = 2, KW_END = 3, KW_UNIT = 4, KW_NODE = 5, KW_CNODE = 6, KW_PART = 7, &
      KW_SUBSET = 8, KW_SPRING = 9, KW_KJOINT = 10, KW_KJOINT2 = 11, KW_SPRING4 = 12, &
      KW_SPRING8 = 13, KW_MAT_VOID = 14, KW_RBODY = 15, KW_GRNOD_NODE = 16, KW_GRNOD_NODENS = 17, &
      KW_GRNOD_GRNOD = 18, KW_GRNOD_GENE = 19, KW_GRNOD_GEN_INCR = 20, KW_GRNOD_PART = 21, &
      KW_GRNOD_BOX = 22, KW_BOX_RECTA = 23, KW_BOX_SPHER = 24, KW_BOX_CYLIN = 25, &
      KW_SET_GENERAL = 26, KW_SKEW_FIX = 27, KW_SKEW_MOV = 28, KW_SKEW_MOV2 = 29, &
      KW_FRAME_FIX = 30, KW_FRAME_MOV = 31, KW_FRAME_MOV2 = 32, KW_FRAME_NOD = 33, KW_FUNCT = 34, &
      KW_MOVE_FUNCT = 35, KW_BCS = 36, KW_GRAV = 37, KW_CLOAD = 38, KW_IMPVEL = 39, &
      KW_IMPDISP = 40, KW_IMPACC = 41, KW_INIVEL_TRA = 42, KW_INIVEL_ROT = 43, &
      KW_INIVEL_TG = 44, KW_INIVEL_AXIS = 45, KW_ADMAS = 46, KW_SENSOR_TIME = 47, &
      KW_TH_NODE = 48, KW_TH_SPRING = 49, KW_TH_RBODY = 50, KW_TH_PART = 51, KW_ANALY = 52, &
      KW_SPMD = 53, KW_IOFLAG = 54, KW_DEF_SOLID = 55, KW_DEF_SHELL = 56, KW_RANDOM = 57
   integer, parameter, public :: KW_OTHER = 58      !! all keywords that only have a status
   integer, parameter, public :: N_KEYWORD = 58     !! largest KW_ constant

   !> Status of a keyword
   integer, parameter, public :: &
      READ_IT = 1, &     !! its cards are read
      NOTE_IT = 2, &     !! only output, or numerics of other solvers: accepted with a note
      OUT_OF_SCOPE = 3   !! would change the result: an error that says what would be needed

   !> Order of the numbers in a header after the words
   integer, parameter, public :: &
      HEAD_ID = 1, &         !! /KEY/id/unit
      HEAD_UNIT = 2, &       !! /KEY/unit
      HEAD_TYPE_ID = 3, &    !! /KEY/type/id/unit
      HEAD_NONE = 4          !! no number, or numbers without a meaning here

   !> A row; names of NOTE_IT and OUT_OF_SCOPE rows stand for all headers that begin with them
   type :: keyword_t
      integer           :: id        !! KW_ constant; rows with one id are other names
      character(len=16) :: name      !! as written in a deck, without the numbers
      logical           :: titled    !! a title card follows the header
      integer           :: status    !! READ_IT, NOTE_IT or OUT_OF_SCOPE
      integer           :: head      !! HEAD_ constant
      character(len=56) :: meaning   !! OUT_OF_SCOPE: what would be needed
   end type keyword_t

   integer, parameter :: HI = HEAD_ID, HU = HEAD_UNIT, HT = HEAD_TYPE_ID, HN = HEAD_NONE
   logical, parameter :: T = .true., F = .false.

   type(keyword_t), parameter, public :: keywords(*) = [ &
      keyword_t(KW_BEGIN,          '/BEGIN',           T, READ_IT, HN, 'format version, input units and work units'), &
      keyword_t(KW_TITLE,          '/TITLE',           T, READ_IT, HN, 'title of the model'), &
      keyword_t(KW_END,            '/END',             F, READ_IT, HN, 'end of the deck'), &
      keyword_t(KW_UNIT,           '/UNIT',            T, READ_IT, HI, 'units of the blocks that name this id'), &
      keyword_t(KW_OTHER,          '/UNIT/MASS',       T, OUT_OF_SCOPE, HI, 'units one by one: use /UNIT with three units'), &
      keyword_t(KW_OTHER,          '/UNIT/LENGTH',     T, OUT_OF_SCOPE, HI, 'units one by one: use /UNIT with three units'), &
      keyword_t(KW_OTHER,          '/UNIT/TIME',       T, OUT_OF_SCOPE, HI, 'units one by one: use /UNIT with three units'), &
      keyword_t(KW_NODE,           '/NODE',            F, READ_IT, HU, 'nodes: id and coordinates'), &
      keyword_t(KW_CNODE,          '/CNODE',           F, OUT_OF_SCOPE, HN, 'merging of nodes: use /NODE'), &
      keyword_t(KW_PART,           '/PART',            T, READ_IT, HI, 'elements of one property and material'), &
      keyword_t(KW_SUBSET,         '/SUBSET',          T, NOTE_IT, HI, 'set of parts, for output only'), &
      keyword_t(KW_SPRING,         '/SPRING',          F, READ_IT, HI, 'springs and joints of a part: id and nodes'), &
      keyword_t(KW_KJOINT,         '/PROP/TYPE33',     T, READ_IT, HI, 'kinematic joint'), &
      keyword_t(KW_KJOINT,         '/PROP/KJOINT',     T, READ_IT, HI, 'kinematic joint, same as /PROP/TYPE33'), &
      keyword_t(KW_KJOINT2,        '/PROP/TYPE45',     T, READ_IT, HI, 'kinematic joint with stops and friction'), &
      keyword_t(KW_KJOINT2,        '/PROP/KJOINT2',    T, READ_IT, HI, 'kinematic joint, same as /PROP/TYPE45'), &
      keyword_t(KW_SPRING4,        '/PROP/TYPE4',      T, READ_IT, HI, 'spring along the line of its two nodes'), &
      keyword_t(KW_SPRING4,        '/PROP/SPRING',     T, READ_IT, HI, 'spring, same as /PROP/TYPE4'), &
      keyword_t(KW_SPRING8,        '/PROP/TYPE8',      T, READ_IT, HI, 'spring with six laws in the axes of a skew'), &
      keyword_t(KW_SPRING8,        '/PROP/SPR_GENE',   T, READ_IT, HI, 'spring, same as /PROP/TYPE8'), &
      keyword_t(KW_OTHER,          '/PROP',            T, OUT_OF_SCOPE, HI, 'elements of another kind than springs and joints'), &
      keyword_t(KW_MAT_VOID,       '/MAT/VOID',        T, READ_IT, HI, 'material without stiffness'), &
      keyword_t(KW_MAT_VOID,       '/MAT/LAW0',        T, READ_IT, HI, 'material without stiffness, same as /MAT/VOID'), &
      keyword_t(KW_OTHER,          '/MAT',             T, OUT_OF_SCOPE, HI, 'deformable elements; springs and joints need none'), &
      keyword_t(KW_RBODY,          '/RBODY',           T, READ_IT, HI, 'rigid body: main node, mass, inertia, group'), &
      keyword_t(KW_GRNOD_NODE,     '/GRNOD/NODE',      T, READ_IT, HI, 'node group: ids'), &
      keyword_t(KW_GRNOD_NODENS,   '/GRNOD/NODENS',    T, READ_IT, HI, 'node group: ids, order kept'), &
      keyword_t(KW_GRNOD_GRNOD,    '/GRNOD/GRNOD',     T, READ_IT, HI, 'node group: ids of groups, negative ones removed'), &
      keyword_t(KW_GRNOD_GENE,     '/GRNOD/GENE',      T, READ_IT, HI, 'node group: ranges of ids, first and last'), &
      keyword_t(KW_GRNOD_GEN_INCR, '/GRNOD/GEN_INCR',  T, READ_IT, HI, 'node group: ranges of ids, first, last, increment'), &
      keyword_t(KW_GRNOD_PART,     '/GRNOD/PART',      T, READ_IT, HI, 'node group: nodes of the elements of parts'), &
      keyword_t(KW_GRNOD_BOX,      '/GRNOD/BOX',       T, READ_IT, HI, 'node group: nodes inside of boxes'), &
      keyword_t(KW_OTHER,          '/GRNOD',           T, OUT_OF_SCOPE, HI, 'another way to choose nodes: list them instead'), &
      keyword_t(KW_BOX_RECTA,      '/BOX/RECTA',       T, READ_IT, HI, 'box by two corners'), &
      keyword_t(KW_BOX_SPHER,      '/BOX/SPHER',       T, OUT_OF_SCOPE, HI, 'round boxes: use /BOX/RECTA or a list of nodes'), &
      keyword_t(KW_BOX_CYLIN,      '/BOX/CYLIN',       T, OUT_OF_SCOPE, HI, 'round boxes: use /BOX/RECTA or a list of nodes'), &
      keyword_t(KW_OTHER,          '/BOX',             T, OUT_OF_SCOPE, HI, 'sets of boxes: list the boxes in /GRNOD/BOX'), &
      keyword_t(KW_SET_GENERAL,    '/SET/GENERAL',     T, READ_IT, HI, 'set of nodes by clauses'), &
      keyword_t(KW_OTHER,          '/SET',             T, OUT_OF_SCOPE, HI, 'sets over several blocks: use /SET/GENERAL'), &
      keyword_t(KW_SKEW_FIX,       '/SKEW/FIX',        T, READ_IT, HI, 'axes fixed in space'), &
      keyword_t(KW_SKEW_MOV,       '/SKEW/MOV',        T, READ_IT, HI, 'axes that follow three nodes'), &
      keyword_t(KW_SKEW_MOV2,      '/SKEW/MOV2',       T, READ_IT, HI, 'axes that follow three nodes, z first'), &
      keyword_t(KW_OTHER,          '/SKEW',            T, OUT_OF_SCOPE, HI, 'skews of another kind than FIX, MOV and MOV2'), &
      keyword_t(KW_FRAME_FIX,      '/FRAME/FIX',       T, READ_IT, HI, 'frame fixed in space'), &
      keyword_t(KW_FRAME_MOV,      '/FRAME/MOV',       T, READ_IT, HI, 'frame that follows three nodes'), &
      keyword_t(KW_FRAME_MOV2,     '/FRAME/MOV2',      T, READ_IT, HI, 'frame that follows three nodes, z first'), &
      keyword_t(KW_FRAME_NOD,      '/FRAME/NOD',       T, READ_IT, HI, 'frame that follows one node'), &
      keyword_t(KW_OTHER,          '/FRAME',           T, OUT_OF_SCOPE, HI, 'frames of another kind than FIX, MOV, MOV2 and NOD'), &
      keyword_t(KW_FUNCT,          '/FUNCT',           T, READ_IT, HI, 'function by points'), &
      keyword_t(KW_OTHER,          '/FUNCT_SMOOTH',    T, OUT_OF_SCOPE, HI, 'smooth interpolation: use /FUNCT with more points'), &
      keyword_t(KW_MOVE_FUNCT,     '/MOVE_FUNCT',      T, READ_IT, HI, 'scales and shifts a function'), &
      keyword_t(KW_BCS,            '/BCS',             T, READ_IT, HI, 'blocked directions of nodes'), &
      keyword_t(KW_GRAV,           '/GRAV',            T, READ_IT, HI, 'gravity'), &
      keyword_t(KW_CLOAD,          '/CLOAD',           T, READ_IT, HI, 'force or moment on nodes'), &
      keyword_t(KW_IMPVEL,         '/IMPVEL',          T, READ_IT, HI, 'imposed velocity'), &
      keyword_t(KW_OTHER,          '/IMPVEL/LAGMUL',   T, OUT_OF_SCOPE, HI, 'Lagrange multipliers: use /IMPVEL'), &
      keyword_t(KW_OTHER,          '/IMPVEL/FGEO',     T, OUT_OF_SCOPE, HI, 'motion to a final geometry'), &
      keyword_t(KW_IMPDISP,        '/IMPDISP',         T, READ_IT, HI, 'imposed displacement'), &
      keyword_t(KW_OTHER,          '/IMPDISP/FGEO',    T, OUT_OF_SCOPE, HI, 'motion to a final geometry'), &
      keyword_t(KW_IMPACC,         '/IMPACC',          T, READ_IT, HI, 'imposed acceleration'), &
      keyword_t(KW_INIVEL_TRA,     '/INIVEL/TRA',      T, READ_IT, HI, 'initial velocity'), &
      keyword_t(KW_INIVEL_ROT,     '/INIVEL/ROT',      T, READ_IT, HI, 'initial angular velocity'), &
      keyword_t(KW_INIVEL_TG,      '/INIVEL/T+G',      T, READ_IT, HI, 'initial velocity of nodes and grid'), &
      keyword_t(KW_INIVEL_AXIS,    '/INIVEL/AXIS',     T, READ_IT, HI, 'initial velocity about an axis'), &
      keyword_t(KW_OTHER,          '/INIVEL/GRID',     T, NOTE_IT, HI, 'grid velocity of fluids'), &
      keyword_t(KW_OTHER,          '/INIVEL',          T, OUT_OF_SCOPE, HI, 'initial velocity of another kind'), &
      keyword_t(KW_ADMAS,          '/ADMAS',           T, READ_IT, HT, 'masses on nodes'), &
      keyword_t(KW_SENSOR_TIME,    '/SENSOR/TIME',     T, READ_IT, HI, 'sensor of time'), &
      keyword_t(KW_OTHER,          '/SENSOR',          T, OUT_OF_SCOPE, HI, 'sensors of other things than time'), &
      keyword_t(KW_TH_NODE,        '/TH/NODE',         T, READ_IT, HI, 'history of nodes'), &
      keyword_t(KW_TH_SPRING,      '/TH/SPRING',       T, READ_IT, HI, 'history of springs and joints'), &
      keyword_t(KW_TH_RBODY,       '/TH/RBODY',        T, READ_IT, HI, 'history of rigid bodies'), &
      keyword_t(KW_TH_PART,        '/TH/PART',         T, READ_IT, HI, 'history of parts'), &
      keyword_t(KW_OTHER,          '/TH',              T, NOTE_IT, HI, 'history of other things: not written'), &
      keyword_t(KW_OTHER,          '/ATH',             T, NOTE_IT, HI, 'history in a file A: not written'), &
      keyword_t(KW_OTHER,          '/BTH',             T, NOTE_IT, HI, 'history in a file B: not written'), &
      keyword_t(KW_OTHER,          '/CTH',             T, NOTE_IT, HI, 'history in a file C: not written'), &
      keyword_t(KW_OTHER,          '/DTH',             T, NOTE_IT, HI, 'history in a file D: not written'), &
      keyword_t(KW_OTHER,          '/ETH',             T, NOTE_IT, HI, 'history in a file E: not written'), &
      keyword_t(KW_OTHER,          '/FTH',             T, NOTE_IT, HI, 'history in a file F: not written'), &
      keyword_t(KW_OTHER,          '/GTH',             T, NOTE_IT, HI, 'history in a file G: not written'), &
      keyword_t(KW_OTHER,          '/HTH',             T, NOTE_IT, HI, 'history in a file H: not written'), &
      keyword_t(KW_OTHER,          '/ITH',             T, NOTE_IT, HI, 'history in a file I: not written'), &
      keyword_t(KW_ANALY,          '/ANALY',           F, READ_IT, HN, 'kind of analysis: must be 3D'), &
      keyword_t(KW_SPMD,           '/SPMD',            F, NOTE_IT, HN, 'parallel run of other solvers'), &
      keyword_t(KW_IOFLAG,         '/IOFLAG',          F, NOTE_IT, HN, 'listing of other solvers'), &
      keyword_t(KW_DEF_SOLID,      '/DEF_SOLID',       F, NOTE_IT, HN, 'defaults of solid elements'), &
      keyword_t(KW_DEF_SHELL,      '/DEF_SHELL',       F, NOTE_IT, HN, 'defaults of shell elements'), &
      keyword_t(KW_OTHER,          '/DEFAULT',         F, NOTE_IT, HN, 'defaults of contacts and elements'), &
      keyword_t(KW_RANDOM,         '/RANDOM',          F, READ_IT, HN, 'disturbs coordinates: must be 0'), &
      keyword_t(KW_RANDOM,         '/RANDOM/GRNOD',    F, READ_IT, HI, 'disturbs coordinates of a group: must be 0'), &
      keyword_t(KW_OTHER,          '/GRPART',          T, NOTE_IT, HI, 'group of parts, used by nothing in scope'), &
      keyword_t(KW_OTHER,          '/GRSPRI',          T, NOTE_IT, HI, 'group of springs, used by nothing in scope'), &
      keyword_t(KW_OTHER,          '/GRSHEL',          T, NOTE_IT, HI, 'group of shells, used by nothing in scope'), &
      keyword_t(KW_OTHER,          '/GRBRIC',          T, NOTE_IT, HI, 'group of solids, used by nothing in scope'), &
      keyword_t(KW_OTHER,          '/SURF',            T, NOTE_IT, HI, 'surface, used by nothing in scope'), &
      keyword_t(KW_OTHER,          '/LINE',            T, NOTE_IT, HI, 'line, used by nothing in scope'), &
      keyword_t(KW_OTHER,          '/ANIM',            F, NOTE_IT, HN, 'animation files: not written'), &
      keyword_t(KW_OTHER,          '/PARAMETER',       T, OUT_OF_SCOPE, HI, 'parameters: write the numbers into the cards'), &
      keyword_t(KW_OTHER,          '//SUBMODEL',       T, OUT_OF_SCOPE, HI, 'submodels: put their blocks into the deck'), &
      keyword_t(KW_OTHER,          '//ENDSUB',         F, OUT_OF_SCOPE, HN, 'submodels: put their blocks into the deck'), &
      keyword_t(KW_OTHER,          '/MERGE',           T, OUT_OF_SCOPE, HI, 'merging of bodies: make them one /RBODY'), &
      keyword_t(KW_OTHER,          '/DAMP',            T, OUT_OF_SCOPE, HI, 'Rayleigh damping'), &
      keyword_t(KW_OTHER,          '/BRICK',           F, OUT_OF_SCOPE, HI, 'solid elements'), &
      keyword_t(KW_OTHER,          '/TETRA4',          F, OUT_OF_SCOPE, HI, 'solid elements'), &
      keyword_t(KW_OTHER,          '/TETRA10',         F, OUT_OF_SCOPE, HI, 'solid elements'), &
      keyword_t(KW_OTHER,          '/SHELL',           F, OUT_OF_SCOPE, HI, 'shell elements'), &
      keyword_t(KW_OTHER,          '/SH3N',            F, OUT_OF_SCOPE, HI, 'shell elements'), &
      keyword_t(KW_OTHER,          '/QUAD',            F, OUT_OF_SCOPE, HI, 'plane elements'), &
      keyword_t(KW_OTHER,          '/BEAM',            F, OUT_OF_SCOPE, HI, 'beam elements'), &
      keyword_t(KW_OTHER,          '/TRUSS',           F, OUT_OF_SCOPE, HI, 'truss elements'), &
      keyword_t(KW_OTHER,          '/INTER',           T, OUT_OF_SCOPE, HI, 'contact'), &
      keyword_t(KW_OTHER,          '/FRICTION',        T, OUT_OF_SCOPE, HI, 'contact'), &
      keyword_t(KW_OTHER,          '/RWALL',           T, OUT_OF_SCOPE, HI, 'rigid walls'), &
      keyword_t(KW_OTHER,          '/RLINK',           T, OUT_OF_SCOPE, HI, 'rigid links: use a rigid joint or /RBODY'), &
      keyword_t(KW_OTHER,          '/RBE2',            T, OUT_OF_SCOPE, HI, 'RBE2: use /RBODY'), &
      keyword_t(KW_OTHER,          '/RBE3',            T, OUT_OF_SCOPE, HI, 'interpolation constraints'), &
      keyword_t(KW_OTHER,          '/MPC',             T, OUT_OF_SCOPE, HI, 'linear constraints'), &
      keyword_t(KW_OTHER,          '/CYL_JOINT',       T, OUT_OF_SCOPE, HI, 'cylindrical constraint: use /PROP/KJOINT type 3'), &
      keyword_t(KW_OTHER,          '/GJOINT',          T, OUT_OF_SCOPE, HI, 'gear joints'), &
      keyword_t(KW_OTHER,          '/PLOAD',           T, OUT_OF_SCOPE, HI, 'pressure on surfaces'), &
      keyword_t(KW_OTHER,          '/LOAD',            T, OUT_OF_SCOPE, HI, 'loads on surfaces, centrifugal loads'), &
      keyword_t(KW_OTHER,          '/MONVOL',          T, OUT_OF_SCOPE, HI, 'airbags'), &
      keyword_t(KW_OTHER,          '/FXBODY',          T, OUT_OF_SCOPE, HI, 'flexible bodies'), &
      keyword_t(KW_OTHER,          '/FAIL',            T, OUT_OF_SCOPE, HI, 'failure of materials'), &
      keyword_t(KW_OTHER,          '/ACTIV',           T, OUT_OF_SCOPE, HI, 'switching of elements'), &
      keyword_t(KW_OTHER,          '/ALE',             F, OUT_OF_SCOPE, HN, 'fluids'), &
      keyword_t(KW_OTHER,          '/ACCEL',           T, NOTE_IT, HI, 'accelerometer, for output only'), &
      keyword_t(KW_OTHER,          '/SECT',            T, NOTE_IT, HI, 'section, for output only'), &
      keyword_t(KW_OTHER,          '/GAUGE',           T, NOTE_IT, HI, 'gauge, for output only'), &
      keyword_t(KW_OTHER,          '/STATE',           F, NOTE_IT, HN, 'state file: not written')]

contains

   !> Row that a header path belongs to; 0 when there is none
   !>
   !> NOTE_IT and OUT_OF_SCOPE rows also answer for longer paths: /INTER for /INTER/TYPE7.
   pure integer function find_keyword(path) result(row)
      character(len=*), intent(in) :: path      !! words of the header: /PROP/TYPE33

      integer :: n

      row = exact_row(path)
      n = len(path)
      do while (row == 0)
         n = index(path(:n), '/', back=.true.) - 1
         if (n < 2) return
         row = exact_row(path(:n))
         if (row == 0) cycle
         if (keywords(row)%status == READ_IT) row = 0
      end do
   end function find_keyword

   !> Row with exactly this name; 0 when there is none
   pure integer function exact_row(path) result(row)
      character(len=*), intent(in) :: path

      integer, parameter :: width(size(keywords)) = len_trim(keywords%name)

      do row = 1, size(keywords)
         if (width(row) /= len(path)) cycle
         if (keywords(row)%name(:width(row)) == path) return
      end do
      row = 0
   end function exact_row

   !> First row of a keyword: its name and meaning
   pure integer function keyword_row(id) result(row)
      integer, intent(in) :: id                 !! KW_ constant

      do row = 1, size(keywords)
         if (keywords(row)%id == id) return
      end do
      row = 0
   end function keyword_row

   !> The keyword a wrong header may stand for: '' when nothing is near
   pure function nearest_keyword(path) result(name)
      character(len=*), intent(in) :: path
      character(len=len(keywords%name)) :: name

      integer :: row, distance, best

      name = ''
      best = 1 + min(3, len(path)/3)
      do row = 1, size(keywords)
         distance = edit_distance(upper(path), trim(keywords(row)%name))
         if (distance >= best) cycle
         best = distance
         name = keywords(row)%name
      end do
   end function nearest_keyword

end module kj_keywords
