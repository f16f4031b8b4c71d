!> Messages on the text of a deck: files, cards, numbers, units, keywords, requests, engine deck, and
!> what full decks have besides.
module kj_message_text
   use kj_error, only: SEV_ERROR, SEV_NOTE, SEV_WARNING
   implicit none
   private

   public :: message_t

   !> A message explained
   type :: message_t
      character(len=7)   :: id         !! KJ-nnnn, KJ-Ennn: of OpenRadioss; KJ-9nnn: ours
      integer            :: severity   !! SEV_ constant, the usual one
      character(len=72)  :: title      !! what is wrong, in general
      character(len=240) :: cause      !! why
      character(len=160) :: cure       !! what to do
   end type message_t

   type(message_t), parameter, public :: text_messages(*) = [ &
   message_t('KJ-0069', SEV_ERROR, 'an element of a history does not exist', &
      'A /TH/SPRING asks for an element that no /SPRING defines, or for the id 0.', &
      'Correct the id or remove the card.'), &
   message_t('KJ-0079', SEV_ERROR, 'an id is used twice', 'Two blocks or cards of one family have the same id.', &
      'Give one of them another id.'), &
   message_t('KJ-0257', SEV_WARNING, 'a rigid body of a history does not exist', &
      'A /TH/RBODY asks for a body that no /RBODY defines; it is left out.', 'Correct the id.'), &
   message_t('KJ-0260', SEV_ERROR, 'a variable of a history does not exist', &
      'A name in a /TH block is not one of its kind of object, is in lower case, or shares '// &
      'its field with another name.', &
      'Write one name in each field of ten columns, in upper case; DEF is the usual set.'), &
   message_t('KJ-0551', SEV_ERROR, 'ALL is obsolete', 'The name ALL in a /TH block no longer exists.', &
      'Write DEF, or the names.'), &
   message_t('KJ-0553', SEV_WARNING, 'a part is in two requests', 'A part is asked for in two /TH/PART blocks.', &
      'Remove it from one.'), &
   message_t('KJ-0573', SEV_ERROR, 'a unit is not understood', &
      'A unit of /BEGIN or /UNIT is a prefix and g, m or s, or the SI value of the unit, '// &
      '1e-30 to 1e30. A deck without /BEGIN has no units.', 'For example kg, m, s or Mg, mm, s.'), &
   message_t('KJ-0574', SEV_ERROR, 'the deck has no units', 'Both triples of /BEGIN are blank.', &
      'Write the units of mass, length and time, for example kg, m, s.'), &
   message_t('KJ-0659', SEV_ERROR, 'the unit system does not exist', &
      'The last number of a header is the id of a /UNIT, and there is none.', &
      'Define /UNIT with this id, or remove the number.'), &
   message_t('KJ-0754', SEV_NOTE, 'input units and work units differ', &
      'The cards are converted from the input units to the work units; results are in work '// &
      'units.', 'Nothing, if this is meant.'), &
   message_t('KJ-0760', SEV_ERROR, 'the reader of Radioss stops here', &
      'OpenRadioss ends with a trap at this place, without a reason.', 'See the finding.'), &
   message_t('KJ-0774', SEV_WARNING, 'rotational displacements are not kept', &
      'DRX, DRY and DRZ are zero in Radioss unless Irot is set in /IOFLAG.', 'Set Irot to 1.'), &
   message_t('KJ-1109', SEV_ERROR, 'the request has no variable', 'No name in a /TH block exists.', &
      'Write DEF, or names of variables.'), &
   message_t('KJ-1610', SEV_WARNING, 'a part of a history does not exist', 'A /TH/PART asks for a part that no /PART defines.', &
      'Correct the id.'), &
   message_t('KJ-2000', SEV_ERROR, 'the reader asked to stop', 'The reader of the deck found something it cannot go on with.', &
      'See the other findings.'), &
   message_t('KJ-2046', SEV_ERROR, 'the keyword needs a newer format', 'The format version of /BEGIN is older than this keyword.', &
      'Raise the version in /BEGIN and check the layouts.'), &
   message_t('KJ-9001', SEV_ERROR, 'not a real number', &
      'The field has characters that do not belong to a number. Radioss would take the digits '// &
      'before them, or 0, and say nothing.', &
      'Correct the number; a letter O for a zero and columns that slipped by one are the '// &
      'usual causes.'), &
   message_t('KJ-9002', SEV_ERROR, 'not an integer', &
      'The field has characters that do not belong to an integer. Radioss would take the '// &
      'digits before them, or 0, and say nothing.', &
      'Correct the number; look whether the card slipped by a column.'), &
   message_t('KJ-9003', SEV_ERROR, 'blanks inside a number', 'Radioss reads up to the first blank: 1 000 would be 1.', &
      'Remove the blanks, or move the second number into its own field.'), &
   message_t('KJ-9004', SEV_ERROR, 'a fraction in an integer', 'Radioss would cut 1.7 to 1.', &
      'Write an integer; look whether the card slipped by a field.'), &
   message_t('KJ-9005', SEV_ERROR, 'not a finite number', &
      'The number is infinite, not a number, or too large for a real in work units.', &
      'Correct the number.'), &
   message_t('KJ-9006', SEV_ERROR, 'an integer is too large', 'Integers end at 2147483647.', 'Use smaller ids.'), &
   message_t('KJ-9007', SEV_WARNING, 'a tab in a card', &
      'A tab counts as one column, so the fields may not be where they seem to be.', &
      'Replace tabs by blanks.'), &
   message_t('KJ-9008', SEV_ERROR, 'a tab moves a number over the border of its field', &
      'A tab counts as one column: the number stands in two fields.', 'Replace tabs by blanks.'), &
   message_t('KJ-9009', SEV_WARNING, 'text after the last field', &
      'Radioss ignores it. A number there may be meant for a field further left.', &
      'Remove it or put it into a comment line.'), &
   message_t('KJ-9010', SEV_WARNING, 'text between two fields', &
      'The columns belong to no field and are ignored. The layout may depend on the format '// &
      'version of /BEGIN.', 'Check the columns of the card.'), &
   message_t('KJ-9011', SEV_WARNING, 'too many cards', 'The block has more cards than its keyword; Radioss ignores the rest.', &
      'Remove them; look whether a header is missing.'), &
   message_t('KJ-9013', SEV_WARNING, 'an integer written as a real number', '1.0 is read as 1.', 'Write 1.'), &
   message_t('KJ-9014', SEV_WARNING, 'a blank line is a card', 'A blank line is not skipped: all its fields are 0 or blank.', &
      'Remove the line.'), &
   message_t('KJ-9015', SEV_ERROR, 'a parameter that is not defined', 'A field with & names a parameter of /PARAMETER.', &
      'Define it, or write the number.'), &
   message_t('KJ-9016', SEV_WARNING, 'the title seems to be a card', &
      'The line after the header is always the title. Without a title the first card is taken '// &
      'for it.', 'Put a title line after the header.'), &
   message_t('KJ-9020', SEV_ERROR, 'not a keyword', &
      'Radioss ignores a block with an unknown keyword and says nothing; kjoint does not.', &
      'Correct the keyword, or run with --ignore-unsupported.'), &
   message_t('KJ-9021', SEV_ERROR, 'a keyword in lower case', &
      'Radioss ignores a block whose keyword is not in upper case and says nothing.', &
      'Write it in upper case.'), &
   message_t('KJ-9022', SEV_ERROR, 'not supported', 'The keyword or option would change the result, and kjoint does not have it.', &
      'Remove it, or run with --ignore-unsupported and expect another result than Radioss.'), &
   message_t('KJ-9023', SEV_NOTE, 'no effect here', 'The keyword steers the output or the numerics of other solvers.', &
      'Nothing.'), &
   message_t('KJ-9024', SEV_ERROR, 'blanks before a header', 'A header begins in column 1; Radioss stops at one that does not.', &
      'Remove the blanks.'), &
   message_t('KJ-9025', SEV_ERROR, 'a card without a header', &
      'The line belongs to no block: it stands before the first header, or after an #include.', &
      'Put a header before it. An included file must hold whole blocks.'), &
   message_t('KJ-9026', SEV_WARNING, 'text after a header', &
      'Text after the numbers of a header, or numbers where none are due, mean nothing.', &
      'Put it into a comment line.'), &
   message_t('KJ-9027', SEV_ERROR, 'cards of eight columns a field', &
      'Format versions up to 44 have other layouts, which are not supported.', &
      'Convert the deck; if its fields have ten columns, write 2026 as the version.'), &
   message_t('KJ-9029', SEV_WARNING, 'an unknown format version', 'Radioss reads it as the newest version; so does kjoint.', &
      'Write a version that exists, such as 2026.'), &
   message_t('KJ-9030', SEV_ERROR, 'a file cannot be read', 'The file does not exist, may not be read, or is a folder.', &
      'Check the path.'), &
   message_t('KJ-9031', SEV_ERROR, 'an included file cannot be read', &
      'The path of an #include is relative to the folder of the deck.', 'Check the path.'), &
   message_t('KJ-9033', SEV_ERROR, 'a file includes itself', 'Directly or through other files.', &
      'Remove one of the #include lines.'), &
   message_t('KJ-9034', SEV_WARNING, '/END in an included file', &
      'It ends the included file; the deck goes on after the #include.', 'Remove it.'), &
   message_t('KJ-9036', SEV_WARNING, 'a header without its number', &
      'A missing id is 1, as in Radioss; /ADMAS needs a type and an id.', &
      'Write the id after the keyword.'), &
   message_t('KJ-9038', SEV_ERROR, 'a second /BEGIN', 'The deck has two of them; the first one holds.', 'Remove one.'), &
   message_t('KJ-9040', SEV_WARNING, 'an engine keyword stands twice', 'As in Radioss, the first one holds.', 'Remove one.'), &
   message_t('KJ-9041', SEV_WARNING, 'limits of mass of /STOP and /KILL do not act', &
      'Of these two keywords the limit of the energy error acts.', &
      'Use --energy-limit.'), &
   message_t('KJ-9061', SEV_ERROR, 'a keyword of the engine deck in the starter deck', &
      'The deck seems to hold starter and engine deck in one file.', &
      'Put the lines from /RUN on into a file of their own, ROOT_0001.rad.'), &
   message_t('KJ-9062', SEV_ERROR, 'a deck of another program', &
      'Keywords that begin with * are those of LS-DYNA or Abaqus; kjoint reads the block '// &
      'format of Radioss.', &
      'Convert the deck.'), &
   message_t('KJ-9063', SEV_NOTE, 'an old format version', &
      'Cards whose layout of that time is not known are read as those of 2017.', &
      'Look whether `kjoint check` shows the values that you mean.'), &
   message_t('KJ-9064', SEV_ERROR, 'a negative number in the run control', &
      'End time, interval of the histories, factor and least value of the step, first step '// &
      'must not be below zero.', &
      'Correct the sign; 0 stands for the default.'), &
   message_t('KJ-9065', SEV_WARNING, 'a factor of the time step above 1', &
      'The step is the factor times the critical one. Beyond that the scheme is unstable.', &
      'Write 0.9, or 0 for the default.'), &
   message_t('KJ-9066', SEV_ERROR, 'the run goes on from a restart file', &
      '/RUN/name/2 and above go on where the run before ended, from its checkpoint '// &
      'RUN.restart.h5. Restart files of other solvers are not read.', &
      'Run the deck of run 1 with --checkpoint first, or name a file by --restart.'), &
   message_t('KJ-9067', SEV_ERROR, 'the time step is held by added mass', &
      '/DT/NODA/CST adds mass to nodes and bodies until their step is as wanted. The '// &
      'consistent formulation changes no mass.', &
      'Run with --legacy; with --ignore-unsupported; or lower Kn until the step is as wanted.'), &
   message_t('KJ-9069', SEV_WARNING, 'the deck may be cut', &
      'Its last line is a card without a line end, and no /END follows.', &
      'Look whether the last numbers are whole, and write /END.'), &
   message_t('KJ-9070', SEV_ERROR, 'the deck ends in the middle', &
      'The last block lacks cards, or the last card its line end, and no /END follows: the '// &
      'file seems to be cut.', 'Copy the whole file; or complete the block and write /END.'), &
   message_t('KJ-9079', SEV_ERROR, 'a run of years', &
      'By its end time, its steps and its intervals of samples the run would take more than '// &
      '1e12 cycles.', 'Lower Kn, take longer intervals or an earlier end; or say --force.'), &
   message_t('KJ-9153', SEV_ERROR, 'histories relative to a frame', &
      'A /TH/NODE may name a skew for its components; frames are not supported.', &
      'Name a skew, or 0.'), &
   message_t('KJ-9156', SEV_WARNING, 'histories of parts', '/TH/PART is read and checked, but nothing is written for it.', &
      'See the histories of joints and bodies.'), &
   message_t('KJ-E073', SEV_ERROR, 'a keyword lacks values', &
      'The line after the keyword has fewer numbers than it needs, or is missing.', &
      'Write the values on the next line, between blanks or commas.'), &
   message_t('KJ-E189', SEV_ERROR, 'not an engine keyword', &
      'Only the first five characters of a word count, in upper case; Radioss stops at all '// &
      'others.', 'Correct the keyword.'), &
   message_t('KJ-E194', SEV_ERROR, 'the engine deck has no /RUN', 'Without /RUN there is no end of the run.', &
      'Write /RUN/name/1 and on the next line the end time.'), &
   message_t('KJ-E195', SEV_ERROR, 'the run number is not positive', 'The last number of /RUN must be 1 or more.', &
      'Write /RUN/name/1.'), &
   message_t('KJ-E196', SEV_ERROR, 'the version of the engine deck is too old', '/VERS must be 18 or more.', &
      'Write the version, for example /VERS/2022.'), &
   message_t('KJ-E198', SEV_ERROR, 'the version of the history file does not exist', '/TH/VERS must be 40 or more.', &
      'Remove the keyword: kjoint does not need it.'), &
   message_t('KJ-E246', SEV_ERROR, 'no such kind of nodal time step', '/DT/NODA/DEL and /DT/NODE do not exist.', &
      'Use /DT/NODA, /DT/NODA/CST or /DT/NODA/STOP.'), &
   message_t('KJ-E316', SEV_ERROR, 'the first time step is larger than the largest', &
      '/DTIX has the first and the largest time step, in this order.', &
      'Exchange them, or write 0 for a largest step without limit.')]

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

end module kj_message_text
