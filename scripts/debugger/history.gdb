# For capsoc run --gdb-history: `monitor goto` and `monitor history` take the processor somewhere else, and no packet
# tells GDB so. With `source history.gdb` it reads the registers anew after each `monitor`.
define hookpost-monitor
  maintenance flush register-cache
end
