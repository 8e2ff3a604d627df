// SPDX-License-Identifier: Apache-2.0
// What a Verilated test build has around the design of coprocessor.f, read after it.
verification/coprocessor_probe.sv
