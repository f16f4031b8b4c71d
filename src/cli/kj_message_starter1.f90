!> Messages of the starter deck that OpenRadioss has too, under its numbers.
module kj_message_starter1
   use kj_error, only: SEV_ERROR, SEV_WARNING
   use kj_message_row, only: message_t
   implicit none
   private

   type(message_t), parameter, public :: starter1_messages(*) = [ &
   message_t('KJ-0003', SEV_ERROR, 'the deck has no node', &
      'No /NODE block has a card, or the block is misspelt.', &
      'Define nodes in /NODE, in upper case.'), &
   message_t('KJ-0042', SEV_ERROR, 'the property does not fit the element', &
      'A /SPRING uses a part whose property is not one of springs or joints.', &
      'Name a property of type 4, 8, 33 or 45 on the card of the part.'), &
   message_t('KJ-0053', SEV_ERROR, 'the node group does not exist', &
      'A card names a group of nodes that neither /GRNOD nor /SET defines.', &
      'Define the group, or correct its id.'), &
   message_t('KJ-0056', SEV_ERROR, 'a node is defined twice', &
      'Two cards have the same node id, be it in one /NODE block or in two. Equal '// &
      'coordinates do not help.', &
      'Remove one of them, or give it a new id.'), &
   message_t('KJ-0069', SEV_ERROR, 'an element of a history does not exist', &
      'A /TH/SPRING asks for an element that no /SPRING defines, or for the id 0.', &
      'Correct the id or remove the card.'), &
   message_t('KJ-0078', SEV_ERROR, 'a node does not exist', &
      'A card names a node that no /NODE defines. A blank card in a list of nodes is the '// &
      'node 0.', &
      'Define the node, or correct the id.'), &
   message_t('KJ-0079', SEV_ERROR, 'an id is used twice', &
      'Two blocks or cards of one family have the same id.', &
      'Give one of them another id.'), &
   message_t('KJ-0127', SEV_ERROR, 'the function of a spring does not exist', &
      'A spring property names a function that no /FUNCT defines.', &
      'Define the function, or correct the id.'), &
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
   message_t('KJ-0154', SEV_ERROR, 'the function of gravity does not exist', &
      'A /GRAV names a function that no /FUNCT defines.', &
      'Define the function, or write 0 for constant gravity.'), &
   message_t('KJ-0156', SEV_ERROR, 'abscissae do not increase', &
      'The points of a /FUNCT must have strictly increasing abscissae.', &
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
   message_t('KJ-0164', SEV_ERROR, 'the direction of the imposed motion is wrong', &
      'The direction is not X, Y, Z, XX, YY or ZZ.', &
      'Write one of them in columns 11 to 20, in upper case.'), &
   message_t('KJ-0174', SEV_WARNING, 'a group of groups names one that does not exist', &
      'A /GRNOD/GRNOD names a group that no block defines; it is left out.', &
      'Correct the id.'), &
   message_t('KJ-0178', SEV_ERROR, 'the property of a part does not exist', &
      'A /PART names a property that no /PROP defines.', &
      'Define the property, or correct the id.'), &
   message_t('KJ-0179', SEV_ERROR, 'the material of a part does not exist', &
      'A /PART names a material that no /MAT defines. Springs and joints need none.', &
      'Write 0.'), &
   message_t('KJ-0184', SEV_ERROR, 'the skew of an initial velocity does not exist', &
      'An /INIVEL names a skew that no /SKEW defines.', &
      'Define the skew, or write 0.'), &
   message_t('KJ-0194', SEV_WARNING, 'a group of parts names one that does not exist', &
      'A /GRNOD/PART names a part that no /PART defines; it is left out.', &
      'Correct the id.'), &
   message_t('KJ-0229', SEV_ERROR, 'the spring has no mass', &
      'A spring of type 4 needs a mass above 1e-15.', &
      'Give it a small mass.'), &
   message_t('KJ-0230', SEV_ERROR, 'hardening rule 4 needs a stiffness', &
      'A spring with H = 4 has K = 0.', &
      'Give K a positive value.'), &
   message_t('KJ-0231', SEV_ERROR, 'the hardening rule needs functions', &
      'H = 4, 5 or 8 works on functions that are not given.', &
      'Give the functions, or choose H = 0.'), &
   message_t('KJ-0257', SEV_WARNING, 'a rigid body of a history does not exist', &
      'A /TH/RBODY asks for a body that no /RBODY defines; it is left out.', &
      'Correct the id.'), &
   message_t('KJ-0260', SEV_ERROR, 'a variable of a history does not exist', &
      'A name in a /TH block is not one of its kind of object, is in lower case, or '// &
      'shares its field with another name.', &
      'Write one name in each field of ten columns, in upper case; DEF is the usual set.'), &
   message_t('KJ-0274', SEV_ERROR, 'the inertia of a rigid body is not positive', &
      'The smallest principal inertia is zero or negative.', &
      'Give the body inertia, or secondary nodes with mass that are not on a line.'), &
   message_t('KJ-0275', SEV_WARNING, 'the inertia of a slender rigid body was raised', &
      'A principal inertia is under a thousandth of the largest one; with Ispher 2, the '// &
      'default, a tenth of the largest is added to it.', &
      'Choose Ispher 3 to keep the inertia as typed.'), &
   message_t('KJ-0312', SEV_WARNING, 'incompatible kinematic conditions', &
      'A node is moved by two conditions at a time.', &
      'Keep one of them.'), &
   message_t('KJ-0352', SEV_WARNING, 'a rigid body without secondary nodes', &
      'The body has no group, or an empty one; joints can hold on secondary nodes only.', &
      'Name a group of nodes in columns 61 to 70.'), &
   message_t('KJ-0386', SEV_ERROR, 'the joint has no first skew', &
      'A /PROP/KJOINT needs a moving skew of body 1 in columns 1 to 10 of its second '// &
      'card.', &
      'Name a /SKEW/MOV whose nodes belong to body 1.'), &
   message_t('KJ-0387', SEV_ERROR, 'the blocking stiffness is zero', &
      'All joints but the free ones hold their blocked directions by the stiffness Kn.', &
      'Give Kn a positive value; the time step falls as its square root.'), &
   message_t('KJ-0388', SEV_ERROR, 'the critical damping ratio is out of range', &
      'Cr must lie between 0 and 1; 0 stands for 0.05.', &
      'Correct the value.'), &
   message_t('KJ-0389', SEV_ERROR, 'the axes of a universal joint are not perpendicular', &
      'The x axes of the two skews of a type 5 joint are its cross and must be at right '// &
      'angles.', &
      'Turn one of the skews.'), &
   message_t('KJ-0390', SEV_WARNING, 'a joint without any rigid body', &
      'The model has joints, but no /RBODY.', &
      'Attach each joint node and its skew nodes to a rigid body.'), &
   message_t('KJ-0391', SEV_WARNING, 'a joint node belongs to no rigid body', &
      'The node is a free node with its own mass, which seldom is what one wants.', &
      'Make the node a secondary node of a body.'), &
   message_t('KJ-0392', SEV_WARNING, 'a joint skew without any rigid body', &
      'The nodes of the skew of a joint belong to no rigid body.', &
      'Make them secondary nodes of the body of the joint node.'), &
   message_t('KJ-0402', SEV_ERROR, 'elements of a part that does not exist', &
      'The id in the header of /SPRING is that of a /PART, and there is no such part.', &
      'Define the part, or correct the id.'), &
   message_t('KJ-0409', SEV_ERROR, 'there is no such joint type', &
      'The type of a /PROP/KJOINT has no such number.', &
      '`kjoint list joints` shows the types and their numbers.'), &
   message_t('KJ-0442', SEV_ERROR, 'two rigid bodies share a main node', &
      'A main node carries the motion of one body.', &
      'Give each body its own main node.'), &
   message_t('KJ-0444', SEV_WARNING, 'the mass of a spring is zero', &
      'The mass was set to 1e-20.', &
      'Give the spring a mass.'), &
   message_t('KJ-0445', SEV_WARNING, 'the inertia of a spring is zero', &
      'The inertia was set to 1e-20.', &
      'Give the spring an inertia.'), &
   message_t('KJ-0448', SEV_WARNING, 'a main node belongs to an element', &
      'The main node of a rigid body is also the end of a spring.', &
      'Use a secondary node.'), &
   message_t('KJ-0476', SEV_WARNING, 'an added mass is negative', &
      '/ADMAS takes mass away from its nodes.', &
      'Check the sign.'), &
   message_t('KJ-0490', SEV_ERROR, 'the frame of an initial velocity does not exist', &
      'An /INIVEL/AXIS names a frame that no /FRAME defines.', &
      'Define the frame, or write 0 for the global one.'), &
   message_t('KJ-0491', SEV_ERROR, 'a skew and a frame are given together', &
      'An imposed motion has directions in a skew or in a frame, not in both.', &
      'Write 0 for one of them.'), &
   message_t('KJ-0521', SEV_ERROR, 'the sensor does not exist', &
      'A card names a sensor that no /SENSOR defines.', &
      'Define the sensor, or correct the id.')]

end module kj_message_starter1
