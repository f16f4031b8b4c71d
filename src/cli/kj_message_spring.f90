!> Our own messages on springs of /PROP/TYPE4 and /PROP/TYPE8.
module kj_message_spring
   use kj_error, only: SEV_ERROR, SEV_WARNING
   use kj_message_row, only: message_t
   implicit none
   private

   type(message_t), parameter, public :: spring_messages(*) = [ &
   message_t('KJ-9220', SEV_ERROR, 'springs that a sensor switches', &
      'A spring with sens_ID acts only while the sensor is active; that is not supported.', &
      'Write 0. A joint of /PROP/KJOINT2 can be locked by a sensor.'), &
   message_t('KJ-9221', SEV_ERROR, 'springs that fail', &
      'Beyond delta_min and delta_max a spring of Radioss breaks; that is not supported.', &
      'Write 0 in both: the spring never breaks.'), &
   message_t('KJ-9222', SEV_ERROR, 'springs with hardening or hysteresis', &
      'Only elastic springs are supported: H = 0. The other rules H unload on another path, or '// &
      'read the function otherwise.', &
      'Write 0, or model the hysteresis by friction of a /PROP/KJOINT2.'), &
   message_t('KJ-9223', SEV_ERROR, 'springs with laws per unit of length', &
      'With Ileng = 1 mass, stiffness, damping and the functions are those of a spring of '// &
      'length 1.', &
      'Write 0, and give the values of the spring as it is.'), &
   message_t('KJ-9224', SEV_ERROR, 'springs whose elastic force depends on the rate', &
      'B and fct2 multiply the function fct1 by a factor of the rate; that is not supported.', &
      'Remove them. Damping of its own is C, or Hscale with the function fct4.'), &
   message_t('KJ-9225', SEV_WARNING, 'an option of a spring has no effect', &
      'The value acts only together with another one that is not there.', &
      'Remove it, or give the other one.'), &
   message_t('KJ-9226', SEV_ERROR, 'springs with filtered rates', &
      'Fsmooth = 1 smooths the rates that damping sees; that is not supported.', &
      'Write 0.'), &
   message_t('KJ-9227', SEV_ERROR, 'a couple for axes that are fixed in space', &
      'With axes that ride on a body the couple of the offset force goes to that body, always. '// &
      'Axes fixed in space take it themselves; a couple on the nodes would do work for nothing.', &
      'Write Iequil = 0, or name a moving skew.'), &
   message_t('KJ-9228', SEV_ERROR, 'the skew of a spring rides on neither of its ends', &
      'The consistent formulation turns the axes of a spring with the rigid body of one of '// &
      'its nodes; the three nodes of the skew must belong to it.', &
      'Name a skew of such nodes or a fixed one, or run with --legacy.'), &
   message_t('KJ-9229', SEV_WARNING, 'a spring node without mass', &
      'Nothing can move a node without mass: it is a fixed point, unless it starts with a '// &
      'velocity.', &
      'Give it mass by /ADMAS or by the mass of the spring, or hold it by /BCS to say so.'), &
   message_t('KJ-9230', SEV_ERROR, 'a scale of abscissae is negative', &
      'It would turn the function round.', &
      'Mirror the function with /MOVE_FUNCT.') &
   ]

end module kj_message_spring
