!> Our own messages on groups, axes, bodies, loads and requests.
module kj_message_scene
   use kj_error, only: SEV_ERROR, SEV_WARNING
   use kj_message_row, only: message_t
   implicit none
   private

   type(message_t), parameter, public :: scene_messages(*) = [ &
   message_t('KJ-9131', SEV_ERROR, 'rigid parts', &
      'A /PART with Irigid makes its nodes a rigid body; that is not supported.', &
      'Write 0, and put the nodes into a /RBODY.'), &
   message_t('KJ-9132', SEV_WARNING, 'a range of ids ends before it begins', &
      'The first id of a range is above the last, so there is no node in it.', &
      'Exchange the two ids.'), &
   message_t('KJ-9133', SEV_ERROR, 'the increment of a range is not positive', &
      '/GRNOD/GEN_INCR has first id, last id and increment.', &
      'Write an increment of 1 or more.'), &
   message_t('KJ-9134', SEV_WARNING, 'a negative node id', &
      'Radioss ignores it in a list of nodes and says nothing.', &
      'Remove it. Nodes are taken away by a negative group id in /GRNOD/GRNOD.'), &
   message_t('KJ-9135', SEV_WARNING, 'a group of boxes names one that does not exist', &
      'Radioss makes the group empty and does not name the box.', &
      'Define the box, or correct the id.'), &
   message_t('KJ-9136', SEV_ERROR, 'node groups name each other in a circle', &
      'A group is made of one that is made of the first.', &
      'Break the circle.'), &
   message_t('KJ-9137', SEV_ERROR, 'a range without its end', &
      'NODE_G, PART_G and SPRING_G have pairs of ids: first and last.', &
      'Add the last id.'), &
   message_t('KJ-9138', SEV_ERROR, 'clauses that remove', &
      'A negative id in a /SET takes nodes away; that is not supported.', &
      'Use /GRNOD/GRNOD with a negative group id.'), &
   message_t('KJ-9139', SEV_ERROR, 'a reference to something that is not supported', &
      'The card names an entity whose keyword is out of scope.', &
      'Replace the entity by one of a supported kind, or remove the reference.'), &
   message_t('KJ-9140', SEV_WARNING, 'a set names an element that does not exist', &
      'It adds no node.', &
      'Correct the id.'), &
   message_t('KJ-9141', SEV_ERROR, 'a clause of a /SET is not supported', &
      'Only sets of nodes are read: NODE, PART, SPRING, BOX and SET, with _G for ranges.', &
      'List the nodes, or use a /GRNOD.'), &
   message_t('KJ-9142', SEV_WARNING, 'a box with a skew and typed corners', &
      'The corners are taken as points in global axes, the edges as along the skew.', &
      'Name nodes as corners where the coordinates are meant in the skew.'), &
   message_t('KJ-9143', SEV_ERROR, 'the axes of a skew or frame are degenerate', &
      'The Y and the Z vector are along one line, or zero; a frame has no default for '// &
      'them.', &
      'Give two vectors that span a plane.'), &
   message_t('KJ-9144', SEV_ERROR, 'a node id is not positive', &
      'Ids are 1 or more; a blank line is a node with the id 0.', &
      'Correct the id, or remove the line.'), &
   message_t('KJ-9145', SEV_ERROR, 'a function to move does not exist', &
      'The id of a /MOVE_FUNCT is that of the function it changes.', &
      'Define the function, or correct the id.'), &
   message_t('KJ-9146', SEV_ERROR, 'a moved function has equal abscissae', &
      'The scale of a /MOVE_FUNCT is so small, or its shift so large, that neighbouring '// &
      'points fall together.', &
      'Correct the scale and the shift.'), &
   message_t('KJ-9147', SEV_WARNING, 'a sensor stops before it starts', &
      'Tstop is below Tdelay; Radioss takes Tdelay.', &
      'Correct the times, or write 0 for never.'), &
   message_t('KJ-9148', SEV_ERROR, 'plane and axisymmetric scenes', &
      'N2D3D of /ANALY must be 0: joints are of three dimensions.', &
      'Write 0.'), &
   message_t('KJ-9149', SEV_ERROR, 'disturbed coordinates', &
      '/RANDOM moves nodes by chance; that is not supported.', &
      'Write 0, or remove the block.'), &
   message_t('KJ-9150', SEV_ERROR, 'rigid bodies that fail', &
      'Ifail of a /RBODY releases nodes above a force; that is not supported.', &
      'Write 0.'), &
   message_t('KJ-9151', SEV_ERROR, 'a rigid body on a rigid body', &
      'The main node of a body is a secondary node of another one.', &
      'Join the bodies by a joint of type 8, or make them one.'), &
   message_t('KJ-9152', SEV_WARNING, 'an initial velocity without effect', &
      'Secondary nodes follow the main node of their body; velocities on them are '// &
      'overwritten.', &
      'Give the velocity to the main node.'), &
   message_t('KJ-9153', SEV_ERROR, 'histories relative to a frame', &
      'A /TH/NODE may name a skew for its components; frames are not supported.', &
      'Name a skew, or 0.'), &
   message_t('KJ-9154', SEV_WARNING, 'a boundary condition without effect', &
      'Secondary nodes follow the main node of their body.', &
      'Put the main node into the group.'), &
   message_t('KJ-9155', SEV_WARNING, 'gravity without effect', &
      'A body feels gravity only where its main node is in the group.', &
      'Put the main node into the group, or write 0 for all nodes.'), &
   message_t('KJ-9156', SEV_WARNING, 'histories of parts', &
      '/TH/PART is read and checked, but nothing is written for it.', &
      'See the histories of joints and bodies.'), &
   message_t('KJ-9157', SEV_WARNING, 'a rigid body without mass', &
      'Radioss takes 1e-20, so the body can move only where it is held or driven.', &
      'Give the body a mass on its card or on its nodes.'), &
   message_t('KJ-9209', SEV_WARNING, 'legacy: the scale of a load over displacement or velocity', &
      'OpenRadioss converts it as a time.', &
      'Use the same input and work units.'), &
   message_t('KJ-9210', SEV_WARNING, 'legacy: functions of a joint where units differ', &
      'OpenRadioss multiplies the scale by M/T or 1/T once more and converts the '// &
      'abscissae by wrong factors.', &
      'Use the same input and work units, or run the consistent formulation.')]

end module kj_message_scene
