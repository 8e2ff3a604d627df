# SPDX-License-Identifier: Apache-2.0
# Constraints of capsoc_coprocessor_axi4_lite as a block. coprocessor.sdc has the reasons. Times in ns.

set period 40.0
create_clock -name aclk -period $period [get_ports aclk_i]

# The reset is released by a synchroniser of ACLK: its fall is no path.
set_false_path -fall_from [get_ports aresetn_i]
set_input_delay -clock aclk -max [expr {0.4 * $period}] [get_ports aresetn_i]
set_input_delay -clock aclk -min 0.0 [get_ports aresetn_i]

# AXI4-Lite and the stream of the ADC are synchronous to ACLK.
set inputs {awvalid_i awaddr_i* awprot_i* wvalid_i wdata_i* wstrb_i* bready_i arvalid_i araddr_i* arprot_i* rready_i sample_valid_i sample_u_i* sample_v_i* sample_clip_i sample_channel_i*}
set outputs {awready_o wready_o bvalid_o bresp_o* arready_o rvalid_o rdata_o* rresp_o* sample_ready_o irq_o idle_o}
set_input_delay -clock aclk -max [expr {0.4 * $period}] [get_ports $inputs]
set_input_delay -clock aclk -min 0.0 [get_ports $inputs]
set_output_delay -clock aclk -max [expr {0.4 * $period}] [get_ports $outputs]
set_output_delay -clock aclk -min 0.0 [get_ports $outputs]
