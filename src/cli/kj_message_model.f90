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
      'Write 0 for the frame.'), &
   message_t('KJ-9126', SEV_ERROR, 'a negative stiffness or limit of friction', &
      'Kfr and FM of a /PROP/KJOINT2 must not be below zero.', &
      'Correct the sign, or write 0 for no friction.'), &
   message_t('KJ-9127', SEV_WARNING, 'nothing to combine', &
      'Icomb combines stops, but a direction that it names has none.', &
      'Give SA- or SA+, or write 0 for Icomb.'), &
   message_t('KJ-9128', SEV_WARNING, 'the axes of a universal joint were made perpendicular', &
      'The directions from node 1 to node 3 and to node 4 are not perpendicular, so the '// &
      'second axis was turned in their plane.', &
      'Move node 3 or node 4.'), &
   message_t('KJ-9129', SEV_WARNING, 'a second skew with id 1 or 2', &
      'OpenRadioss reads the first angles of a KJOINT2 only from a second skew whose id is '// &
      'above 2, and starts with undefined ones else. Here they are read.', &
      'Give the skew another id.'), &
   message_t('KJ-9130', SEV_ERROR, 'a joint end without mass', &
      'An end of a KJOINT2 is a secondary node of a rigid body or a node with mass.', &
      'Add mass by /ADMAS, or make the node a secondary node.'), &
   message_t('KJ-9201', SEV_WARNING, 'legacy: first-skew frame with a length', &
      'Half the moment of the force goes to each body although the frame turns with body '// &
      '1 only: energy is created or lost.', &
      'Run the consistent formulation, or make the two nodes coincide.'), &
   message_t('KJ-9202', SEV_WARNING, 'legacy: universal joint', &
      'It measures in a frame that it does not push in, so some percent of the energy are'// &
      ' lost or won.', &
      'Run the consistent formulation.'), &
   message_t('KJ-9203', SEV_WARNING, 'legacy: a falling stiffness curve', &
      'The scheme takes the root of the slope for its damping and gets NaN where the '// &
      'curve falls.', &
      'Run the consistent formulation, or let the curve rise.'), &
   message_t('KJ-9204', SEV_WARNING, 'legacy: a curve above f(0) at negative abscissae', &
      'The stiffness that steers the time step becomes a force over a tiny displacement: '// &
      'the time step collapses.', &
      'Run the consistent formulation, or shift the curve.'), &
   message_t('KJ-9205', SEV_WARNING, 'legacy: two loads share a function', &
      'Of two concentrated loads in a row that use one function the scheme takes the '// &
      'value of the first for both.', &
      'Give each load its own function.'), &
   message_t('KJ-9207', SEV_WARNING, 'legacy: joints share a property with limits', &
      'OpenRadioss switches the damping of a direction for all joints of a /PROP/KJOINT2 as '// &
      'soon as one is at its limit, and mixes up their friction. Here each joint is alone.', &
      'Give each joint its own property where results are to agree.'), &
   message_t('KJ-9208', SEV_WARNING, 'legacy: friction on a universal joint', &
      'OpenRadioss keeps friction and axes of a universal KJOINT2 in one place, so each '// &
      'spoils the other. Here they are kept apart.', &
      'Leave the friction out where results are to agree.'), &
   message_t('KJ-9206', SEV_WARNING, 'legacy: a large turn in a step', &
      'The scheme is first order in the spin and lets the nodes of a body drift outward.', &
      'Lower the time step, or run the consistent formulation.'), &
   message_t('KJ-9216', SEV_WARNING, 'a joint frame is not rigid', &
      'The axes of a joint have turned against each other, or against the body that should '// &
      'carry them, by more than 1e-3 rad. The channel joint/orthogonality has it over time.', &
      'Put the nodes of the skew on the body of its joint node; or raise the stiffness.')]

end module kj_message_model
