/* Name and text of a deck that the program holds, for Fortran */
#include "kj_shipped_deck.h"

/* Number of decks */
int kj_shipped_count(void)
{
   int n = 0;
   while (kj_shipped_decks[n].name) n++;
   return n;
}

const char *kj_shipped_name(int i) { return kj_shipped_decks[i].name; }

const unsigned char *kj_shipped_text(int i, size_t *n)
{
   *n = kj_shipped_decks[i].n;
   return kj_shipped_decks[i].text;
}
