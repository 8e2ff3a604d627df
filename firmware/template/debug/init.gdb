# gdb-multiarch -x debug/init.gdb app.elf, in this folder; first, in another terminal: make debug
source debug/svd.py
target remote :3333
break main
continue
