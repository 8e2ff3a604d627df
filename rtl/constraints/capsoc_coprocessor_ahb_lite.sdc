# SPDX-License-Identifier: Apache-2.0
# Constraints of capsoc_coprocessor_ahb_lite as a block. coprocessor.sdc has the reasons. Times in ns.

set period 40.0
create_clock -name hclk -period $period [get_ports hclk_i]

# The reset is released by a synchroniser of HCLK: its fall is no path.
set_false_path -fall_from [get_ports hresetn_i]
set_input_delay -clock hclk -max [expr {0.4 * $period}] [get_ports hresetn_i]
set_input_delay -clock hclk -min 0.0 [get_ports hresetn_i]

# AHB-Lite and the stream of the ADC are synchronous to HCLK.
set inputs {hsel_i haddr_i* hwrite_i htrans_i* hsize_i* hready_i hwdata_i* sample_valid_i sample_u_i* sample_v_i* sample_clip_i sample_channel_i*}
set outputs {hreadyout_o hrdata_o* hresp_o sample_ready_o irq_o idle_o}
set_input_delay -clock hclk -max [expr {0.4 * $period}] [get_ports $inputs]
set_input_delay -clock hclk -min 0.0 [get_ports $inputs]
set_output_delay -clock hclk -max [expr {0.4 * $period}] [get_ports $outputs]
set_output_delay -clock hclk -min 0.0 [get_ports $outputs]
