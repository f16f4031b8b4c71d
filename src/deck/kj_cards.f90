!> Cards -> typed values, with a place for each: one name for the readers of all kinds of blocks.
module kj_cards
   use kj_deck_text, only: report_header
   use kj_cards_once, only: cards_t, read_cards, real_of, int_of, text_of, is_given, report
   use kj_cards_repeated, only: rows_t, read_rows, report_row
   use kj_cards_ids, only: ids_t, clauses_t, read_ids, read_clauses, report_id
   use kj_cards_th, only: th_t, read_th
   implicit none
   private

   public :: cards_t, read_cards, real_of, int_of, text_of, is_given, report, report_header
   public :: rows_t, read_rows, report_row
   public :: ids_t, read_ids, report_id, clauses_t, read_clauses
   public :: th_t, read_th
end module kj_cards
