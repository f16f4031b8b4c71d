!> Messages of the starter deck that OpenRadioss has too, under its numbers.
module kj_message_starter2
   use kj_error, only: SEV_ERROR, SEV_NOTE, SEV_WARNING
   use kj_message_row, only: message_t
   implicit none
   private

   type(message_t), parameter, public :: starter2_messages(*) = [ &
   message_t('KJ-0542', SEV_WARNING, 'the inertia is not that of a solid', &
      'The largest principal inertia is above the sum of the others, which no solid has.', &
      'Check the inertia; the run goes on with it.'), &
   message_t('KJ-0551', SEV_ERROR, 'ALL is obsolete', &
      'The name ALL in a /TH block no longer exists.', &
      'Write DEF, or the names.'), &
   message_t('KJ-0553', SEV_WARNING, 'a part is in two requests', &
      'A part is asked for in two /TH/PART blocks.', &
      'Remove it from one.'), &
   message_t('KJ-0573', SEV_ERROR, 'a unit is not understood', &
      'A unit of /BEGIN or /UNIT is a prefix and g, m or s, or the SI value of the unit, '// &
      '1e-30 to 1e30. A deck without /BEGIN has no units.', &
      'For example kg, m, s or Mg, mm, s.'), &
   message_t('KJ-0574', SEV_ERROR, 'the deck has no units', &
      'Both triples of /BEGIN are blank.', &
      'Write the units of mass, length and time, for example kg, m, s.'), &
   message_t('KJ-0659', SEV_ERROR, 'the unit system does not exist', &
      'The last number of a header is the id of a /UNIT, and there is none.', &
      'Define /UNIT with this id, or remove the number.'), &
   message_t('KJ-0663', SEV_WARNING, 'a scale without its function', &
      'A spring has A without the function fct1; A was set to 1.', &
      'Remove A, or name the function.'), &
   message_t('KJ-0668', SEV_ERROR, 'the node group does not exist', &
      'The card needs a group of nodes that exists.', &
      'Define the group, or correct the id.'), &
   message_t('KJ-0678', SEV_ERROR, 'the group of a boundary condition does not exist', &
      'A /BCS names a group that no block defines.', &
      'Define the group, or correct the id in columns 21 to 30.'), &
   message_t('KJ-0679', SEV_ERROR, 'the rigid body has no mass', &
      'The masses of the card and of the nodes add up to nothing.', &
      'Give the body a mass.'), &
   message_t('KJ-0681', SEV_ERROR, 'the frame of a joint is degenerate', &
      'The nodes of a joint of type 45 do not span its axes.', &
      'Choose nodes that are apart and not on a line.'), &
   message_t('KJ-0690', SEV_WARNING, 'an empty node group', &
      'The group has no node that exists; loads on it do nothing.', &
      'Check the ids. Cards from an included file belong to that file''s own blocks.'), &
   message_t('KJ-0754', SEV_NOTE, 'input units and work units differ', &
      'The cards are converted from the input units to the work units; results are in '// &
      'work units.', &
      'Nothing, if this is meant.'), &
   message_t('KJ-0760', SEV_ERROR, 'the reader of Radioss stops here', &
      'OpenRadioss ends with a trap at this place, without a reason.', &
      'See the finding.'), &
   message_t('KJ-0774', SEV_WARNING, 'rotational displacements are not kept', &
      'DRX, DRY and DRZ are zero in Radioss unless Irot is set in /IOFLAG.', &
      'Set Irot to 1.'), &
   message_t('KJ-0845', SEV_ERROR, 'a moment on nodes without rotation', &
      'The nodes of the load have no rotational direction.', &
      'Put the moment on a node of a rigid body.'), &
   message_t('KJ-0871', SEV_ERROR, 'the node of an added mass does not exist', &
      'A card of /ADMAS/5 names a node that no /NODE defines.', &
      'Define the node, or correct the id in columns 21 to 30.'), &
   message_t('KJ-0900', SEV_ERROR, 'a frame on a node needs its node', &
      'A /FRAME/NOD has no node n1.', &
      'Name the node.'), &
   message_t('KJ-0919', SEV_WARNING, 'the nodes of a joint skew are not of one body', &
      'The three nodes that define a skew of a joint are not all secondary nodes of one '// &
      'rigid body, so the axes do not follow the body. A main node does not count.', &
      'Put all three nodes into the group of the body.'), &
   message_t('KJ-0920', SEV_WARNING, 'a joint skew follows another body', &
      'The body of a skew is not the body of the joint node it belongs to.', &
      'Exchange the skews, or correct their nodes.'), &
   message_t('KJ-0921', SEV_WARNING, 'the joint skews were exchanged', &
      'Skew 1 follows the body of node 2, and the other way round.', &
      'Exchange them on the card.'), &
   message_t('KJ-0926', SEV_ERROR, 'the skew of a joint does not exist', &
      'A joint property names a skew that no /SKEW defines.', &
      'Define the skew, or correct the id.'), &
   message_t('KJ-0933', SEV_ERROR, 'the axis is wrong', &
      'The axis of an /INIVEL/AXIS is not X, Y or Z.', &
      'Write one of them, in upper case.'), &
   message_t('KJ-0934', SEV_ERROR, 'the axes of a joint are degenerate', &
      'Nodes of a joint of type 45 that should span its axes coincide or are on a line.', &
      'Choose other nodes.'), &
   message_t('KJ-0935', SEV_ERROR, 'the axes of a joint are degenerate', &
      'Nodes of a joint of type 45 that should span its axes coincide or are on a line.', &
      'Choose other nodes.'), &
   message_t('KJ-0936', SEV_ERROR, 'the joint has too few nodes', &
      'A joint of type 45 needs the nodes that `kjoint list joints` tells, unless a skew '// &
      'gives the axes.', &
      'Name more nodes in /SPRING, or a skew in the property.'), &
   message_t('KJ-0937', SEV_ERROR, 'the axes of a joint are degenerate', &
      'Nodes of a joint of type 45 that should span its axes coincide or are on a line.', &
      'Choose other nodes.'), &
   message_t('KJ-0938', SEV_ERROR, 'there is no such joint type', &
      'The type of a /PROP/KJOINT2 has no such number.', &
      '`kjoint list joints` shows the types and their numbers.'), &
   message_t('KJ-0939', SEV_ERROR, 'a negative scale', &
      'The scale of the blocked rotations is below zero.', &
      'Write a positive value, or 0 for the default.'), &
   message_t('KJ-0940', SEV_WARNING, 'the axes of a joint are nearly degenerate', &
      'The nodes that span the axes are almost on a line.', &
      'Choose other nodes.'), &
   message_t('KJ-0943', SEV_ERROR, 'the lower stop is positive', &
      'SA- is the lower stop and must not be above zero.', &
      'Write a negative value, or 0 for none.'), &
   message_t('KJ-0944', SEV_ERROR, 'the upper stop is negative', &
      'SA+ is the upper stop and must not be below zero.', &
      'Write a positive value, or 0 for none.'), &
   message_t('KJ-0973', SEV_ERROR, 'a part of the direction cards is missing', &
      'A joint of type 45 has either all three cards of each free direction, or none at '// &
      'all.', &
      'Add the missing cards, blank where nothing acts.'), &
   message_t('KJ-0979', SEV_WARNING, 'friction without stiffness', &
      'A friction limit is given, but no friction stiffness.', &
      'Give Kfr.'), &
   message_t('KJ-1009', SEV_ERROR, 'the axes of a joint are degenerate', &
      'Nodes of a joint of type 45 that should span its axes coincide.', &
      'Choose other nodes.'), &
   message_t('KJ-1051', SEV_ERROR, 'a wrong code of a boundary condition', &
      'The digits in columns 4 to 6 and 8 to 10 of /BCS must be 0 or 1.', &
      'Write 1 for blocked, 0 for free.'), &
   message_t('KJ-1057', SEV_ERROR, 'hardening rule 6 needs two functions', &
      'H = 6 works on a loading and an unloading function.', &
      'Give both.'), &
   message_t('KJ-1058', SEV_ERROR, 'hardening rule 7 needs a function', &
      'H = 7 works on a loading function.', &
      'Give fct1.'), &
   message_t('KJ-1059', SEV_WARNING, 'hardening rule 7 became 2', &
      'H = 7 without an unloading function is H = 2.', &
      'Give fct3, or write H = 2.'), &
   message_t('KJ-1066', SEV_ERROR, 'a main node belongs to an element', &
      'The main node of a rigid body is also the end of a spring.', &
      'Use a secondary node.'), &
   message_t('KJ-1109', SEV_ERROR, 'the request has no variable', &
      'No name in a /TH block exists.', &
      'Write DEF, or names of variables.'), &
   message_t('KJ-1114', SEV_WARNING, 'the deck has no part', &
      'Without a /PART there is no spring and no joint.', &
      'Nothing, if rigid bodies alone are meant.'), &
   message_t('KJ-1133', SEV_ERROR, 'the joint starts beyond a stop', &
      'The first angle of a joint of type 45 is outside its stops.', &
      'Correct the stops, or the place of the nodes.'), &
   message_t('KJ-1252', SEV_ERROR, 'the sensor of an initial velocity does not exist', &
      'An /INIVEL names a sensor that no /SENSOR defines.', &
      'Define it, or write 0.'), &
   message_t('KJ-1598', SEV_ERROR, 'stops that are combined differ', &
      'Icomb must be the same on the directions that it combines.', &
      'Write one value.'), &
   message_t('KJ-1599', SEV_ERROR, 'a stop is combined with nothing', &
      'Icomb is set on a single direction.', &
      'Set it on two or three directions, or on none.'), &
   message_t('KJ-1600', SEV_ERROR, 'a stop is combined with nothing', &
      'Icomb is set on a single direction.', &
      'Set it on two or three directions, or on none.'), &
   message_t('KJ-1610', SEV_WARNING, 'a part of a history does not exist', &
      'A /TH/PART asks for a part that no /PART defines.', &
      'Correct the id.'), &
   message_t('KJ-1624', SEV_WARNING, 'the main node is among the secondary nodes', &
      'It was removed from the group of the body.', &
      'Remove it from the group.'), &
   message_t('KJ-1768', SEV_ERROR, 'a joint ends on a main node', &
      'The ends of a joint must be secondary nodes of rigid bodies.', &
      'Add a secondary node at the same place and use it.'), &
   message_t('KJ-1874', SEV_WARNING, 'a function with less than two points', &
      'One point is a constant function.', &
      'Add a point, if something else is meant.')]

end module kj_message_starter2
