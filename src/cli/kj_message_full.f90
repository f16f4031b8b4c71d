!> Messages on full decks: submodels, parameters, elements, what a mechanism loses.
module kj_message_full
   use kj_error, only: SEV_ERROR, SEV_NOTE, SEV_WARNING
   use kj_message_text, only: message_t
   implicit none
   private

   type(message_t), parameter, public :: full_messages(*) = [ &
   message_t('KJ-1865', SEV_ERROR, 'a move of nothing', 'A /TRANSFORM names neither a group of nodes nor a submodel.', &
      'Name one of them.'), &
   message_t('KJ-9401', SEV_WARNING, 'a submodel has no end', 'A //SUBMODEL is open at the end of the deck.', &
      'Write //ENDSUB after its last block.'), &
   message_t('KJ-9402', SEV_WARNING, 'the end of no submodel', 'An //ENDSUB stands where no //SUBMODEL is open.', &
      'Remove it.'), &
   message_t('KJ-9403', SEV_ERROR, 'a parameter has no name', 'Columns 1 to 10 of the card of a /PARAMETER are blank.', &
      'Write a name there.'), &
   message_t('KJ-9404', SEV_ERROR, 'the value of a parameter is wrong', 'A REAL needs a number, an INTEGER a whole one '// &
      'within its range; --set gives the value in place of the deck.', 'Correct the value.'), &
   message_t('KJ-9405', SEV_ERROR, 'an expression has no value', 'It names what has no value, goes round in a circle, '// &
      'or is no expression of numbers, names, + - * / ^ and functions.', &
      'Correct the expression.'), &
   message_t('KJ-9406', SEV_WARNING, 'nothing reads a parameter', 'No field and no expression has &NAME.', &
      'Check the spelling where it should be read, or remove it.'), &
   message_t('KJ-9407', SEV_ERROR, 'there is no such parameter', 'A value was given with --set for a name that the deck '// &
      'does not define.', 'Correct the name.'), &
   message_t('KJ-9408', SEV_WARNING, 'a selection is empty', 'The group of elements, surface, line or body that a group of '// &
      'nodes names does not exist, or has no node.', 'Correct the id.'), &
   message_t('KJ-9409', SEV_WARNING, 'springs are left out', 'Their property is of a kind that is not supported, and '// &
      '--ignore-unsupported leaves it out.', 'Use another kind of property if they matter.'), &
   message_t('KJ-9410', SEV_ERROR, 'an axis without a direction', 'Both points of the axis of a /TRANSFORM are the same.', &
      'Correct one of them.'), &
   message_t('KJ-9411', SEV_NOTE, 'the card of a body does not count', 'A rigid body with a sensor takes its mass from its '// &
      'nodes: Mass, J and skew of its card are ignored, as in Radioss.', &
      'Remove the sensor if they should count.'), &
   message_t('KJ-9412', SEV_WARNING, 'an RBE2 is taken as a body', 'It couples all six directions: a rigid body whose main '// &
      'node stays where it is (ICoG 3), with the inertia as it comes (Ispher 3).', &
      'Write a /RBODY to choose.'), &
   message_t('KJ-9413', SEV_ERROR, 'an RBE2 that couples some directions', 'Only 111 111 makes a rigid body.', &
      'Use a joint.'), &
   message_t('KJ-9415', SEV_ERROR, 'what the mechanism needs is not read', 'A joint, spring or condition of the mechanism '// &
      'names a function or a sensor of a kind that is not supported.', &
      'Use /FUNCT or /SENSOR/TIME.'), &
   message_t('KJ-9421', SEV_WARNING, 'a condition has lost its nodes', 'All nodes of its group belong to deformable parts '// &
      'that are not in the mechanism, or are followed by a body.', &
      'Nothing, if it acts on these parts alone.'), &
   message_t('KJ-9422', SEV_ERROR, 'the axes of a joint would be lost', 'They follow a node of a deformable part.', &
      'Let them follow nodes of the bodies.'), &
   message_t('KJ-9423', SEV_WARNING, 'axes stand still', 'They follow nodes of deformable parts in the full deck; in the '// &
      'mechanism they keep their directions of the start.', 'Let them follow nodes of bodies.'), &
   message_t('KJ-9424', SEV_WARNING, 'an end of a spring is free', 'It stands on a node of a deformable part, which has its '// &
      'mass in the mechanism, and nothing else that holds it.', &
      'Put the node into a body, or hold it.'), &
   message_t('KJ-9425', SEV_WARNING, 'mass scaling is left out', '/DT/NODA/CST adds mass to nodes of elements that are '// &
      'dropped, and to bodies, which would be wrong there.', &
      'Nothing, or limit the step with /DTIX.'), &
   message_t('KJ-9426', SEV_WARNING, 'a body loses what acts on it', 'Contacts, walls, airbags, pressure and ties are not in '// &
      'the mechanism, and the full deck has one on a node of a body.', &
      'See whether the motion depends on it.'), &
   message_t('KJ-9427', SEV_ERROR, 'mass that is not known', 'Elements of a body have a material without a density on its '// &
      'first card, or a property whose layers are not read.', &
      'Give the nodes /ADMAS, and the elements /MAT/VOID.'), &
   message_t('KJ-9428', SEV_ERROR, 'a constraint that cannot be left out', 'Bodies that are merged, gears, and nodes that '// &
      'follow others carry bodies or ends of joints.', 'Use joints instead.'), &
   message_t('KJ-9429', SEV_WARNING, 'bodies that fall apart', 'Only elements hold two bodies together, and these are not '// &
      'in the mechanism: no joint or spring leads from one to the other.', &
      'Put a joint or a spring in their place.'), &
   message_t('KJ-9414', SEV_NOTE, 'requests that are left out', 'Histories of nodes and springs that are not in the '// &
      'mechanism.', 'Nothing.')]

end module kj_message_full
