!> Our own messages on the text of a deck.
module kj_message_own
   use kj_error, only: SEV_ERROR, SEV_NOTE, SEV_WARNING
   use kj_message_row, only: message_t
   implicit none
   private

   type(message_t), parameter, public :: own_messages(*) = [ &
   message_t('KJ-9001', SEV_ERROR, 'not a real number', &
      'The field has characters that do not belong to a number. Radioss would take the '// &
      'digits before them, or 0, and say nothing.', &
      'Correct the number; a letter O for a zero and columns that slipped by one are the '// &
      'usual causes.'), &
   message_t('KJ-9002', SEV_ERROR, 'not an integer', &
      'The field has characters that do not belong to an integer. Radioss would take the '// &
      'digits before them, or 0, and say nothing.', &
      'Correct the number; look whether the card slipped by a column.'), &
   message_t('KJ-9003', SEV_ERROR, 'blanks inside a number', &
      'Radioss reads up to the first blank: 1 000 would be 1.', &
      'Remove the blanks, or move the second number into its own field.'), &
   message_t('KJ-9004', SEV_ERROR, 'a fraction in an integer', &
      'Radioss would cut 1.7 to 1.', &
      'Write an integer; look whether the card slipped by a field.'), &
   message_t('KJ-9005', SEV_ERROR, 'not a finite number', &
      'The number is infinite, not a number, or too large for a real in work units.', &
      'Correct the number.'), &
   message_t('KJ-9006', SEV_ERROR, 'an integer is too large', &
      'Integers end at 2147483647.', &
      'Use smaller ids.'), &
   message_t('KJ-9007', SEV_WARNING, 'a tab in a card', &
      'A tab counts as one column, so the fields may not be where they seem to be.', &
      'Replace tabs by blanks.'), &
   message_t('KJ-9008', SEV_ERROR, 'a tab moves a number over the border of its field', &
      'A tab counts as one column: the number stands in two fields.', &
      'Replace tabs by blanks.'), &
   message_t('KJ-9009', SEV_WARNING, 'text after the last field', &
      'Radioss ignores it. A number there may be meant for a field further left.', &
      'Remove it or put it into a comment line.'), &
   message_t('KJ-9010', SEV_WARNING, 'text between two fields', &
      'The columns belong to no field and are ignored. The layout may depend on the '// &
      'format version of /BEGIN.', &
      'Check the columns of the card.'), &
   message_t('KJ-9011', SEV_WARNING, 'too many cards', &
      'The block has more cards than its keyword; Radioss ignores the rest.', &
      'Remove them; look whether a header is missing.'), &
   message_t('KJ-9013', SEV_WARNING, 'an integer written as a real number', &
      '1.0 is read as 1.', &
      'Write 1.'), &
   message_t('KJ-9014', SEV_WARNING, 'a blank line is a card', &
      'A blank line is not skipped: all its fields are 0 or blank.', &
      'Remove the line.'), &
   message_t('KJ-9015', SEV_ERROR, 'parameters are not supported', &
      'A field with & names a parameter of /PARAMETER.', &
      'Write the number.'), &
   message_t('KJ-9016', SEV_WARNING, 'the title seems to be a card', &
      'The line after the header is always the title. Without a title the first card is '// &
      'taken for it.', &
      'Put a title line after the header.'), &
   message_t('KJ-9020', SEV_ERROR, 'not a keyword', &
      'Radioss ignores a block with an unknown keyword and says nothing; kjoint does not.', &
      'Correct the keyword, or run with --ignore-unsupported.'), &
   message_t('KJ-9021', SEV_ERROR, 'a keyword in lower case', &
      'Radioss ignores a block whose keyword is not in upper case and says nothing.', &
      'Write it in upper case.'), &
   message_t('KJ-9022', SEV_ERROR, 'not supported', &
      'The keyword or option would change the result, and kjoint does not have it.', &
      'Remove it, or run with --ignore-unsupported and expect another result than '// &
      'Radioss.'), &
   message_t('KJ-9023', SEV_NOTE, 'no effect here', &
      'The keyword steers the output or the numerics of other solvers.', &
      'Nothing.'), &
   message_t('KJ-9024', SEV_ERROR, 'blanks before a header', &
      'A header begins in column 1; Radioss stops at one that does not.', &
      'Remove the blanks.'), &
   message_t('KJ-9025', SEV_ERROR, 'a card without a header', &
      'The line belongs to no block: it stands before the first header, or after an '// &
      '#include.', &
      'Put a header before it. An included file must hold whole blocks.'), &
   message_t('KJ-9026', SEV_WARNING, 'text after a header', &
      'Text after the numbers of a header, or numbers where none are due, mean nothing.', &
      'Put it into a comment line.'), &
   message_t('KJ-9027', SEV_ERROR, 'cards of eight columns a field', &
      'Format versions up to 44 have other layouts, which are not supported.', &
      'Convert the deck; if its fields have ten columns, write 2026 as the version.'), &
   message_t('KJ-9028', SEV_ERROR, 'an old layout of /PROP/KJOINT2', &
      'Before version 2019 the cards of /PROP/KJOINT2 were others, which are not '// &
      'supported.', &
      'Convert the property and raise the version in /BEGIN.'), &
   message_t('KJ-9029', SEV_WARNING, 'an unknown format version', &
      'Radioss reads it as the newest version; so does kjoint.', &
      'Write a version that exists, such as 2026.'), &
   message_t('KJ-9030', SEV_ERROR, 'a file cannot be read', &
      'The file does not exist, may not be read, or is a folder.', &
      'Check the path.'), &
   message_t('KJ-9031', SEV_ERROR, 'an included file cannot be read', &
      'The path of an #include is relative to the folder of the deck.', &
      'Check the path.'), &
   message_t('KJ-9033', SEV_ERROR, 'a file includes itself', &
      'Directly or through other files.', &
      'Remove one of the #include lines.'), &
   message_t('KJ-9034', SEV_WARNING, '/END in an included file', &
      'It ends the included file; the deck goes on after the #include.', &
      'Remove it.'), &
   message_t('KJ-9036', SEV_WARNING, 'a header without its number', &
      'A missing id is 1, as in Radioss; /ADMAS needs a type and an id.', &
      'Write the id after the keyword.'), &
   message_t('KJ-9038', SEV_ERROR, 'a second /BEGIN', &
      'The deck has two of them; the first one holds.', &
      'Remove one.'), &
   message_t('KJ-9040', SEV_WARNING, 'an engine keyword stands twice', &
      'As in Radioss, the first one holds.', &
      'Remove one.'), &
   message_t('KJ-9041', SEV_WARNING, 'limits of /STOP and /KILL do not act', &
      'kjoint has a limit of the energy error of its own.', &
      'Use --energy-limit.'), &
   message_t('KJ-9042', SEV_NOTE, 'stops without damping take shorter steps', &
      'Steps change at every stop, which shakes blocked directions that ring. Where some Cr is '// &
      'below 0.01 steps are half of the critical one at most.', &
      'Leave --dt-scale out, or give a larger Cr.'), &
   message_t('KJ-9301', SEV_WARNING, 'a joint loses its right angles', &
      'The axes of a joint come from nodes or bodies that are meant to be rigid. They strain '// &
      'or turn against each other, and the directions of the joint lose their right angles.', &
      'Stiffen what carries the joint, or let its axes follow one node with rotations.')]

end module kj_message_own
