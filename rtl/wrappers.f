// SPDX-License-Identifier: Apache-2.0
// What puts the design of coprocessor.f on other buses, read after it: a bridge to APB and a top for each bus.
wrappers/capsoc_ahb_lite_to_apb.sv
wrappers/capsoc_axi4_lite_to_apb.sv
wrappers/capsoc_coprocessor_ahb_lite.sv
wrappers/capsoc_coprocessor_axi4_lite.sv
