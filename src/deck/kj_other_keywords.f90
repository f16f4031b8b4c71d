!> Keywords of Radioss whose cards are not read: what they are about, and whether a mechanism would
!> move otherwise with them. They make the end of THE table, kj_keywords; here is also its type.
module kj_other_keywords
   implicit none
   private

   !> Status of a keyword
   integer, parameter, public :: &
      READ_IT = 1, &     !! its cards are read
      NOTE_IT = 2, &     !! only output, other solvers, or things that no joint meets: a note
      OUT_OF_SCOPE = 3, & !! would change the result: an error that says what would be needed
      FULL_ONLY = 4, &   !! as OUT_OF_SCOPE, but its cards are read where a mechanism is taken out
      ASIDE = 5          !! read by those who need it: structure, selections, defaults

   !> Order of the numbers in a header after the words
   integer, parameter, public :: &
      HEAD_ID = 1, &         !! /KEY/id/unit
      HEAD_UNIT = 2, &       !! /KEY/unit
      HEAD_TYPE_ID = 3, &    !! /KEY/type/id/unit
      HEAD_NONE = 4          !! no number, or numbers without a meaning here

   !> A row; names of all but READ_IT rows stand for all headers that begin with them
   type, public :: keyword_t
      character(len=20) :: name      !! as written in a deck, without the numbers
      logical           :: titled    !! a title card follows the header
      integer           :: status    !! READ_IT, NOTE_IT, ...
      integer           :: head      !! HEAD_ constant
      character(len=56) :: meaning   !! OUT_OF_SCOPE: what would be needed
   end type keyword_t

   integer, parameter :: HI = HEAD_ID, HN = HEAD_NONE
   logical, parameter :: T = .true., F = .false.

   type(keyword_t), parameter, public :: other_keywords(*) = [ &
      ! springs and joints of other kinds
      keyword_t('/PROP/TYPE12',     T, OUT_OF_SCOPE, HI, 'pulley springs'), &
      keyword_t('/PROP/SPR_PUL',    T, OUT_OF_SCOPE, HI, 'pulley springs'), &
      keyword_t('/PROP/TYPE23',     T, OUT_OF_SCOPE, HI, 'springs with a material'), &
      keyword_t('/PROP/SPR_MAT',    T, OUT_OF_SCOPE, HI, 'springs with a material'), &
      keyword_t('/PROP/TYPE25',     T, OUT_OF_SCOPE, HI, 'axisymmetric springs'), &
      keyword_t('/PROP/SPR_AXI',    T, OUT_OF_SCOPE, HI, 'axisymmetric springs'), &
      keyword_t('/PROP/TYPE26',     T, OUT_OF_SCOPE, HI, 'springs by tables of the rate'), &
      keyword_t('/PROP/SPR_TAB',    T, OUT_OF_SCOPE, HI, 'springs by tables of the rate'), &
      keyword_t('/PROP/TYPE27',     T, OUT_OF_SCOPE, HI, 'damped springs that may bear compression alone'), &
      keyword_t('/PROP/SPR_BDAMP',  T, OUT_OF_SCOPE, HI, 'damped springs that may bear compression alone'), &
      keyword_t('/PROP/TYPE28',     T, OUT_OF_SCOPE, HI, 'strands of many nodes'), &
      keyword_t('/PROP/NSTRAND',    T, OUT_OF_SCOPE, HI, 'strands of many nodes'), &
      keyword_t('/PROP/TYPE32',     T, OUT_OF_SCOPE, HI, 'pretensioner springs'), &
      keyword_t('/PROP/SPR_PRE',    T, OUT_OF_SCOPE, HI, 'pretensioner springs'), &
      keyword_t('/PROP/TYPE35',     T, OUT_OF_SCOPE, HI, 'stitch springs'), &
      keyword_t('/PROP/STITCH',     T, OUT_OF_SCOPE, HI, 'stitch springs'), &
      keyword_t('/PROP/TYPE36',     T, OUT_OF_SCOPE, HI, 'springs of predicted spot welds'), &
      keyword_t('/PROP/PREDIT',     T, OUT_OF_SCOPE, HI, 'springs of predicted spot welds'), &
      keyword_t('/PROP/TYPE44',     T, OUT_OF_SCOPE, HI, 'springs of crushable frames'), &
      keyword_t('/PROP/SPR_CRUS',   T, OUT_OF_SCOPE, HI, 'springs of crushable frames'), &
      keyword_t('/PROP/TYPE46',     T, OUT_OF_SCOPE, HI, 'springs of muscles'), &
      keyword_t('/PROP/SPR_MUSCLE', T, OUT_OF_SCOPE, HI, 'springs of muscles'), &
      keyword_t('/PROP/TYPE5',      T, OUT_OF_SCOPE, HI, 'rivets: use a rigid joint'), &
      keyword_t('/PROP/RIVET',      T, OUT_OF_SCOPE, HI, 'rivets: use a rigid joint'), &
      keyword_t('/SLIPRING',        T, OUT_OF_SCOPE, HI, 'slip rings of belts'), &
      keyword_t('/RETRACTOR',       T, OUT_OF_SCOPE, HI, 'retractors of belts'), &
      keyword_t('/INISPRI',         F, OUT_OF_SCOPE, HN, 'springs that start with a force'), &
      keyword_t('/PRELOAD',         T, OUT_OF_SCOPE, HI, 'bolts that are tightened'), &
      ! elements
      keyword_t('/PENTA6',         F, FULL_ONLY, HI, 'solid elements'), &
      keyword_t('/BRIC20',         F, FULL_ONLY, HI, 'solid elements'), &
      keyword_t('/SHEL16',         F, FULL_ONLY, HI, 'thick shell elements'), &
      keyword_t('/TRIA',            F, OUT_OF_SCOPE, HI, 'plane elements'), &
      keyword_t('/RIVET',           F, OUT_OF_SCOPE, HI, 'rivets: use a rigid joint'), &
      keyword_t('/SPHCEL',          F, OUT_OF_SCOPE, HI, 'particles'), &
      keyword_t('/XELEM',           F, OUT_OF_SCOPE, HI, 'elements of many nodes'), &
      ! conditions, loads and bodies of other kinds
      keyword_t('/BCS/CYCLIC',      T, OUT_OF_SCOPE, HI, 'cyclic symmetry'), &
      keyword_t('/BCS/LAGMUL',      T, OUT_OF_SCOPE, HI, 'Lagrange multipliers: use /BCS'), &
      keyword_t('/BCS/NRF',         T, OUT_OF_SCOPE, HI, 'boundaries without reflection'), &
      keyword_t('/BCS/WALL',        T, OUT_OF_SCOPE, HI, 'walls of fluids'), &
      keyword_t('/NBCS',            T, OUT_OF_SCOPE, HI, 'conditions node by node: use /BCS with a group'), &
      keyword_t('/RBODY/LAGMUL',    T, OUT_OF_SCOPE, HI, 'Lagrange multipliers: use /RBODY'), &
      keyword_t('/TRANSFORM',      T, OUT_OF_SCOPE, HI, 'moves of another kind'), &
      keyword_t('/FUNCT_PYTHON',    T, OUT_OF_SCOPE, HI, 'functions in Python: use /FUNCT with points'), &
      keyword_t('/EIG',             T, OUT_OF_SCOPE, HI, 'eigenmodes'), &
      keyword_t('/BEM',             T, OUT_OF_SCOPE, HI, 'fluids around the scene'), &
      ! groups that node groups may name
      keyword_t('/GRSH3N',         T, ASIDE, HI, 'group of triangles, for node groups that name it'), &
      keyword_t('/GRQUAD',          T, NOTE_IT, HI, 'group of plane elements, used by nothing in scope'), &
      keyword_t('/GRTRIA',          T, NOTE_IT, HI, 'group of plane elements, used by nothing in scope'), &
      keyword_t('/GRBEAM',         T, ASIDE, HI, 'group of beams, for node groups that name it'), &
      keyword_t('/GRTRUS',         T, ASIDE, HI, 'group of trusses, for node groups that name it'), &
      ! materials, elements and fluids: without these there is nothing to act on
      keyword_t('/EOS',             T, NOTE_IT, HI, 'equation of state of a material'), &
      keyword_t('/VISC',            T, NOTE_IT, HI, 'viscosity of a material'), &
      keyword_t('/LEAK',            T, NOTE_IT, HI, 'porosity of a fabric'), &
      keyword_t('/NONLOCAL',        T, NOTE_IT, HI, 'regularisation of a material'), &
      keyword_t('/THERM_STRESS',    T, NOTE_IT, HI, 'thermal expansion of a material'), &
      keyword_t('/HEAT',            T, NOTE_IT, HI, 'heat in a material'), &
      keyword_t('/EULER',           F, NOTE_IT, HN, 'fluids'), &
      keyword_t('/EBCS',            T, NOTE_IT, HI, 'boundaries of fluids'), &
      keyword_t('/CAA',             F, NOTE_IT, HN, 'acoustics of fluids'), &
      keyword_t('/DFS',             T, NOTE_IT, HI, 'detonation of explosives'), &
      keyword_t('/INIMAP1D',        T, NOTE_IT, HI, 'initial state of fluids'), &
      keyword_t('/INIMAP2D',        T, NOTE_IT, HI, 'initial state of fluids'), &
      keyword_t('/INIVOL',          T, NOTE_IT, HI, 'initial filling of fluids'), &
      keyword_t('/INIGRAV',         T, NOTE_IT, HI, 'initial pressure of materials'), &
      keyword_t('/INIBRI',          F, NOTE_IT, HN, 'initial state of solids'), &
      keyword_t('/INISHE',          F, NOTE_IT, HN, 'initial state of shells'), &
      keyword_t('/INISH3',          F, NOTE_IT, HN, 'initial state of triangles'), &
      keyword_t('/INIQUA',          F, NOTE_IT, HN, 'initial state of plane elements'), &
      keyword_t('/INIBEAM',         F, NOTE_IT, HN, 'initial state of beams'), &
      keyword_t('/INITRUSS',        F, NOTE_IT, HN, 'initial state of trusses'), &
      keyword_t('/INISTA',          F, NOTE_IT, HN, 'initial state of elements, from a file'), &
      keyword_t('/INICRACK',        T, NOTE_IT, HI, 'initial cracks of shells'), &
      keyword_t('/INITEMP',         T, NOTE_IT, HI, 'initial temperature'), &
      keyword_t('/IMPTEMP',         T, NOTE_IT, HI, 'imposed temperature'), &
      keyword_t('/IMPFLUX',         T, NOTE_IT, HI, 'imposed flow of heat'), &
      keyword_t('/CONVEC',          T, NOTE_IT, HI, 'convection of heat'), &
      keyword_t('/RADIATION',       T, NOTE_IT, HI, 'radiation of heat'), &
      keyword_t('/LASER',           T, NOTE_IT, HI, 'heat of a laser'), &
      keyword_t('/XREF',            T, NOTE_IT, HI, 'reference geometry of elements'), &
      keyword_t('/EREF',            T, NOTE_IT, HI, 'reference geometry of elements'), &
      keyword_t('/REFSTA',          F, NOTE_IT, HN, 'reference geometry of elements'), &
      keyword_t('/SHFRA',           F, NOTE_IT, HN, 'axes of shell elements'), &
      keyword_t('/DRAPE',           T, NOTE_IT, HI, 'plies of shell elements'), &
      keyword_t('/PLY',             T, NOTE_IT, HI, 'plies of shell elements'), &
      keyword_t('/STACK',           T, NOTE_IT, HI, 'plies of shell elements'), &
      keyword_t('/PERTURB',         T, NOTE_IT, HI, 'scatter of thickness and failure of elements'), &
      keyword_t('/CLUSTER',         T, NOTE_IT, HI, 'group of elements that fail together'), &
      keyword_t('/STAMPING',        F, NOTE_IT, HN, 'stamping of sheets'), &
      keyword_t('/ADMESH',          F, NOTE_IT, HN, 'refinement of meshes'), &
      keyword_t('/SUBDOMAIN',       T, NOTE_IT, HI, 'parts of a coupled run'), &
      keyword_t('/SPH',             T, NOTE_IT, HI, 'particles'), &
      keyword_t('/SPHBCS',          T, NOTE_IT, HI, 'conditions of particles'), &
      keyword_t('/SPHGLO',          F, NOTE_IT, HN, 'numerics of particles'), &
      keyword_t('/FRIC_ORIENT',     T, NOTE_IT, HI, 'friction of contacts'), &
      keyword_t('/TABLE',           T, NOTE_IT, HI, 'table, used by nothing in scope'), &
      keyword_t('/FUNC2D',          T, NOTE_IT, HI, 'function of two arguments, used by nothing in scope'), &
      ! other solvers, preprocessors
      keyword_t('/AMS',             F, NOTE_IT, HN, 'mass scaling of elements'), &
      keyword_t('/DEF_INTER',       F, NOTE_IT, HN, 'defaults of contacts'), &
      keyword_t('/INTTHICK',        F, NOTE_IT, HN, 'thickness in contacts'), &
      keyword_t('/LAGMUL',          F, NOTE_IT, HN, 'solver of Lagrange multipliers'), &
      keyword_t('/IMPLICIT',        F, NOTE_IT, HN, 'implicit run, which the engine deck asks for'), &
      keyword_t('/UPWIND',          F, NOTE_IT, HN, 'numerics of fluids'), &
      keyword_t('/MEMORY',          F, NOTE_IT, HN, 'memory of other solvers'), &
      keyword_t('/ARCH',            F, NOTE_IT, HN, 'machine of other solvers'), &
      keyword_t('/CHECKSUM',        F, NOTE_IT, HN, 'check sums of the deck'), &
      keyword_t('/PRIVATE',         F, NOTE_IT, HN, 'data of preprocessors'), &
      keyword_t('/ASSEMBLY',        T, NOTE_IT, HI, 'data of preprocessors'), &
      keyword_t('/DUMMY_START',     F, NOTE_IT, HN, 'data of preprocessors'), &
      keyword_t('/DUMMY_END',       F, NOTE_IT, HN, 'data of preprocessors'), &
      keyword_t('/HPOINT',          T, NOTE_IT, HI, 'data of preprocessors'), &
      keyword_t('/POSITION',        T, NOTE_IT, HI, 'data of preprocessors')]

end module kj_other_keywords
