# Texts in a program: writes the C file OUT with a table of the names and bytes of FILES, for
# kj_shipped_deck.c. Run as a script: cmake -DOUT=... -DFILES="a;b" -P kjoint_embed.cmake
set(text "/* made by kjoint_embed.cmake */\n#include \"kj_shipped_deck.h\"\n")
set(rows "")
set(i 0)
foreach(file IN LISTS FILES)
  cmake_path(GET file FILENAME name)
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  string(REGEX REPLACE "(................................................................................)"
    "\\1\n" bytes "${bytes}")
  string(APPEND text "static const unsigned char text${i}[] = {\n${bytes}0};\n")
  string(APPEND rows "  {\"${name}\", text${i}, sizeof text${i} - 1},\n")
  math(EXPR i "${i} + 1")
endforeach()
string(APPEND text "const kj_shipped_deck kj_shipped_decks[] = {\n${rows}  {0, 0, 0}};\n")
file(WRITE "${OUT}" "${text}")
