#!/bin/sh
# Launcher of the compiler. A source with several -march is compiled once for each, the last of them first; each
# procedure then stands there once for each, its name with a number behind, and by its name as a jump
# to the one of the number in kj_kernel (kj_kernels.c).
set -eu
object='' last='' machines=''
for word; do
   case $word in -march=*) machines="$word $machines" ;; esac
   [ "$last" != -o ] || object=$word
   last=$word
done
"$@"
case $machines in *-march=*-march=*) ;; *) exit 0 ;; esac

tool() { "$compiler" -print-prog-name="$1"; }
compiler=$1
$(tool nm) --defined-only -g "$object" | awk '$2 == "T" { print $3 }' >"$object.names"
{
   echo '.hidden kj_kernel'
   while read -r name; do
      echo ".section .data.rel.ro,\"aw\"; .balign 8; $name.at:"
      n=0
      for machine in $machines; do
         echo ".hidden $name.$n; .quad $name.$n"
         n=$((n + 1))
      done
      echo ".text; .balign 16; .globl $name; .type $name, @function; $name:"
      echo "movslq kj_kernel(%rip), %rax; lea $name.at(%rip), %r11; jmp *(%r11, %rax, 8)"
      echo ".size $name, . - $name"
   done <"$object.names"
   echo '.section .note.GNU-stack,"",@progbits'
} | "$compiler" -x assembler -c -o "$object.jumps" -

n=0
parts=$object.jumps
for machine in $machines; do
   weaken=
   if [ $n -gt 0 ]; then                      # what is not a procedure stays that of the first
      "$@" "$machine" -o "$object.$n"
      weaken=--weaken
   else
      mv "$object" "$object.0"
   fi
   awk -v n=$n '{ print $1, $1 "." n }' "$object.names" >"$object.map"
   $(tool objcopy) $weaken --redefine-syms="$object.map" "$object.$n"
   parts="$parts $object.$n"
   n=$((n + 1))
done
$(tool ld) -r -o "$object" $parts
rm -f $parts "$object.names" "$object.map"
