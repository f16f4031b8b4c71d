/* The decks that the program holds: decks/, in alphabetical order; the last row has no name */
#ifndef KJ_SHIPPED_DECK_H
#define KJ_SHIPPED_DECK_H
#include <stddef.h>

typedef struct { const char *name; const unsigned char *text; size_t n; } kj_shipped_deck;

extern const kj_shipped_deck kj_shipped_decks[];
#endif
