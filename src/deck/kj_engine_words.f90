!> THE table of keywords of the engine deck. Of a word the first five characters count.
module kj_engine_words
   implicit none
   private

   public :: find_engine_word, is_engine_word

   !> What becomes of a keyword
   integer, parameter, public :: ENGINE_READ = 1, ENGINE_NOTE = 2, ENGINE_OUT = 3

   !> A row of the table
   type, public :: engine_word_t
      character(len=5)  :: name        !! first word of the header
      integer           :: status      !! ENGINE_ constant
      logical           :: once        !! of two of them the first holds
      character(len=60) :: meaning     !! ENGINE_OUT: what would be needed
   end type engine_word_t

   logical, parameter :: T = .true., F = .false.

   type(engine_word_t), parameter, public :: engine_words(*) = [ &
      engine_word_t('RUN',   ENGINE_READ, T, 'run number and end of the run'), &
      engine_word_t('TITLE', ENGINE_READ, T, 'title, not used'), &
      engine_word_t('VERS',  ENGINE_READ, T, 'version of the deck'), &
      engine_word_t('TFILE', ENGINE_READ, T, 'interval of the histories'), &
      engine_word_t('PRINT', ENGINE_READ, T, 'cycles between two lines of the listing'), &
      engine_word_t('DT',    ENGINE_READ, F, 'factor and least value of the time step'), &
      engine_word_t('DTIX',  ENGINE_READ, T, 'first and largest time step'), &
      engine_word_t('TH',    ENGINE_NOTE, F, 'form of the T01 file: none is written'), &
      engine_word_t('STOP',  ENGINE_READ, T, 'limits of energy and mass errors'), &
      engine_word_t('KILL',  ENGINE_READ, T, 'limits of energy and mass errors'), &
      engine_word_t('END',   ENGINE_READ, F, 'end of the deck'), &
      engine_word_t('RFILE', ENGINE_READ, T, 'checkpoints'), &
      engine_word_t('ATFIL', ENGINE_NOTE, F, 'history in a file A: not written'), &
      engine_word_t('BTFIL', ENGINE_NOTE, F, 'history in a file B: not written'), &
      engine_word_t('CTFIL', ENGINE_NOTE, F, 'history in a file C: not written'), &
      engine_word_t('DTFIL', ENGINE_NOTE, F, 'history in a file D: not written'), &
      engine_word_t('ETFIL', ENGINE_NOTE, F, 'history in a file E: not written'), &
      engine_word_t('FTFIL', ENGINE_NOTE, F, 'history in a file F: not written'), &
      engine_word_t('GTFIL', ENGINE_NOTE, F, 'history in a file G: not written'), &
      engine_word_t('HTFIL', ENGINE_NOTE, F, 'history in a file H: not written'), &
      engine_word_t('ITFIL', ENGINE_NOTE, F, 'history in a file I: not written'), &
      engine_word_t('ANIM',  ENGINE_NOTE, F, 'animation files: not written'), &
      engine_word_t('H3D',   ENGINE_NOTE, F, 'animation files: not written'), &
      engine_word_t('OUTP',  ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t('STATE', ENGINE_NOTE, F, 'state files: not written'), &
      engine_word_t('DYNAI', ENGINE_NOTE, F, 'state files: not written'), &
      engine_word_t('ABF',   ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t('MON',   ENGINE_NOTE, F, 'timing of other solvers'), &
      engine_word_t('PROC',  ENGINE_NOTE, F, 'parallel run of other solvers'), &
      engine_word_t('SPMD',  ENGINE_NOTE, F, 'parallel run of other solvers'), &
      engine_word_t('PARIT', ENGINE_NOTE, F, 'order of sums; ours never depends on threads'), &
      engine_word_t('DEBUG', ENGINE_NOTE, F, 'debugging of other solvers'), &
      engine_word_t('PERF',  ENGINE_NOTE, F, 'timing of other solvers'), &
      engine_word_t('NEGVO', ENGINE_NOTE, F, 'solid elements'), &
      engine_word_t('UPWIN', ENGINE_NOTE, F, 'fluids'), &
      engine_word_t('BCS',   ENGINE_READ, F, 'nodes that are held'), &
      engine_word_t('BCSR',  ENGINE_READ, F, 'nodes that are released'), &
      engine_word_t('DEL',   ENGINE_OUT,  F, 'elements that are deleted: leave them out of the deck'), &
      engine_word_t('RBODY', ENGINE_OUT,  F, 'rigid bodies that are switched'), &
      engine_word_t('KEREL', ENGINE_OUT,  F, 'kinetic-energy relaxation'), &
      engine_word_t('DYREL', ENGINE_OUT,  F, 'dynamic relaxation'), &
      engine_word_t('ADYRE', ENGINE_OUT,  F, 'dynamic relaxation'), &
      engine_word_t('DAMP',  ENGINE_OUT,  F, 'Rayleigh damping'), &
      engine_word_t('INIV',  ENGINE_READ, F, 'velocities of nodes at the start'), &
      engine_word_t('IMPL',  ENGINE_OUT,  F, 'implicit solution'), &
      engine_word_t('EIG',   ENGINE_OUT,  F, 'eigenmodes'), &
      engine_word_t('THERM', ENGINE_OUT,  F, 'heat'), &
      engine_word_t('ALE',   ENGINE_OUT,  F, 'fluids'), &
      engine_word_t('INTER', ENGINE_OUT,  F, 'contact'), &
      engine_word_t('RLINK', ENGINE_OUT,  F, 'rigid links that are switched'), &
      engine_word_t('VEL',   ENGINE_OUT,  F, 'nodes that move alike'), &
      engine_word_t('FXINP', ENGINE_OUT,  F, 'flexible bodies'), &
      engine_word_t('MADYM', ENGINE_OUT,  F, 'a coupled run'), &
      engine_word_t('RAD2R', ENGINE_OUT,  F, 'a coupled run'), &
      engine_word_t('PYTHO', ENGINE_OUT,  F, 'functions in Python'), &
      engine_word_t('DELIN', ENGINE_NOTE, F, 'contacts that are deleted'), &
      engine_word_t('FVMBA', ENGINE_NOTE, F, 'airbags'), &
      engine_word_t('EBCS',  ENGINE_NOTE, F, 'fluids'), &
      engine_word_t('UPWM',  ENGINE_NOTE, F, 'fluids'), &
      engine_word_t('INCMP', ENGINE_NOTE, F, 'fluids'), &
      engine_word_t('SHVER', ENGINE_NOTE, F, 'shell elements'), &
      engine_word_t('SHSUB', ENGINE_NOTE, F, 'shell elements'), &
      engine_word_t('OUTPU', ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t('PATRA', ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t('REPOR', ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t('CHECK', ENGINE_NOTE, F, 'check sums of the deck')]

contains

   !> Row of an engine keyword; 0 when there is none
   pure integer function find_engine_word(word) result(row)
      character(len=*), intent(in) :: word     !! its first five characters count

      do row = 1, size(engine_words)
         if (engine_words(row)%name == word(:min(5, len(word)))) return
      end do
      row = 0
   end function find_engine_word

   !> The first word of a header is one of an engine deck
   pure logical function is_engine_word(path)
      character(len=*), intent(in) :: path      !! words between slashes: DT/NODA

      is_engine_word = find_engine_word(path(:index(path//'/', '/') - 1)) > 0
   end function is_engine_word

end module kj_engine_words
