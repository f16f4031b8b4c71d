!> THE table of messages: every id a finding can have, what it means, why it comes, what to do.
!> `kjoint help KJ-0387` prints a row. The rows stand here (joints) and in kj_message_text.
module kj_message
   use kj_message_text, only: message_t, text_messages, full_messages, scene_messages
   use kj_error, only: SEV_ERROR, SEV_NOTE, SEV_WARNING
   implicit none
   private

   public :: message_t, find_message

   type(message_t), parameter, public :: joint_messages(*) = [ &
   message_t('KJ-0042', SEV_ERROR, 'the property does not fit the element', &
      'A /SPRING uses a part whose property is not one of springs or joints.', &
      'Name a property of type 4, 8, 33 or 45 on the card of the part.'), &
   message_t('KJ-0127', SEV_ERROR, 'the function of a spring does not exist', &
      'A spring property names a function that no /FUNCT defines.', &
      'Define the function, or correct the id.'), &
   message_t('KJ-0178', SEV_ERROR, 'the property of a part does not exist', 'A /PART names a property that no /PROP defines.', &
      'Define the property, or correct the id.'), &
   message_t('KJ-0179', SEV_ERROR, 'the material of a part does not exist', &
      'A /PART names a material that no /MAT defines. Springs and joints need none.', 'Write 0.'), &
   message_t('KJ-0229', SEV_ERROR, 'the spring has no mass', 'A spring of type 4 needs a mass above 1e-15.', &
      'Give it a small mass.'), &
   message_t('KJ-0230', SEV_ERROR, 'hardening rule 4 needs a stiffness', 'A spring with H = 4 has K = 0.', &
      'Give K a positive value.'), &
   message_t('KJ-0231', SEV_ERROR, 'the hardening rule needs functions', 'H = 4, 5 or 8 works on functions that are not given.', &
      'Give the functions, or choose H = 0.'), &
   message_t('KJ-0325', SEV_ERROR, 'a spring like a beam has no length', &
      'Both of its nodes are at one place, so that it has no axis.', 'Put them apart.'), &
   message_t('KJ-0386', SEV_ERROR, 'the joint has no first skew', &
      'A /PROP/KJOINT needs a moving skew of body 1 in columns 1 to 10 of its second card.', &
      'Name a /SKEW/MOV whose nodes belong to body 1.'), &
   message_t('KJ-0387', SEV_ERROR, 'the blocking stiffness is zero', &
      'All joints but the free ones hold their blocked directions by the stiffness Kn.', &
      'Give Kn a positive value; the time step falls as its square root.'), &
   message_t('KJ-0388', SEV_ERROR, 'the damping Cr is out of range', &
      'Cr = c/sqrt(K m) is twice the damping ratio of the blocked directions: the default 0.05 '// &
      'damps with 0.025, and Cr = 1, the most, with half of the critical damping.', &
      'Write 0 to 1; 0 stands for 0.05.'), &
   message_t('KJ-0389', SEV_ERROR, 'the axes of a universal joint are not perpendicular', &
      'The x axes of the two skews of a type 5 joint are its cross and must be at right angles.', &
      'Turn one of the skews.'), &
   message_t('KJ-0390', SEV_WARNING, 'a joint without any rigid body', 'The model has joints, but no /RBODY.', &
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
   message_t('KJ-0409', SEV_ERROR, 'there is no such joint type', 'The type of a /PROP/KJOINT has no such number.', &
      '`kjoint list joints` shows the types and their numbers.'), &
   message_t('KJ-0444', SEV_WARNING, 'the mass of a spring is zero', 'The mass was set to 1e-20.', 'Give the spring a mass.'), &
   message_t('KJ-0445', SEV_WARNING, 'the inertia of a spring is zero', 'The inertia was set to 1e-20.', &
      'Give the spring an inertia.'), &
   message_t('KJ-0663', SEV_WARNING, 'a scale without its function', 'A spring has A without the function fct1; A was set to 1.', &
      'Remove A, or name the function.'), &
   message_t('KJ-0681', SEV_ERROR, 'the frame of a joint is degenerate', 'The nodes of a joint of type 45 do not span its axes.', &
      'Choose nodes that are apart and not on a line.'), &
   message_t('KJ-0919', SEV_WARNING, 'the nodes of a joint skew are not of one body', &
      'The three nodes that define a skew of a joint are not all secondary nodes of one rigid '// &
      'body, so the axes do not follow the body. A main node does not count.', &
      'Put all three nodes into the group of the body.'), &
   message_t('KJ-0920', SEV_WARNING, 'a joint skew follows another body', &
      'The body of a skew is not the body of the joint node it belongs to.', &
      'Exchange the skews, or correct their nodes.'), &
   message_t('KJ-0921', SEV_WARNING, 'the joint skews were exchanged', &
      'Skew 1 follows the body of node 2, and the other way round.', &
      'Exchange them on the card.'), &
   message_t('KJ-0926', SEV_ERROR, 'the skew of a joint does not exist', 'A joint property names a skew that no /SKEW defines.', &
      'Define the skew, or correct the id.'), &
   message_t('KJ-0934', SEV_ERROR, 'the axes of a joint are degenerate', &
      'Nodes of a joint of type 45 that should span its axes coincide or are on a line.', &
      'Choose other nodes.'), &
   message_t('KJ-0935', SEV_ERROR, 'the axes of a joint are degenerate', &
      'Nodes of a joint of type 45 that should span its axes coincide or are on a line.', &
      'Choose other nodes.'), &
   message_t('KJ-0936', SEV_ERROR, 'the joint has too few nodes', &
      'A joint of type 45 needs the nodes that `kjoint list joints` tells, unless a skew '// &
      'gives the axes.', 'Name more nodes in /SPRING, or a skew in the property.'), &
   message_t('KJ-0937', SEV_ERROR, 'the axes of a joint are degenerate', &
      'Nodes of a joint of type 45 that should span its axes coincide or are on a line.', &
      'Choose other nodes.'), &
   message_t('KJ-0938', SEV_ERROR, 'there is no such joint type', 'The type of a /PROP/KJOINT2 has no such number.', &
      '`kjoint list joints` shows the types and their numbers.'), &
   message_t('KJ-0939', SEV_ERROR, 'a negative scale', 'The scale of the blocked rotations is below zero.', &
      'Write a positive value, or 0 for the default.'), &
   message_t('KJ-0940', SEV_WARNING, 'the axes of a joint are nearly degenerate', &
      'The nodes that span the axes are almost on a line.', 'Choose other nodes.'), &
   message_t('KJ-0943', SEV_ERROR, 'the lower stop is positive', 'SA- is the lower stop and must not be above zero.', &
      'Write a negative value, or 0 for none.'), &
   message_t('KJ-0944', SEV_ERROR, 'the upper stop is negative', 'SA+ is the upper stop and must not be below zero.', &
      'Write a positive value, or 0 for none.'), &
   message_t('KJ-0973', SEV_ERROR, 'a part of the direction cards is missing', &
      'A joint of type 45 has either all three cards of each free direction, or none at all.', &
      'Add the missing cards, blank where nothing acts.'), &
   message_t('KJ-0979', SEV_WARNING, 'friction without stiffness', 'A friction limit is given, but no friction stiffness.', &
      'Give Kfr.'), &
   message_t('KJ-1009', SEV_ERROR, 'the axes of a joint are degenerate', &
      'Nodes of a joint of type 45 that should span its axes coincide.', 'Choose other nodes.'), &
   message_t('KJ-1057', SEV_ERROR, 'hardening rule 6 needs two functions', 'H = 6 works on a loading and an unloading function.', &
      'Give both.'), &
   message_t('KJ-1058', SEV_ERROR, 'hardening rule 7 needs a function', 'H = 7 works on a loading function.', 'Give fct1.'), &
   message_t('KJ-1059', SEV_WARNING, 'hardening rule 7 became 2', 'H = 7 without an unloading function is H = 2.', &
      'Give fct3, or write H = 2.'), &
   message_t('KJ-1114', SEV_WARNING, 'the deck has no part', 'Without a /PART there is no spring and no joint.', &
      'Nothing, if rigid bodies alone are meant.'), &
   message_t('KJ-1133', SEV_ERROR, 'the joint starts beyond a stop', &
      'The first angle of a joint of type 45 is outside its stops.', &
      'Correct the stops, or the place of the nodes.'), &
   message_t('KJ-1598', SEV_ERROR, 'stops that are combined differ', 'Icomb must be the same on the directions that it combines.', &
      'Write one value.'), &
   message_t('KJ-1599', SEV_ERROR, 'a stop is combined with nothing', 'Icomb is set on a single direction.', &
      'Set it on two or three directions, or on none.'), &
   message_t('KJ-1600', SEV_ERROR, 'a stop is combined with nothing', 'Icomb is set on a single direction.', &
      'Set it on two or three directions, or on none.'), &
   message_t('KJ-1768', SEV_ERROR, 'a joint ends on a main node', 'The ends of a joint must be secondary nodes of rigid bodies.', &
      'Add a secondary node at the same place and use it.'), &
   message_t('KJ-3067', SEV_WARNING, 'the skews of a joint are badly aligned', 'The axes of the two skews do not agree well.', &
      'Align the nodes of the skews.'), &
   message_t('KJ-3076', SEV_ERROR, 'the skews of a joint are not aligned', 'The axes of the two skews do not agree.', &
      'Align the nodes of the skews.'), &
   message_t('KJ-3126', SEV_ERROR, 'the function of a joint does not exist', &
      'A joint property names a function that no /FUNCT defines.', &
      'Define the function, or correct the id.'), &
   message_t('KJ-9028', SEV_WARNING, 'a /PROP/KJOINT2 before its time', &
      'The property came with format version 120; in an older deck its cards are read as those '// &
      'of 120.', &
      'Look whether `kjoint check` shows the values that you mean.'), &
   message_t('KJ-9042', SEV_NOTE, 'stops without damping take shorter steps', &
      'Steps change at every stop, which shakes blocked directions that ring. Where some Cr '// &
      'is below 0.01 steps are half of the critical one at most.', &
      'Leave --dt-scale out, or give a larger Cr.'), &
   message_t('KJ-9047', SEV_WARNING, 'velocities at the start do not fit the joints', &
      'The integrator compliant brings the velocities at t = 0 to what the joints '// &
      'allow, as an impact would. The energy that this takes is lost.', &
      'Give velocities that the joints allow; split2 rings instead, and loses about as much.'), &
   message_t('KJ-9071', SEV_ERROR, 'cards of a joint property are missing', &
      'A /PROP/KJOINT has its type, its skews and a card that begins with Kn or a stiffness; '// &
      'cards behind that may be missing.', 'Add the cards; blank fields are 0.'), &
   message_t('KJ-9072', SEV_WARNING, 'the last cards of a joint are missing', &
      'The last cards of a /PROP/KJOINT, of functions and damping, may be missing: then there '// &
      'are none.', 'Add the cards, blank where nothing is meant.'), &
   message_t('KJ-9073', SEV_WARNING, 'both ends of a joint on one rigid body', &
      'A body is rigid in itself: such a joint does nothing, and what it was to hold is loose.', &
      'Use a node of the other body; a wrong pick in a preprocessor is the usual cause.'), &
   message_t('KJ-9074', SEV_WARNING, 'a joint ends on a node without inertia', &
      'The rotation of such a node is that of nothing: moments and blocked rotations of the '// &
      'joint have no effect.', 'Make the node a secondary node of a rigid body.'), &
   message_t('KJ-9075', SEV_WARNING, 'the nodes of a joint stand apart across its axis', &
      'The joint then turns about a point between the nodes, or about one of them, and pushes '// &
      'with a lever. Farther apart than a thousandth of the arm is worth a warning.', &
      'Give both nodes one place; along the axis they may stand apart.'), &
   message_t('KJ-9076', SEV_WARNING, 'a stop of more than a turn', &
      'Stops of rotations are angles in rad. Beyond a turn (for joints with two or three '// &
      'rotations: half a turn) they can hardly be meant so.', &
      'Degrees times 0.0174533 are rad.'), &
   message_t('KJ-9077', SEV_ERROR, 'an automatic stiffness without a step', &
      'With Kn = 0 a KJOINT2 takes its blocking stiffness from the time step, and nothing else '// &
      'in the scene limits that.', 'Give the largest step by /DTIX, or write a Kn.'), &
   message_t('KJ-9118', SEV_ERROR, 'the blocking stiffness is negative', 'Kn holds the blocked directions and must be positive.', &
      'Correct the sign.'), &
   message_t('KJ-9119', SEV_WARNING, 'a joint without a second skew', &
      'With skew flag 0 and no skew on body 2 OpenRadioss works on undefined data; the card '// &
      'is read as skew flag 1.', 'Set the skew flag to 1, or name a second skew.'), &
   message_t('KJ-9120', SEV_ERROR, 'both ends of a joint are one node', 'A joint connects two nodes.', &
      'Use two nodes; they may have the same place.'), &
   message_t('KJ-9121', SEV_ERROR, 'no mean frame', 'The skews of the joint are 180 degrees apart, so they have no mean.', &
      'Turn one of the skews, or set the skew flag to 1.'), &
   message_t('KJ-9126', SEV_ERROR, 'a negative stiffness or limit of friction', &
      'Kfr and FM of a /PROP/KJOINT2 must not be below zero.', &
      'Correct the sign, or write 0 for no friction.'), &
   message_t('KJ-9127', SEV_WARNING, 'nothing to combine', 'Icomb combines stops, but a direction that it names has none.', &
      'Give SA- or SA+, or write 0 for Icomb.'), &
   message_t('KJ-9128', SEV_WARNING, 'the axes of a universal joint were made perpendicular', &
      'The directions from node 1 to node 3 and to node 4 are not perpendicular, so the '// &
      'second axis was turned in their plane.', 'Move node 3 or node 4.'), &
   message_t('KJ-9129', SEV_WARNING, 'a second skew with id 1 or 2', &
      'OpenRadioss reads the first angles of a KJOINT2 only from a second skew whose id is '// &
      'above 2, and starts with undefined ones else. Here they are read.', &
      'Give the skew another id.'), &
   message_t('KJ-9130', SEV_ERROR, 'a joint end without mass', &
      'An end of a KJOINT2 is a secondary node of a rigid body or a node with mass.', &
      'Add mass by /ADMAS, or make the node a secondary node.'), &
   message_t('KJ-9201', SEV_WARNING, 'legacy: first-skew frame with a length', &
      'Half the moment of the force goes to each body although the frame turns with body 1 '// &
      'only: energy is created or lost.', &
      'Run the consistent formulation, or make the two nodes coincide.'), &
   message_t('KJ-9202', SEV_WARNING, 'legacy: universal joint', &
      'It measures in a frame that it does not push in, so some percent of the energy are '// &
      'lost or won.', 'Run the consistent formulation.'), &
   message_t('KJ-9203', SEV_WARNING, 'legacy: a falling stiffness curve', &
      'The scheme takes the root of the slope for its damping and gets NaN where the curve '// &
      'falls.', 'Run the consistent formulation, or let the curve rise.'), &
   message_t('KJ-9204', SEV_WARNING, 'legacy: a curve above f(0) at negative abscissae', &
      'The stiffness that steers the time step becomes a force over a tiny displacement: the '// &
      'time step collapses.', 'Run the consistent formulation, or shift the curve.'), &
   message_t('KJ-9207', SEV_WARNING, 'legacy: joints share a property with limits', &
      'OpenRadioss switches the damping of a direction for all joints of a /PROP/KJOINT2 as '// &
      'soon as one is at its limit, and mixes up their friction. Here each joint is alone.', &
      'Give each joint its own property where results are to agree.'), &
   message_t('KJ-9208', SEV_WARNING, 'legacy: friction on a universal joint', &
      'OpenRadioss keeps friction and axes of a universal KJOINT2 in one place, so each '// &
      'spoils the other. Here they are kept apart.', &
      'Leave the friction out where results are to agree.'), &
   message_t('KJ-9210', SEV_WARNING, 'legacy: functions of a joint where units differ', &
      'OpenRadioss multiplies the scale by M/T or 1/T once more and converts the abscissae by '// &
      'wrong factors.', 'Use the same input and work units, or run the consistent formulation.'), &
   message_t('KJ-9212', SEV_WARNING, 'legacy: rotations that are summed', &
      'The scheme sums the relative angular velocity of three free rotations. What comes out '// &
      'depends on the path, and is over 0.01 rad from the rotation that there is.', &
      'Run the consistent formulation; shorter steps do not help.'), &
   message_t('KJ-9216', SEV_WARNING, 'a joint frame is not rigid', &
      'The axes of a joint have turned against each other, or against the body that should '// &
      'carry them, by more than 1e-3 rad. The channel joint/orthogonality has it over time.', &
      'Put the nodes of the skew on the body of its joint node; or raise the stiffness.'), &
   message_t('KJ-9220', SEV_ERROR, 'how a sensor switches a spring', &
      'Isflag is 0 (on with the sensor), 1 (off with it) or 2 (on with it, off with it).', &
      'Give one of them.'), &
   message_t('KJ-9221', SEV_ERROR, 'a hardening rule that does not exist', &
      'H is 0, 1, 2, 4, 5, 6 or 7; a spring of type 4 has 8, too.', 'Give one of them.'), &
   message_t('KJ-9225', SEV_WARNING, 'an option of a spring has no effect', &
      'The value acts only together with another one that is not there.', &
      'Remove it, or give the other one.'), &
   message_t('KJ-9227', SEV_ERROR, 'a couple for axes that are fixed in space', &
      'With axes that ride on a body the couple of the offset force goes to that body, '// &
      'always. Axes fixed in space take it themselves; a couple on the nodes would do work '// &
      'for nothing.', 'Write Iequil = 0, or name a moving skew.'), &
   message_t('KJ-9228', SEV_ERROR, 'the skew of a spring rides on neither of its ends', &
      'The consistent formulation turns the axes of a spring with the rigid body of one of '// &
      'its nodes; the three nodes of the skew must belong to it.', &
      'Name a skew of such nodes or a fixed one, or run with --legacy.'), &
   message_t('KJ-9229', SEV_WARNING, 'a spring node without mass', &
      'Nothing can move a node without mass: it is a fixed point, unless it starts with a '// &
      'velocity.', &
      'Give it mass by /ADMAS or by the mass of the spring, or hold it by /BCS to say so.'), &
   message_t('KJ-9230', SEV_ERROR, 'a scale of abscissae is negative', 'It would turn the function round.', &
      'Mirror the function with /MOVE_FUNCT.'), &
   message_t('KJ-9430', SEV_ERROR, 'there is no such joint', &
      'A field was set with --joint for an element that is no joint of the deck.', &
      'Correct the id.'), &
   message_t('KJ-9431', SEV_ERROR, 'a joint has no such field', &
      'A field that --joint sets is none of its property, or its value is no number.', &
      '`kjoint help /PROP/KJOINT2` lists them; that of a direction is K_rx, SA+_rx.'), &
   message_t('KJ-9302', SEV_WARNING, 'a joint gave way', &
      'The two ends of a joint moved apart in a blocked direction by more than 1 % of the '// &
      'longer arm, from joint node to centre of gravity, or turned apart by 0.01 rad. Blocked '// &
      'directions are springs of stiffness Kn.', &
      'Raise Kn; the gap is force over Kn, the step falls with its root. `kjoint study` '// &
      'tries it.'), &
   message_t('KJ-9303', SEV_WARNING, 'a run that its time step ended', &
      '/DT/NODA/STOP ends a run whose step falls below the least that it names.', &
      'Lower that, or the stiffness of the joint that holds the step.'), &
   message_t('KJ-9301', SEV_WARNING, 'a joint loses its right angles', &
      'The axes of a joint come from nodes or bodies that are meant to be rigid. They strain '// &
      'or turn against each other, and the directions of the joint lose their right angles.', &
      'Stiffen what carries the joint, or let its axes follow one node with rotations.')]

   !> All messages, ascending within each subject
   type(message_t), parameter, public :: messages(*) = [text_messages, scene_messages, &
      joint_messages, full_messages]

contains

   !> Row of a message; 0 when there is none. The letters may be in lower case, the id without KJ-
   pure integer function find_message(id) result(row)
      character(len=*), intent(in) :: id        !! KJ-0387, kj-0387, 0387 or 387

      character(len=7) :: wanted
      character(len=4) :: digits
      integer :: first

      first = 1
      if (len(id) > 3) then
         if (index('KJ-kj-Kj-kJ-', id(:3)) > 0) first = 4
      end if
      digits = id(first:)
      if (digits(1:1) == 'e') digits(1:1) = 'E'
      digits = adjustr(digits)
      do row = 1, len(digits)
         if (digits(row:row) == ' ') digits(row:row) = '0'
      end do
      wanted = 'KJ-'//digits
      row = findloc(messages%id, wanted, 1)
      if (len_trim(id) >= first + 4) row = 0
   end function find_message

end module kj_message
