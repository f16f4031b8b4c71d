!> Messages of the starter deck that OpenRadioss has too, under its numbers.
module kj_message_starter3
   use kj_error, only: SEV_ERROR, SEV_WARNING
   use kj_message_row, only: message_t
   implicit none
   private

   type(message_t), parameter, public :: starter3_messages(*) = [ &
   message_t('KJ-2000', SEV_ERROR, 'the reader asked to stop', &
      'The reader of the deck found something it cannot go on with.', &
      'See the other findings.'), &
   message_t('KJ-2046', SEV_ERROR, 'the keyword needs a newer format', &
      'The format version of /BEGIN is older than this keyword.', &
      'Raise the version in /BEGIN and check the layouts.'), &
   message_t('KJ-3026', SEV_WARNING, 'a load on an empty group', &
      'The group of the load has no node.', &
      'Check the ids.'), &
   message_t('KJ-3067', SEV_WARNING, 'the skews of a joint are badly aligned', &
      'The axes of the two skews do not agree well.', &
      'Align the nodes of the skews.'), &
   message_t('KJ-3076', SEV_ERROR, 'the skews of a joint are not aligned', &
      'The axes of the two skews do not agree.', &
      'Align the nodes of the skews.'), &
   message_t('KJ-3091', SEV_ERROR, 'a frame is driven by its own nodes', &
      'The node with the imposed motion is one of those that define the frame.', &
      'Define the frame by other nodes.'), &
   message_t('KJ-3121', SEV_ERROR, 'a node is in two rigid bodies', &
      'A node can be a secondary node of one body only.', &
      'Remove it from one of the groups.'), &
   message_t('KJ-3122', SEV_ERROR, 'the rigid body has no main node', &
      'Radioss would create a node here; kjoint does not.', &
      'Define a node and name it in columns 1 to 10.'), &
   message_t('KJ-3126', SEV_ERROR, 'the function of a joint does not exist', &
      'A joint property names a function that no /FUNCT defines.', &
      'Define the function, or correct the id.'), &
   message_t('KJ-3151', SEV_WARNING, 'the inertia of an added mass', &
      '/ADMAS with inertia: only Ixx is used.', &
      'Check the inertia.'), &
   message_t('KJ-3152', SEV_WARNING, 'the inertia of an added mass', &
      '/ADMAS with inertia: only Ixx is used.', &
      'Check the inertia.')]

end module kj_message_starter3
