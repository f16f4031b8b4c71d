!> Messages on the scene: nodes, groups, axes, functions, rigid bodies, loads, motion, conditions.
module kj_message_scene
   use kj_error, only: SEV_ERROR, SEV_WARNING
   use kj_message_text, only: message_t
   implicit none
   private

   type(message_t), parameter, public :: scene_messages(*) = [ &
   message_t('KJ-0003', SEV_ERROR, 'the deck has no node', 'No /NODE block has a card, or the block is misspelt.', &
      'Define nodes in /NODE, in upper case.'), &
   message_t('KJ-0053', SEV_ERROR, 'the node group does not exist', &
      'A card names a group of nodes that neither /GRNOD nor /SET defines.', &
      'Define the group, or correct its id.'), &
   message_t('KJ-0056', SEV_ERROR, 'a node is defined twice', &
      'Two cards have the same node id, be it in one /NODE block or in two. Equal coordinates '// &
      'do not help.', 'Remove one of them, or give it a new id.'), &
   message_t('KJ-0078', SEV_ERROR, 'a node does not exist', &
      'A card names a node that no /NODE defines. A blank card in a list of nodes is the node 0.', &
      'Define the node, or correct the id.'), &
   message_t('KJ-0137', SEV_ERROR, 'the skew or frame does not exist', &
      'A card names a skew or frame that no /SKEW or /FRAME defines.', &
      'Define it, correct the id, or write 0 for the global axes.'), &
   message_t('KJ-0147', SEV_WARNING, 'imposed motion of a secondary node', &
      'A secondary node follows its rigid body, so an imposed motion on it has no effect.', &
      'Impose the motion on the main node.'), &
   message_t('KJ-0148', SEV_ERROR, 'two boundary conditions in different skews', &
      'A node has boundary conditions in two sets of axes, which cannot be combined.', &
      'Use one skew for all conditions of a node.'), &
   message_t('KJ-0149', SEV_ERROR, 'the direction of the load is wrong', &
      'The direction of a /CLOAD is not X, Y, Z, XX, YY or ZZ.', &
      'Write one of them in columns 11 to 20, in upper case.'), &
   message_t('KJ-0154', SEV_ERROR, 'the function of gravity does not exist', 'A /GRAV names a function that no /FUNCT defines.', &
      'Define the function, or write 0 for constant gravity.'), &
   message_t('KJ-0156', SEV_ERROR, 'abscissae do not increase', 'The points of a /FUNCT must have strictly increasing abscissae.', &
      'Sort the points and remove double ones.'), &
   message_t('KJ-0158', SEV_ERROR, 'the surface of a rigid body is wrong', &
      'An /RBODY names an enveloping surface that does not exist or has the wrong kind.', &
      'Write 0: kjoint needs no surface.'), &
   message_t('KJ-0159', SEV_ERROR, 'the surface of a rigid body is wrong', &
      'An /RBODY names an enveloping surface that does not exist or has the wrong kind.', &
      'Write 0: kjoint needs no surface.'), &
   message_t('KJ-0162', SEV_ERROR, 'two nodes of a skew coincide', &
      'Nodes 1 and 2 of a moving skew have the same place, so there is no first axis.', &
      'Choose nodes that are apart.'), &
   message_t('KJ-0163', SEV_WARNING, 'the nodes of a skew are on one line', &
      'Nodes 1, 2 and 3 of a moving skew leave the second axis free.', &
      'Move node 3 off the line.'), &
   message_t('KJ-0164', SEV_ERROR, 'the direction of the imposed motion is wrong', 'The direction is not X, Y, Z, XX, YY or ZZ.', &
      'Write one of them in columns 11 to 20, in upper case.'), &
   message_t('KJ-0174', SEV_WARNING, 'a group of groups names one that does not exist', &
      'A /GRNOD/GRNOD names a group that no block defines; it is left out.', 'Correct the id.'), &
   message_t('KJ-0184', SEV_ERROR, 'the skew of an initial velocity does not exist', &
      'An /INIVEL names a skew that no /SKEW defines.', 'Define the skew, or write 0.'), &
   message_t('KJ-0194', SEV_WARNING, 'a group of parts names one that does not exist', &
      'A /GRNOD/PART names a part that no /PART defines; it is left out.', 'Correct the id.'), &
   message_t('KJ-0274', SEV_ERROR, 'the inertia of a rigid body is not positive', &
      'The smallest principal inertia is zero or negative.', &
      'Give the body inertia, or secondary nodes with mass that are not on a line.'), &
   message_t('KJ-0275', SEV_WARNING, 'the inertia of a slender rigid body was raised', &
      'A principal inertia is under a thousandth of the largest one; with Ispher 2, the '// &
      'default, a tenth of the largest is added to it.', &
      'Choose Ispher 3 to keep the inertia as typed.'), &
   message_t('KJ-0312', SEV_WARNING, 'incompatible kinematic conditions', 'A node is moved by two conditions at a time.', &
      'Keep one of them.'), &
   message_t('KJ-0352', SEV_WARNING, 'a rigid body without secondary nodes', &
      'The body has no group, or an empty one; joints can hold on secondary nodes only.', &
      'Name a group of nodes in columns 61 to 70.'), &
   message_t('KJ-0442', SEV_ERROR, 'two rigid bodies share a main node', 'A main node carries the motion of one body.', &
      'Give each body its own main node.'), &
   message_t('KJ-0448', SEV_WARNING, 'a main node belongs to an element', &
      'The main node of a rigid body is also the end of a spring.', 'Use a secondary node.'), &
   message_t('KJ-0476', SEV_WARNING, 'an added mass is negative', '/ADMAS takes mass away from its nodes.', 'Check the sign.'), &
   message_t('KJ-0490', SEV_ERROR, 'the frame of an initial velocity does not exist', &
      'An /INIVEL/AXIS names a frame that no /FRAME defines.', &
      'Define the frame, or write 0 for the global one.'), &
   message_t('KJ-0491', SEV_ERROR, 'a skew and a frame are given together', &
      'An imposed motion has directions in a skew or in a frame, not in both.', &
      'Write 0 for one of them.'), &
   message_t('KJ-0521', SEV_ERROR, 'the sensor does not exist', 'A card names a sensor that no /SENSOR defines.', &
      'Define the sensor, or correct the id.'), &
   message_t('KJ-0542', SEV_WARNING, 'the inertia is not that of a solid', &
      'The largest principal inertia is above the sum of the others, which no solid has.', &
      'Check the inertia; the run goes on with it.'), &
   message_t('KJ-0668', SEV_ERROR, 'the node group does not exist', 'The card needs a group of nodes that exists.', &
      'Define the group, or correct the id.'), &
   message_t('KJ-0678', SEV_ERROR, 'the group of a boundary condition does not exist', &
      'A /BCS names a group that no block defines.', &
      'Define the group, or correct the id in columns 21 to 30.'), &
   message_t('KJ-0679', SEV_ERROR, 'the rigid body has no mass', 'The masses of the card and of the nodes add up to nothing.', &
      'Give the body a mass.'), &
   message_t('KJ-0690', SEV_WARNING, 'an empty node group', 'The group has no node that exists; loads on it do nothing.', &
      'Check the ids. Cards from an included file belong to that file''s own blocks.'), &
   message_t('KJ-0845', SEV_ERROR, 'a moment on nodes without rotation', 'The nodes of the load have no rotational direction.', &
      'Put the moment on a node of a rigid body.'), &
   message_t('KJ-0871', SEV_ERROR, 'the node of an added mass does not exist', &
      'A card of /ADMAS/5 names a node that no /NODE defines.', &
      'Define the node, or correct the id in columns 21 to 30.'), &
   message_t('KJ-0900', SEV_ERROR, 'a frame on a node needs its node', 'A /FRAME/NOD has no node n1.', 'Name the node.'), &
   message_t('KJ-0933', SEV_ERROR, 'the axis is wrong', 'The axis of an /INIVEL/AXIS is not X, Y or Z.', &
      'Write one of them, in upper case.'), &
   message_t('KJ-1051', SEV_ERROR, 'a wrong code of a boundary condition', &
      'The digits in columns 4 to 6 and 8 to 10 of /BCS must be 0 or 1.', &
      'Write 1 for blocked, 0 for free.'), &
   message_t('KJ-1066', SEV_ERROR, 'a main node belongs to an element', &
      'The main node of a rigid body is also the end of a spring.', 'Use a secondary node.'), &
   message_t('KJ-1252', SEV_ERROR, 'the sensor of an initial velocity does not exist', &
      'An /INIVEL names a sensor that no /SENSOR defines.', 'Define it, or write 0.'), &
   message_t('KJ-1624', SEV_WARNING, 'the main node is among the secondary nodes', 'It was removed from the group of the body.', &
      'Remove it from the group.'), &
   message_t('KJ-1874', SEV_WARNING, 'a function with less than two points', 'One point is a constant function.', &
      'Add a point, if something else is meant.'), &
   message_t('KJ-3026', SEV_WARNING, 'a load on an empty group', 'The group of the load has no node.', 'Check the ids.'), &
   message_t('KJ-3091', SEV_ERROR, 'a frame is driven by its own nodes', &
      'The node with the imposed motion is one of those that define the frame.', &
      'Define the frame by other nodes.'), &
   message_t('KJ-3121', SEV_ERROR, 'a node is in two rigid bodies', 'A node can be a secondary node of one body only.', &
      'Remove it from one of the groups.'), &
   message_t('KJ-3122', SEV_WARNING, 'the rigid body has no main node', 'A node is made at the origin, its id one '// &
      'above the largest. A Mass of the card sits there; with ICoG 3, 4 the body turns about it.', &
      'Define a node and name it in columns 1 to 10.'), &
   message_t('KJ-3151', SEV_WARNING, 'the inertia of an added mass', '/ADMAS with inertia: only Ixx is used.', &
      'Check the inertia.'), &
   message_t('KJ-3152', SEV_WARNING, 'the inertia of an added mass', '/ADMAS with inertia: only Ixx is used.', &
      'Check the inertia.'), &
   message_t('KJ-9110', SEV_ERROR, 'the direction of a skew is wrong', 'DIR of a /SKEW/MOV is X, Y or Z; blank is X.', &
      'Write one of them in columns 31 to 40, in upper case.'), &
   message_t('KJ-9112', SEV_ERROR, 'a function without points', 'The /FUNCT has a title, but no card.', 'Add points.'), &
   message_t('KJ-9114', SEV_ERROR, 'no such rule of the centre of gravity', 'ICoG is 1 to 4; 0 is 1.', 'Write one of them.'), &
   message_t('KJ-9115', SEV_ERROR, 'no such rule of the inertia', 'Ispher is 1 to 3; 0 is 2.', 'Write one of them.'), &
   message_t('KJ-9116', SEV_ERROR, 'a rigid body that is none at the start', 'Its sensor has a Tdelay above 0: until then '// &
      'its nodes move by themselves.', 'Write 0 for Tdelay, or for the sensor.'), &
   message_t('KJ-9117', SEV_ERROR, 'initial velocities that come later', &
      'An initial velocity after a start time or a sensor is not supported.', &
      'Write 0 for both.'), &
   message_t('KJ-9122', SEV_WARNING, 'the direction of gravity is taken as Z', &
      'The direction of a /GRAV is X, Y or Z; Radioss takes all others for Z.', &
      'Write the direction in columns 11 to 20, in upper case.'), &
   message_t('KJ-9123', SEV_ERROR, 'the function of a load or motion does not exist', &
      'The card names a function that no /FUNCT defines.', &
      'Define the function, or correct the id.'), &
   message_t('KJ-9124', SEV_ERROR, 'no such kind of abscissa', &
      'Itypfun of a /CLOAD is 0 or 1 for time, 2 for displacement, 3 for velocity.', &
      'Write one of them.'), &
   message_t('KJ-9125', SEV_ERROR, 'imposed motion in a frame', 'An imposed motion relative to a frame is not supported.', &
      'Write 0 for the frame.'), &
   message_t('KJ-9132', SEV_WARNING, 'a range of ids ends before it begins', &
      'The first id of a range is above the last, so there is no node in it.', &
      'Exchange the two ids.'), &
   message_t('KJ-9133', SEV_ERROR, 'the increment of a range is not positive', &
      '/GRNOD/GEN_INCR has first id, last id and increment.', 'Write an increment of 1 or more.'), &
   message_t('KJ-9134', SEV_WARNING, 'a negative node id', 'Radioss ignores it in a list of nodes and says nothing.', &
      'Remove it. Nodes are taken away by a negative group id in /GRNOD/GRNOD.'), &
   message_t('KJ-9135', SEV_WARNING, 'a group of boxes names one that does not exist', &
      'Radioss makes the group empty and does not name the box.', &
      'Define the box, or correct the id.'), &
   message_t('KJ-9136', SEV_ERROR, 'node groups name each other in a circle', 'A group is made of one that is made of the first.', &
      'Break the circle.'), &
   message_t('KJ-9137', SEV_ERROR, 'a range without its end', 'NODE_G, PART_G and SPRING_G have pairs of ids: first and last.', &
      'Add the last id.'), &
   message_t('KJ-9138', SEV_ERROR, 'clauses that remove', 'A negative id in a /SET takes nodes away; that is not supported.', &
      'Use /GRNOD/GRNOD with a negative group id.'), &
   message_t('KJ-9139', SEV_ERROR, 'a reference to something that is not supported', &
      'The card names an entity whose keyword is out of scope.', &
      'Replace the entity by one of a supported kind, or remove the reference.'), &
   message_t('KJ-9140', SEV_WARNING, 'a set names an element that does not exist', 'It adds no node.', 'Correct the id.'), &
   message_t('KJ-9141', SEV_ERROR, 'a clause of a /SET is not supported', &
      'Only sets of nodes are read: NODE, PART, SPRING, BOX and SET, with _G for ranges.', &
      'List the nodes, or use a /GRNOD.'), &
   message_t('KJ-9142', SEV_WARNING, 'a box with a skew and typed corners', &
      'The corners are taken as points in global axes, the edges as along the skew.', &
      'Name nodes as corners where the coordinates are meant in the skew.'), &
   message_t('KJ-9143', SEV_ERROR, 'the axes of a skew or frame are degenerate', &
      'The Y and the Z vector are along one line, or zero; a frame has no default for them.', &
      'Give two vectors that span a plane.'), &
   message_t('KJ-9144', SEV_ERROR, 'a node id is not positive', &
      'Ids are 1 or more; a blank line is a node with the id 0, which stays by itself.', &
      'Correct the id, or remove the line.'), &
   message_t('KJ-9145', SEV_ERROR, 'a function to move does not exist', &
      'The id of a /MOVE_FUNCT is that of the function it changes.', &
      'Define the function, or correct the id.'), &
   message_t('KJ-9146', SEV_ERROR, 'a moved function has equal abscissae', &
      'The scale of a /MOVE_FUNCT is so small, or its shift so large, that neighbouring '// &
      'points fall together.', 'Correct the scale and the shift.'), &
   message_t('KJ-9147', SEV_WARNING, 'a sensor stops before it starts', 'Tstop is below Tdelay; Radioss takes Tdelay.', &
      'Correct the times, or write 0 for never.'), &
   message_t('KJ-9148', SEV_ERROR, 'plane and axisymmetric scenes', 'N2D3D of /ANALY must be 0: joints are of three dimensions.', &
      'Write 0.'), &
   message_t('KJ-9149', SEV_ERROR, 'disturbed coordinates', '/RANDOM moves nodes by chance; that is not supported.', &
      'Write 0, or remove the block.'), &
   message_t('KJ-9150', SEV_ERROR, 'rigid bodies that fail', &
      'Ifail of a /RBODY releases nodes above a force; that is not supported.', 'Write 0.'), &
   message_t('KJ-9151', SEV_ERROR, 'a rigid body on a rigid body', 'The main node of a body is a secondary node of another one.', &
      'Join the bodies by a joint of type 8, or make them one.'), &
   message_t('KJ-9152', SEV_WARNING, 'an initial velocity without effect', &
      'Secondary nodes follow the main node of their body; velocities on them are overwritten.', &
      'Give the velocity to the main node.'), &
   message_t('KJ-9154', SEV_WARNING, 'a boundary condition without effect', 'Secondary nodes follow the main node of their body.', &
      'Put the main node into the group.'), &
   message_t('KJ-9155', SEV_WARNING, 'gravity without effect', 'A body feels gravity only where its main node is in the group.', &
      'Put the main node into the group, or write 0 for all nodes.'), &
   message_t('KJ-9157', SEV_WARNING, 'a rigid body without mass', &
      'Radioss takes 1e-20, so the body can move only where it is held or driven.', &
      'Give the body a mass on its card or on its nodes.'), &
   message_t('KJ-9205', SEV_WARNING, 'legacy: two loads share a function', &
      'Of two concentrated loads in a row that use one function the scheme takes the value of '// &
      'the first for both.', 'Give each load its own function.'), &
   message_t('KJ-9206', SEV_WARNING, 'legacy: the spin of a body is off', &
      'The scheme takes the spin half a step old, which brings or takes energy in proportion '// &
      'to the step: in this run over 1 % of the energy of rotation, or 0.05 rad of attitude.', &
      'Lower the time step, or run the consistent formulation.'), &
   message_t('KJ-9209', SEV_WARNING, 'legacy: the scale of a load over displacement or velocity', &
      'OpenRadioss converts it as a time.', 'Use the same input and work units.'), &
   message_t('KJ-9211', SEV_WARNING, 'legacy: a node drifts from its body', &
      'The scheme moves nodes by velocities. With two of them at most the radius shrinks by '// &
      'half the square of the angle of a step, from 1e-3 rad on; with more it grows by an '// &
      'eighth of its fourth power. Here over 0.1 %.', &
      'Lower the step, give the body a third secondary node, or run the consistent formulation.')]

end module kj_message_scene
