!> THE table of keywords of the starter deck: how each is written, what its header holds and
!> whether kjoint reads it. The cards of the keywords stand in kj_card_fields.
!> One file: one table of keywords
module kj_keywords
   use kj_spelling, only: upper, edit_distance
   implicit none
   private

   public :: find_keyword, keyword_of, nearest_keyword, status_name

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

   integer, parameter :: HI = HEAD_ID, HU = HEAD_UNIT, HT = HEAD_TYPE_ID, HN = HEAD_NONE
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

   !> Keywords whose cards are read, and their neighbours
   type(keyword_t), parameter :: main_keywords(*) = [ &
      keyword_t('/BEGIN',           T, READ_IT, HN, 'format version, input units and work units'), &
      keyword_t('/TITLE',           T, READ_IT, HN, 'title of the model'), &
      keyword_t('/END',             F, READ_IT, HN, 'end of the deck'), &
      keyword_t('/UNIT',            T, READ_IT, HI, 'units of the blocks that name this id'), &
      keyword_t('/UNIT/MASS',       T, ASIDE, HI, 'unit of mass of the deck, or of its blocks'), &
      keyword_t('/UNIT/LENGTH',     T, ASIDE, HI, 'unit of length of the deck, or of its blocks'), &
      keyword_t('/UNIT/TIME',       T, ASIDE, HI, 'unit of time of the deck, or of its blocks'), &
      keyword_t('/NODE',            F, READ_IT, HU, 'nodes: id and coordinates'), &
      keyword_t('/CNODE',           F, OUT_OF_SCOPE, HN, 'merging of nodes: use /NODE'), &
      keyword_t('/PART',            T, READ_IT, HI, 'elements of one property and material'), &
      keyword_t('/SUBSET',         T, ASIDE, HI, 'set of parts and subsets'), &
      keyword_t('/SPRING',          F, READ_IT, HI, 'springs and joints of a part: id and nodes'), &
      keyword_t('/PROP/TYPE33',     T, READ_IT, HI, 'kinematic joint'), &
      keyword_t('/PROP/KJOINT',     T, READ_IT, HI, 'kinematic joint, same as /PROP/TYPE33'), &
      keyword_t('/PROP/TYPE45',     T, READ_IT, HI, 'kinematic joint with stops and friction'), &
      keyword_t('/PROP/KJOINT2',    T, READ_IT, HI, 'kinematic joint, same as /PROP/TYPE45'), &
      keyword_t('/PROP/TYPE4',      T, READ_IT, HI, 'spring along the line of its two nodes'), &
      keyword_t('/PROP/SPRING',     T, READ_IT, HI, 'spring, same as /PROP/TYPE4'), &
      keyword_t('/PROP/TYPE8',      T, READ_IT, HI, 'spring with six laws in the axes of a skew'), &
      keyword_t('/PROP/SPR_GENE',   T, READ_IT, HI, 'spring, same as /PROP/TYPE8'), &
      keyword_t('/PROP/TYPE13',     T, READ_IT, HI, 'spring with six laws, like a beam'), &
      keyword_t('/PROP/SPR_BEAM',   T, READ_IT, HI, 'spring, same as /PROP/TYPE13'), &
      keyword_t('/PROP',            T, OUT_OF_SCOPE, HI, 'elements of another kind than springs and joints'), &
      keyword_t('/MAT/VOID',        T, READ_IT, HI, 'material without stiffness'), &
      keyword_t('/MAT/LAW0',        T, READ_IT, HI, 'material without stiffness, same as /MAT/VOID'), &
      keyword_t('/MAT',             T, OUT_OF_SCOPE, HI, 'deformable elements; springs and joints need none'), &
      keyword_t('/RBODY',           T, READ_IT, HI, 'rigid body: main node, mass, inertia, group'), &
      keyword_t('/GRNOD/NODE',      T, READ_IT, HI, 'node group: ids'), &
      keyword_t('/GRNOD/NODENS',    T, READ_IT, HI, 'node group: ids, order kept'), &
      keyword_t('/GRNOD/GRNOD',     T, READ_IT, HI, 'node group: ids of groups, negative ones removed'), &
      keyword_t('/GRNOD/GENE',      T, READ_IT, HI, 'node group: ranges of ids, first and last'), &
      keyword_t('/GRNOD/GEN_INCR',  T, READ_IT, HI, 'node group: ranges of ids, first, last, increment'), &
      keyword_t('/GRNOD/PART',      T, READ_IT, HI, 'node group: nodes of the elements of parts'), &
      keyword_t('/GRNOD/SUBSET',   T, READ_IT, HI, 'node group: nodes of the elements of subsets'), &
      keyword_t('/GRNOD/MAT',      T, READ_IT, HI, 'node group: nodes of the elements of materials'), &
      keyword_t('/GRNOD/PROP',     T, READ_IT, HI, 'node group: nodes of the elements of properties'), &
      keyword_t('/GRNOD/SUBMODEL', T, READ_IT, HI, 'node group: nodes of submodels'), &
      keyword_t('/GRNOD/GRSHEL',   T, READ_IT, HI, 'node group: nodes of groups of shells'), &
      keyword_t('/GRNOD/GRSH3N',   T, READ_IT, HI, 'node group: nodes of groups of triangles'), &
      keyword_t('/GRNOD/GRBRIC',   T, READ_IT, HI, 'node group: nodes of groups of solids'), &
      keyword_t('/GRNOD/GRBEAM',   T, READ_IT, HI, 'node group: nodes of groups of beams'), &
      keyword_t('/GRNOD/GRTRUS',   T, READ_IT, HI, 'node group: nodes of groups of trusses'), &
      keyword_t('/GRNOD/GRSPRI',   T, READ_IT, HI, 'node group: nodes of groups of springs'), &
      keyword_t('/GRNOD/SURF',     T, READ_IT, HI, 'node group: nodes of surfaces'), &
      keyword_t('/GRNOD/LINE',     T, READ_IT, HI, 'node group: nodes of lines'), &
      keyword_t('/GRNOD/BOX',       T, READ_IT, HI, 'node group: nodes inside of boxes'), &
      keyword_t('/GRNOD',           T, OUT_OF_SCOPE, HI, 'another way to choose nodes: list them instead'), &
      keyword_t('/BOX/RECTA',       T, READ_IT, HI, 'box by two corners'), &
      keyword_t('/BOX/SPHER',      T, READ_IT, HI, 'box by a point and a diameter'), &
      keyword_t('/BOX/CYLIN',      T, READ_IT, HI, 'box by an axis and a diameter'), &
      keyword_t('/BOX',             T, OUT_OF_SCOPE, HI, 'sets of boxes: list the boxes in /GRNOD/BOX'), &
      keyword_t('/SET/GENERAL',     T, READ_IT, HI, 'set of nodes by clauses'), &
      keyword_t('/SET/COLLECT',    T, READ_IT, HI, 'set of nodes by clauses, blocks of one id united'), &
      keyword_t('/SET',            T, OUT_OF_SCOPE, HI, 'sets of another kind: use /SET/GENERAL'), &
      keyword_t('/SKEW/FIX',        T, READ_IT, HI, 'axes fixed in space'), &
      keyword_t('/SKEW/MOV',        T, READ_IT, HI, 'axes that follow three nodes'), &
      keyword_t('/SKEW/MOV2',       T, READ_IT, HI, 'axes that follow three nodes, z first'), &
      keyword_t('/SKEW',            T, OUT_OF_SCOPE, HI, 'skews of another kind than FIX, MOV and MOV2'), &
      keyword_t('/FRAME/FIX',       T, READ_IT, HI, 'frame fixed in space'), &
      keyword_t('/FRAME/MOV',       T, READ_IT, HI, 'frame that follows three nodes'), &
      keyword_t('/FRAME/MOV2',      T, READ_IT, HI, 'frame that follows three nodes, z first'), &
      keyword_t('/FRAME/NOD',       T, READ_IT, HI, 'frame that follows one node'), &
      keyword_t('/FRAME',           T, OUT_OF_SCOPE, HI, 'frames of another kind than FIX, MOV, MOV2 and NOD'), &
      keyword_t('/FUNCT',           T, READ_IT, HI, 'function by points'), &
      keyword_t('/FUNCT_SMOOTH',    T, OUT_OF_SCOPE, HI, 'smooth interpolation: use /FUNCT with more points'), &
      keyword_t('/MOVE_FUNCT',      T, READ_IT, HI, 'scales and shifts a function'), &
      keyword_t('/BCS',             T, READ_IT, HI, 'blocked directions of nodes'), &
      keyword_t('/GRAV',            T, READ_IT, HI, 'gravity'), &
      keyword_t('/CLOAD',           T, READ_IT, HI, 'force or moment on nodes'), &
      keyword_t('/IMPVEL',          T, READ_IT, HI, 'imposed velocity'), &
      keyword_t('/IMPVEL/LAGMUL',   T, OUT_OF_SCOPE, HI, 'Lagrange multipliers: use /IMPVEL'), &
      keyword_t('/IMPVEL/FGEO',     T, OUT_OF_SCOPE, HI, 'motion to a final geometry'), &
      keyword_t('/IMPDISP',         T, READ_IT, HI, 'imposed displacement'), &
      keyword_t('/IMPDISP/FGEO',    T, OUT_OF_SCOPE, HI, 'motion to a final geometry'), &
      keyword_t('/IMPACC',          T, READ_IT, HI, 'imposed acceleration'), &
      keyword_t('/INIVEL/TRA',      T, READ_IT, HI, 'initial velocity'), &
      keyword_t('/INIVEL/ROT',      T, READ_IT, HI, 'initial angular velocity'), &
      keyword_t('/INIVEL/T+G',      T, READ_IT, HI, 'initial velocity of nodes and grid'), &
      keyword_t('/INIVEL/AXIS',     T, READ_IT, HI, 'initial velocity about an axis'), &
      keyword_t('/INIVEL/GRID',     T, NOTE_IT, HI, 'grid velocity of fluids'), &
      keyword_t('/INIVEL',          T, OUT_OF_SCOPE, HI, 'initial velocity of another kind'), &
      keyword_t('/ADMAS',           T, READ_IT, HT, 'masses on nodes'), &
      keyword_t('/SENSOR/TIME',     T, READ_IT, HI, 'sensor of time'), &
      keyword_t('/SENSOR',          T, OUT_OF_SCOPE, HI, 'sensors of other things than time'), &
      keyword_t('/TH/NODE',         T, READ_IT, HI, 'history of nodes'), &
      keyword_t('/TH/SPRING',       T, READ_IT, HI, 'history of springs and joints'), &
      keyword_t('/TH/RBODY',        T, READ_IT, HI, 'history of rigid bodies'), &
      keyword_t('/TH/PART',         T, READ_IT, HI, 'history of parts'), &
      keyword_t('/TH',              T, NOTE_IT, HI, 'history of other things: not written'), &
      keyword_t('/ATH',             T, NOTE_IT, HI, 'history in a file A: not written'), &
      keyword_t('/BTH',             T, NOTE_IT, HI, 'history in a file B: not written'), &
      keyword_t('/CTH',             T, NOTE_IT, HI, 'history in a file C: not written'), &
      keyword_t('/DTH',             T, NOTE_IT, HI, 'history in a file D: not written'), &
      keyword_t('/ETH',             T, NOTE_IT, HI, 'history in a file E: not written'), &
      keyword_t('/FTH',             T, NOTE_IT, HI, 'history in a file F: not written'), &
      keyword_t('/GTH',             T, NOTE_IT, HI, 'history in a file G: not written'), &
      keyword_t('/HTH',             T, NOTE_IT, HI, 'history in a file H: not written'), &
      keyword_t('/ITH',             T, NOTE_IT, HI, 'history in a file I: not written'), &
      keyword_t('/ANALY',           F, READ_IT, HN, 'kind of analysis: must be 3D'), &
      keyword_t('/SPMD',            F, NOTE_IT, HN, 'parallel run of other solvers'), &
      keyword_t('/IOFLAG',          F, NOTE_IT, HN, 'listing of other solvers'), &
      keyword_t('/DEF_SOLID',      F, ASIDE, HN, 'defaults of solid elements'), &
      keyword_t('/DEF_SHELL',      F, ASIDE, HN, 'defaults of shell elements'), &
      keyword_t('/DEFAULT',         F, NOTE_IT, HN, 'defaults of contacts and elements'), &
      keyword_t('/RANDOM',          F, READ_IT, HN, 'disturbs coordinates: must be 0'), &
      keyword_t('/RANDOM/GRNOD',    F, READ_IT, HI, 'disturbs coordinates of a group: must be 0'), &
      keyword_t('/GRPART',         T, ASIDE, HI, 'group of parts, for node groups that name it'), &
      keyword_t('/GRSPRI',         T, ASIDE, HI, 'group of springs, for node groups that name it'), &
      keyword_t('/GRSHEL',         T, ASIDE, HI, 'group of shells, for node groups that name it'), &
      keyword_t('/GRBRIC',         T, ASIDE, HI, 'group of solids, for node groups that name it'), &
      keyword_t('/SURF',           T, ASIDE, HI, 'surface, for node groups that name it'), &
      keyword_t('/LINE',           T, ASIDE, HI, 'line, for node groups that name it'), &
      keyword_t('/ANIM',            F, NOTE_IT, HN, 'animation files: not written'), &
      keyword_t('/PARAMETER',      T, ASIDE, HI, 'names of values for the fields of cards'), &
      keyword_t('//SUBMODEL',      T, ASIDE, HI, 'begin of a submodel: offsets of its ids'), &
      keyword_t('//ENDSUB',        F, ASIDE, HN, 'end of a submodel'), &
      keyword_t('/TRANSFORM/TRA',  T, READ_IT, HI, 'moves nodes along'), &
      keyword_t('/TRANSFORM/ROT',  T, READ_IT, HI, 'turns nodes about an axis'), &
      keyword_t('/TRANSFORM/SYM',  T, READ_IT, HI, 'mirrors nodes'), &
      keyword_t('/TRANSFORM/SCA',  T, READ_IT, HI, 'stretches nodes about a point'), &
      keyword_t('/TRANSFORM/MATRIX', T, READ_IT, HI, 'moves nodes by a matrix'), &
      keyword_t('/TRANSFORM/POSITION', T, READ_IT, HI, 'moves nodes from three points to three others'), &
      keyword_t('/MERGE',           T, OUT_OF_SCOPE, HI, 'merging of bodies: make them one /RBODY'), &
      keyword_t('/DAMP',            T, OUT_OF_SCOPE, HI, 'Rayleigh damping'), &
      keyword_t('/BRICK',          F, FULL_ONLY, HI, 'solid elements'), &
      keyword_t('/TETRA4',         F, FULL_ONLY, HI, 'solid elements'), &
      keyword_t('/TETRA10',        F, FULL_ONLY, HI, 'solid elements'), &
      keyword_t('/SHELL',          F, FULL_ONLY, HI, 'shell elements'), &
      keyword_t('/SH3N',           F, FULL_ONLY, HI, 'shell elements'), &
      keyword_t('/QUAD',            F, OUT_OF_SCOPE, HI, 'plane elements'), &
      keyword_t('/BEAM',           F, FULL_ONLY, HI, 'beam elements'), &
      keyword_t('/TRUSS',          F, FULL_ONLY, HI, 'truss elements'), &
      keyword_t('/INTER',           T, OUT_OF_SCOPE, HI, 'contact'), &
      keyword_t('/FRICTION',        T, OUT_OF_SCOPE, HI, 'contact'), &
      keyword_t('/RWALL',           T, OUT_OF_SCOPE, HI, 'rigid walls'), &
      keyword_t('/RLINK',           T, OUT_OF_SCOPE, HI, 'rigid links: use a rigid joint or /RBODY'), &
      keyword_t('/RBE2',           T, FULL_ONLY, HI, 'RBE2: use /RBODY'), &
      keyword_t('/RBE3',            T, OUT_OF_SCOPE, HI, 'interpolation constraints'), &
      keyword_t('/MPC',             T, OUT_OF_SCOPE, HI, 'linear constraints'), &
      keyword_t('/CYL_JOINT',       T, OUT_OF_SCOPE, HI, 'cylindrical constraint: use /PROP/KJOINT type 3'), &
      keyword_t('/GJOINT',          T, OUT_OF_SCOPE, HI, 'gear joints'), &
      keyword_t('/PLOAD',           T, OUT_OF_SCOPE, HI, 'pressure on surfaces'), &
      keyword_t('/LOAD',            T, OUT_OF_SCOPE, HI, 'loads on surfaces, centrifugal loads'), &
      keyword_t('/MONVOL',          T, OUT_OF_SCOPE, HI, 'airbags'), &
      keyword_t('/FXBODY',          T, OUT_OF_SCOPE, HI, 'flexible bodies'), &
      keyword_t('/FAIL',            T, OUT_OF_SCOPE, HI, 'failure of materials'), &
      keyword_t('/ACTIV',           T, OUT_OF_SCOPE, HI, 'switching of elements'), &
      keyword_t('/ALE',             F, OUT_OF_SCOPE, HN, 'fluids'), &
      keyword_t('/ACCEL',           T, NOTE_IT, HI, 'accelerometer, for output only'), &
      keyword_t('/SECT',            T, NOTE_IT, HI, 'section, for output only'), &
      keyword_t('/GAUGE',           T, NOTE_IT, HI, 'gauge, for output only'), &
      keyword_t('/STATE',           F, NOTE_IT, HN, 'state file: not written')]

   type(keyword_t), parameter, public :: keywords(*) = [main_keywords, other_keywords]

   !> Other names: the cards are those of the second
   character(len=20), parameter :: SAME_AS(2, 7) = reshape([character(len=20) :: &
      '/PROP/KJOINT', '/PROP/TYPE33', &
      '/PROP/KJOINT2', '/PROP/TYPE45', &
      '/PROP/SPRING', '/PROP/TYPE4', &
      '/PROP/SPR_GENE', '/PROP/TYPE8', &
      '/PROP/SPR_BEAM', '/PROP/TYPE13', &
      '/MAT/LAW0', '/MAT/VOID', &
      '/RANDOM/GRNOD', '/RANDOM'], [2, 7])

   !> Keywords that the reader or the builder knows: their rows. Those that only have a status need
   !> none.
   character(len=20), parameter :: NAME(*) = keywords%name
   integer, parameter, public :: N_KEYWORD = size(keywords), &
      KW_BEGIN = findloc(NAME, '/BEGIN', 1), KW_TITLE = findloc(NAME, '/TITLE', 1), &
      KW_END = findloc(NAME, '/END', 1), KW_UNIT = findloc(NAME, '/UNIT', 1), &
      KW_UNIT_MASS = findloc(NAME, '/UNIT/MASS', 1), &
      KW_UNIT_LENGTH = findloc(NAME, '/UNIT/LENGTH', 1), &
      KW_UNIT_TIME = findloc(NAME, '/UNIT/TIME', 1), &
      KW_NODE = findloc(NAME, '/NODE', 1), KW_PART = findloc(NAME, '/PART', 1), &
      KW_SPRING = findloc(NAME, '/SPRING', 1), KW_KJOINT = findloc(NAME, '/PROP/TYPE33', 1), &
      KW_KJOINT2 = findloc(NAME, '/PROP/TYPE45', 1), &
      KW_SPRING4 = findloc(NAME, '/PROP/TYPE4', 1), KW_SPRING8 = findloc(NAME, '/PROP/TYPE8', 1), &
      KW_SPRING13 = findloc(NAME, '/PROP/TYPE13', 1), &
      KW_MAT_VOID = findloc(NAME, '/MAT/VOID', 1), KW_RBODY = findloc(NAME, '/RBODY', 1), &
      KW_GRNOD_NODE = findloc(NAME, '/GRNOD/NODE', 1), &
      KW_GRNOD_NODENS = findloc(NAME, '/GRNOD/NODENS', 1), &
      KW_GRNOD_GRNOD = findloc(NAME, '/GRNOD/GRNOD', 1), &
      KW_GRNOD_GENE = findloc(NAME, '/GRNOD/GENE', 1), &
      KW_GRNOD_GEN_INCR = findloc(NAME, '/GRNOD/GEN_INCR', 1), &
      KW_GRNOD_PART = findloc(NAME, '/GRNOD/PART', 1), &
      KW_GRNOD_BOX = findloc(NAME, '/GRNOD/BOX', 1), &
      KW_BOX_RECTA = findloc(NAME, '/BOX/RECTA', 1), &
      KW_SET_GENERAL = findloc(NAME, '/SET/GENERAL', 1), &
      KW_SKEW_FIX = findloc(NAME, '/SKEW/FIX', 1), KW_SKEW_MOV = findloc(NAME, '/SKEW/MOV', 1), &
      KW_SKEW_MOV2 = findloc(NAME, '/SKEW/MOV2', 1), &
      KW_FRAME_FIX = findloc(NAME, '/FRAME/FIX', 1), &
      KW_FRAME_MOV = findloc(NAME, '/FRAME/MOV', 1), &
      KW_FRAME_MOV2 = findloc(NAME, '/FRAME/MOV2', 1), &
      KW_FRAME_NOD = findloc(NAME, '/FRAME/NOD', 1), KW_FUNCT = findloc(NAME, '/FUNCT', 1), &
      KW_MOVE_FUNCT = findloc(NAME, '/MOVE_FUNCT', 1), KW_BCS = findloc(NAME, '/BCS', 1), &
      KW_GRAV = findloc(NAME, '/GRAV', 1), KW_CLOAD = findloc(NAME, '/CLOAD', 1), &
      KW_IMPVEL = findloc(NAME, '/IMPVEL', 1), KW_IMPDISP = findloc(NAME, '/IMPDISP', 1), &
      KW_IMPACC = findloc(NAME, '/IMPACC', 1), KW_INIVEL_TRA = findloc(NAME, '/INIVEL/TRA', 1), &
      KW_INIVEL_ROT = findloc(NAME, '/INIVEL/ROT', 1), &
      KW_INIVEL_TG = findloc(NAME, '/INIVEL/T+G', 1), &
      KW_INIVEL_AXIS = findloc(NAME, '/INIVEL/AXIS', 1), KW_ADMAS = findloc(NAME, '/ADMAS', 1), &
      KW_SENSOR_TIME = findloc(NAME, '/SENSOR/TIME', 1), &
      KW_TH_NODE = findloc(NAME, '/TH/NODE', 1), KW_TH_SPRING = findloc(NAME, '/TH/SPRING', 1), &
      KW_TH_RBODY = findloc(NAME, '/TH/RBODY', 1), KW_TH_PART = findloc(NAME, '/TH/PART', 1), &
      KW_ANALY = findloc(NAME, '/ANALY', 1), KW_RANDOM = findloc(NAME, '/RANDOM', 1), &
      KW_SHELL = findloc(NAME, '/SHELL', 1), KW_SH3N = findloc(NAME, '/SH3N', 1), &
      KW_BRICK = findloc(NAME, '/BRICK', 1), KW_TETRA4 = findloc(NAME, '/TETRA4', 1), &
      KW_TETRA10 = findloc(NAME, '/TETRA10', 1), KW_PENTA6 = findloc(NAME, '/PENTA6', 1), &
      KW_BRIC20 = findloc(NAME, '/BRIC20', 1), KW_SHEL16 = findloc(NAME, '/SHEL16', 1), &
      KW_BEAM = findloc(NAME, '/BEAM', 1), KW_TRUSS = findloc(NAME, '/TRUSS', 1), &
      KW_RBE2 = findloc(NAME, '/RBE2', 1), KW_SUBSET = findloc(NAME, '/SUBSET', 1), &
      KW_DEF_SOLID = findloc(NAME, '/DEF_SOLID', 1), &
      KW_DEF_SHELL = findloc(NAME, '/DEF_SHELL', 1), KW_GRPART = findloc(NAME, '/GRPART', 1), &
      KW_GRSPRI = findloc(NAME, '/GRSPRI', 1), KW_GRSHEL = findloc(NAME, '/GRSHEL', 1), &
      KW_GRBRIC = findloc(NAME, '/GRBRIC', 1), KW_GRSH3N = findloc(NAME, '/GRSH3N', 1), &
      KW_GRBEAM = findloc(NAME, '/GRBEAM', 1), KW_GRTRUS = findloc(NAME, '/GRTRUS', 1), &
      KW_SURF = findloc(NAME, '/SURF', 1), KW_LINE = findloc(NAME, '/LINE', 1), &
      KW_PARAMETER = findloc(NAME, '/PARAMETER', 1), &
      KW_SUBMODEL = findloc(NAME, '//SUBMODEL', 1), KW_ENDSUB = findloc(NAME, '//ENDSUB', 1), &
      KW_BOX_SPHER = findloc(NAME, '/BOX/SPHER', 1), &
      KW_BOX_CYLIN = findloc(NAME, '/BOX/CYLIN', 1), &
      KW_SET_COLLECT = findloc(NAME, '/SET/COLLECT', 1), &
      KW_GRNOD_SUBSET = findloc(NAME, '/GRNOD/SUBSET', 1), &
      KW_GRNOD_MAT = findloc(NAME, '/GRNOD/MAT', 1), &
      KW_GRNOD_PROP = findloc(NAME, '/GRNOD/PROP', 1), &
      KW_GRNOD_SUBMODEL = findloc(NAME, '/GRNOD/SUBMODEL', 1), &
      KW_GRNOD_GRSHEL = findloc(NAME, '/GRNOD/GRSHEL', 1), &
      KW_GRNOD_GRSH3N = findloc(NAME, '/GRNOD/GRSH3N', 1), &
      KW_GRNOD_GRBRIC = findloc(NAME, '/GRNOD/GRBRIC', 1), &
      KW_GRNOD_GRBEAM = findloc(NAME, '/GRNOD/GRBEAM', 1), &
      KW_GRNOD_GRTRUS = findloc(NAME, '/GRNOD/GRTRUS', 1), &
      KW_GRNOD_GRSPRI = findloc(NAME, '/GRNOD/GRSPRI', 1), &
      KW_GRNOD_SURF = findloc(NAME, '/GRNOD/SURF', 1), &
      KW_GRNOD_LINE = findloc(NAME, '/GRNOD/LINE', 1), &
      KW_TRANS_TRA = findloc(NAME, '/TRANSFORM/TRA', 1), &
      KW_TRANS_ROT = findloc(NAME, '/TRANSFORM/ROT', 1), &
      KW_TRANS_SYM = findloc(NAME, '/TRANSFORM/SYM', 1), &
      KW_TRANS_SCA = findloc(NAME, '/TRANSFORM/SCA', 1), &
      KW_TRANS_MATRIX = findloc(NAME, '/TRANSFORM/MATRIX', 1), &
      KW_TRANS_POSITION = findloc(NAME, '/TRANSFORM/POSITION', 1)

contains

   !> read; noted; aside: read where another keyword names it; full only: read of a full deck
   pure function status_name(status) result(name)
      integer, intent(in) :: status
      character(len=11) :: name

      name = 'unsupported'
      if (status == READ_IT) name = 'read'
      if (status == NOTE_IT) name = 'noted'
      if (status == ASIDE) name = 'aside'
      if (status == FULL_ONLY) name = 'full only'
   end function status_name

   !> Row that a header path belongs to; 0 when there is none
   !>
   !> All but READ_IT rows also answer for longer paths: /INTER for /INTER/TYPE7.
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

   !> The keyword whose cards a row has: KW_ constant, 0 when nobody reads them
   pure integer function keyword_of(row) result(keyword)
      integer, intent(in) :: row

      integer :: i

      keyword = merge(row, 0, any(keywords(row)%status == [READ_IT, FULL_ONLY, ASIDE]))
      i = findloc(SAME_AS(1, :), keywords(row)%name, 1)
      if (i > 0) keyword = exact_row(trim(SAME_AS(2, i)))
   end function keyword_of

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
