# Texts in a program: writes the C file OUT with the names and bytes of FILES, for kj_new_command.
# Run as a script: cmake -DOUT=... -DFILES="a;b" -P kjoint_embed.cmake
set(texts "")
set(names "")
set(rows "")
set(i 0)
foreach(file IN LISTS FILES)
  cmake_path(GET file FILENAME name)
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  string(REGEX REPLACE "(................................................................................)"
    "\\1\n" bytes "${bytes}")
  string(APPEND texts "static const unsigned char text${i}[] = {\n${bytes}0};\n")
  string(APPEND names "  \"${name}\",\n")
  string(APPEND rows "  text${i},\n")
  math(EXPR i "${i} + 1")
endforeach()
file(WRITE "${OUT}" "/* made by kjoint_embed.cmake */
${texts}
int kj_shipped_count(void) { return ${i}; }

const char *kj_shipped_name(int i)
{
  static const char *const names[] = {\n${names}};
  return names[i];
}

const unsigned char *kj_shipped_text(int i)
{
  static const unsigned char *const texts[] = {\n${rows}};
  return texts[i];
}
")
