!> Messages of the engine deck, under the numbers of OpenRadioss with an E.
module kj_message_engine
   use kj_error, only: SEV_ERROR
   use kj_message_row, only: message_t
   implicit none
   private

   type(message_t), parameter, public :: engine_messages(*) = [ &
   message_t('KJ-E073', SEV_ERROR, 'a keyword lacks values', &
      'The line after the keyword has fewer numbers than it needs, or is missing.', &
      'Write the values on the next line, between blanks or commas.'), &
   message_t('KJ-E189', SEV_ERROR, 'not an engine keyword', &
      'Only the first five characters of a word count, in upper case; Radioss stops at '// &
      'all others.', &
      'Correct the keyword.'), &
   message_t('KJ-E194', SEV_ERROR, 'the engine deck has no /RUN', &
      'Without /RUN there is no end of the run.', &
      'Write /RUN/name/1 and on the next line the end time.'), &
   message_t('KJ-E195', SEV_ERROR, 'the run number is not positive', &
      'The last number of /RUN must be 1 or more.', &
      'Write /RUN/name/1.'), &
   message_t('KJ-E196', SEV_ERROR, 'the version of the engine deck is too old', &
      '/VERS must be 18 or more.', &
      'Write the version, for example /VERS/2022.'), &
   message_t('KJ-E198', SEV_ERROR, 'the version of the history file does not exist', &
      '/TH/VERS must be 40 or more.', &
      'Remove the keyword: kjoint does not need it.'), &
   message_t('KJ-E246', SEV_ERROR, 'no such kind of nodal time step', &
      '/DT/NODA/DEL and /DT/NODE do not exist.', &
      'Use /DT/NODA, /DT/NODA/CST or /DT/NODA/STOP.'), &
   message_t('KJ-E316', SEV_ERROR, 'the first time step is larger than the largest', &
      '/DTIX has the first and the largest time step, in this order.', &
      'Exchange them, or write 0 for a largest step without limit.')]

end module kj_message_engine
