!> Our own messages on the model.
module kj_message_model
   use kj_error, only: SEV_ERROR, SEV_WARNING
   use kj_message_row, only: message_t
   implicit none
   private

   type(message_t), parameter, public :: model_messages(*) = [ &
   message_t('KJ-9110', SEV_ERROR, 'the direction of a skew is wrong', &
      'DIR of a /SKEW/MOV is X, Y or Z; blank is X.', &
      'Write one of them in columns 31 to 40, in upper case.'), &
   message_t('KJ-9112', SEV_ERROR, 'a function without points', &
      'The /FUNCT has a title, but no card.', &
      'Add points.'), &
   message_t('KJ-9114', SEV_ERROR, 'no such rule of the centre of gravity', &
      'ICoG is 1 to 4; 0 is 1.', &
      'Write one of them.'), &
   message_t('KJ-9115', SEV_ERROR, 'no such rule of the inertia', &
      'Ispher is 1 to 3; 0 is 2.', &
      'Write one of them.'), &
   message_t('KJ-9116', SEV_ERROR, 'rigid bodies with a sensor', &
      'Bodies that a sensor activates are not supported.', &
      'Write 0 for the sensor.'), &
   message_t('KJ-9117', SEV_ERROR, 'initial velocities that come later', &
      'An initial velocity after a start time or a sensor is not supported.', &
      'Write 0 for both.'), &
   message_t('KJ-9118', SEV_ERROR, 'the blocking stiffness is negative', &
      'Kn holds the blocked directions and must be positive.', &
      'Correct the sign.'), &
   message_t('KJ-9119', SEV_WARNING, 'a joint without a second skew', &
      'With skew flag 0 and no skew on body 2 OpenRadioss works on undefined data; the '// &
      'card is read as skew flag 1.', &
      'Set the skew flag to 1, or name a second skew.'), &
   message_t('KJ-9120', SEV_ERROR, 'both ends of a joint are one node', &
      'A joint connects two nodes.', &
      'Use two nodes; they may have the same place.'), &
   message_t('KJ-9121', SEV_ERROR, 'no mean frame', &
      'The skews of the joint are 180 degrees apart, so they have no mean.', &
      'Turn one of the skews, or set the skew flag to 1.'), &
   message_t('KJ-9122', SEV_WARNING, 'the direction of gravity is taken as Z', &
      'The direction of a /GRAV is X, Y or Z; Radioss takes all others for Z.', &
      'Write the direction in columns 11 to 20, in upper case.'), &
   message_t('KJ-9123', SEV_ERROR, 'the function of a load or motion does not exist', &
      'The card names a function that no /FUNCT defines.', &
      'Define the function, or correct the id.'), &
   message_t('KJ-9124', SEV_ERROR, 'no such kind of abscissa', &
      'Itypfun of a /CLOAD is 0 or 1 for time, 2 for displacement, 3 for velocity.', &
      'Write one of them.'), &
   message_t('KJ-9125', SEV_ERROR, 'imposed motion in a frame', &
      'An imposed motion relative to a frame is not supported.', &
      'Write 0 for the frame.')]

end module kj_message_model
