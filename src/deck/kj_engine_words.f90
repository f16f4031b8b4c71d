!> THE table of engine keywords. Only the first five characters of a word count.
module kj_engine_words
   implicit none
   private

   public :: engine_word_t, find_engine_word

   integer, parameter, public :: EN_RUN = 1, EN_TITLE = 2, EN_VERS = 3, EN_TFILE = 4, &
      EN_PRINT = 5, &
      EN_DT = 6, EN_DTIX = 7, EN_TH = 8, EN_STOP = 9, EN_END = 10, EN_OTHER = 11

   !> What becomes of a keyword
   integer, parameter, public :: ENGINE_READ = 1, ENGINE_NOTE = 2, ENGINE_OUT = 3

   !> A row of the table
   type :: engine_word_t
      integer           :: id          !! EN_ constant
      character(len=5)  :: name        !! first word of the header
      integer           :: status      !! ENGINE_ constant
      logical           :: once        !! of two of them the first holds
      character(len=60) :: meaning     !! ENGINE_OUT: what would be needed
   end type engine_word_t

   logical, parameter :: T = .true., F = .false.

   type(engine_word_t), parameter, public :: engine_words(*) = [ &
      engine_word_t(EN_RUN,   'RUN',   ENGINE_READ, T, 'run number and end of the run'), &
      engine_word_t(EN_TITLE, 'TITLE', ENGINE_READ, T, 'title, not used'), &
      engine_word_t(EN_VERS,  'VERS',  ENGINE_READ, T, 'version of the deck'), &
      engine_word_t(EN_TFILE, 'TFILE', ENGINE_READ, T, 'interval of the histories'), &
      engine_word_t(EN_PRINT, 'PRINT', ENGINE_READ, T, 'cycles between two lines of the listing'), &
      engine_word_t(EN_DT,    'DT',    ENGINE_READ, F, 'factor and least value of the time step'), &
      engine_word_t(EN_DTIX,  'DTIX',  ENGINE_READ, T, 'first and largest time step'), &
      engine_word_t(EN_TH,    'TH',    ENGINE_NOTE, F, 'form of the T01 file: none is written'), &
      engine_word_t(EN_STOP,  'STOP',  ENGINE_READ, T, 'limits of energy and mass errors'), &
      engine_word_t(EN_STOP,  'KILL',  ENGINE_READ, T, 'limits of energy and mass errors'), &
      engine_word_t(EN_END,   'END',   ENGINE_READ, F, 'end of the deck'), &
      engine_word_t(EN_OTHER, 'RFILE', ENGINE_NOTE, F, 'restart files of other solvers'), &
      engine_word_t(EN_OTHER, 'ATFIL', ENGINE_NOTE, F, 'history in a file A: not written'), &
      engine_word_t(EN_OTHER, 'BTFIL', ENGINE_NOTE, F, 'history in a file B: not written'), &
      engine_word_t(EN_OTHER, 'CTFIL', ENGINE_NOTE, F, 'history in a file C: not written'), &
      engine_word_t(EN_OTHER, 'DTFIL', ENGINE_NOTE, F, 'history in a file D: not written'), &
      engine_word_t(EN_OTHER, 'ETFIL', ENGINE_NOTE, F, 'history in a file E: not written'), &
      engine_word_t(EN_OTHER, 'FTFIL', ENGINE_NOTE, F, 'history in a file F: not written'), &
      engine_word_t(EN_OTHER, 'GTFIL', ENGINE_NOTE, F, 'history in a file G: not written'), &
      engine_word_t(EN_OTHER, 'HTFIL', ENGINE_NOTE, F, 'history in a file H: not written'), &
      engine_word_t(EN_OTHER, 'ITFIL', ENGINE_NOTE, F, 'history in a file I: not written'), &
      engine_word_t(EN_OTHER, 'ANIM',  ENGINE_NOTE, F, 'animation files: not written'), &
      engine_word_t(EN_OTHER, 'H3D',   ENGINE_NOTE, F, 'animation files: not written'), &
      engine_word_t(EN_OTHER, 'OUTP',  ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t(EN_OTHER, 'STATE', ENGINE_NOTE, F, 'state files: not written'), &
      engine_word_t(EN_OTHER, 'DYNAI', ENGINE_NOTE, F, 'state files: not written'), &
      engine_word_t(EN_OTHER, 'ABF',   ENGINE_NOTE, F, 'output files: not written'), &
      engine_word_t(EN_OTHER, 'MON',   ENGINE_NOTE, F, 'timing of other solvers'), &
      engine_word_t(EN_OTHER, 'PROC',  ENGINE_NOTE, F, 'parallel run of other solvers'), &
      engine_word_t(EN_OTHER, 'SPMD',  ENGINE_NOTE, F, 'parallel run of other solvers'), &
      engine_word_t(EN_OTHER, 'PARIT', ENGINE_NOTE, F, 'order of sums; ours never depends on threads'), &
      engine_word_t(EN_OTHER, 'DEBUG', ENGINE_NOTE, F, 'debugging of other solvers'), &
      engine_word_t(EN_OTHER, 'PERF',  ENGINE_NOTE, F, 'timing of other solvers'), &
      engine_word_t(EN_OTHER, 'NEGVO', ENGINE_NOTE, F, 'solid elements'), &
      engine_word_t(EN_OTHER, 'UPWIN', ENGINE_NOTE, F, 'fluids'), &
      engine_word_t(EN_OTHER, 'BCS',   ENGINE_OUT,  F, 'conditions that change: write them into the starter deck'), &
      engine_word_t(EN_OTHER, 'BCSR',  ENGINE_OUT,  F, 'conditions that are released'), &
      engine_word_t(EN_OTHER, 'DEL',   ENGINE_OUT,  F, 'elements that are deleted: leave them out of the deck'), &
      engine_word_t(EN_OTHER, 'RBODY', ENGINE_OUT,  F, 'rigid bodies that are switched'), &
      engine_word_t(EN_OTHER, 'KEREL', ENGINE_OUT,  F, 'kinetic-energy relaxation'), &
      engine_word_t(EN_OTHER, 'DYREL', ENGINE_OUT,  F, 'dynamic relaxation'), &
      engine_word_t(EN_OTHER, 'ADYRE', ENGINE_OUT,  F, 'dynamic relaxation'), &
      engine_word_t(EN_OTHER, 'DAMP',  ENGINE_OUT,  F, 'Rayleigh damping'), &
      engine_word_t(EN_OTHER, 'INIV',  ENGINE_OUT,  F, 'velocities at a restart: use /INIVEL in the starter deck'), &
      engine_word_t(EN_OTHER, 'IMPL',  ENGINE_OUT,  F, 'implicit solution'), &
      engine_word_t(EN_OTHER, 'EIG',   ENGINE_OUT,  F, 'eigenmodes'), &
      engine_word_t(EN_OTHER, 'THERM', ENGINE_OUT,  F, 'heat'), &
      engine_word_t(EN_OTHER, 'ALE',   ENGINE_OUT,  F, 'fluids'), &
      engine_word_t(EN_OTHER, 'INTER', ENGINE_OUT,  F, 'contact')]

contains

   !> Row of an engine keyword; 0 when there is none
   pure integer function find_engine_word(word) result(row)
      character(len=*), intent(in) :: word     !! its first five characters count

      do row = 1, size(engine_words)
         if (engine_words(row)%name == word(:min(5, len(word)))) return
      end do
      row = 0
   end function find_engine_word

end module kj_engine_words
