#!/bin/sh
# Launcher of the compiler. A source with several -march is compiled once for each, the last of them is
# number 0; each procedure then stands there once for each, its name with the number behind, and by
# its name as a jump to the one of the number in kj_kernel (kj_kernels.c).
set -eu
object='' last='' machines=''
for word; do
   case $word in -march=*) machines="$word $machines" ;; esac
   [ "$last" != -o ] || object=$word
   last=$word
done
case $machines in *-march=*-march=*) ;; *) exec "$@" ;; esac

# number 0 makes the .mod files, too; the others run beside it and see their own first, never those of
# an earlier build
variant() {                                     # machine, its number, the command
   extra=$1 part=$object.$2 compiler=$3
   shift 3
   mkdir -p "$part.mod"
   for word; do
      shift
      case $word in -J*) ;; *) set -- "$@" "$word" ;; esac
   done
   "$compiler" "-J$part.mod" "-I$part.mod" "$@" "$extra" -o "$part"
}
n=0
parts='' running=''
for machine in $machines; do
   parts="$parts $object.$n"
   if [ $n -gt 0 ]; then
      variant "$machine" $n "$@" &
      running="$running $!"
   fi
   n=$((n + 1))
done
status=0
"$@" || status=$?
for one in $running; do wait "$one" || status=$?; done
[ $status = 0 ] || exit $status
mv "$object" "$object.0"

compiler=$1
tool() { "$compiler" -print-prog-name="$1"; }
$(tool nm) --defined-only -g "$object.0" | awk '$2 == "T" { print $3 }' >"$object.names"
{
   echo '.hidden kj_kernel'
   while read -r name; do
      echo ".section .data.rel.ro,\"aw\"; .balign 8; $name.at:"
      for part in $parts; do
         echo ".hidden $name.${part##*.}; .quad $name.${part##*.}"
      done
      echo ".text; .balign 16; .globl $name; .type $name, @function; $name:"
      echo "movslq kj_kernel(%rip), %rax; lea $name.at(%rip), %r11; jmp *(%r11, %rax, 8)"
      echo ".size $name, . - $name"
   done <"$object.names"
   echo '.section .note.GNU-stack,"",@progbits'
} | "$compiler" -x assembler -c -o "$object.jumps" -

for part in $parts; do
   weaken=                                      # what is not a procedure stays that of number 0
   [ "${part##*.}" = 0 ] || weaken=--weaken
   awk -v n="${part##*.}" '{ print $1, $1 "." n }' "$object.names" >"$object.map"
   $(tool objcopy) $weaken --redefine-syms="$object.map" "$part"
done
$(tool ld) -r -o "$object" "$object.jumps" $parts
rm -rf "$object.jumps" "$object.names" "$object.map" "$object".[0-9]*
