!> Messages on the text of a deck: files, cards, numbers, units, keywords, requests, engine deck; on
!> the scene: nodes, groups, axes, functions, bodies, loads, motion; on full decks.
!> One file: one table, by what its rows are about
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

end module kj_message_text
