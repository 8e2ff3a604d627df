// What a Verilated test build has around the design of coprocessor.f, read after it.
verification/coprocessor_probe.sv
