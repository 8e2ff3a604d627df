# SPDX-License-Identifier: Apache-2.0
# Constraints of the coprocessor as a block: one clock, an asynchronous reset, and ports that are synchronous to the clock. Times in ns.

# PCLK, 25 MHz: the rate of the board and of the figures in docs/explanation/papers.md.
set period 40.0
create_clock -name pclk -period $period [get_ports pclk_i]

# The reset acts at once and is released at least one recovery time before an edge: the system releases it through a synchroniser of two
# flip-flops of PCLK (asynchronous set, synchronous release). So its fall is no path, and its rise comes with the clock.
set_false_path -fall_from [get_ports presetn_i]
set_input_delay -clock pclk -max [expr {0.4 * $period}] [get_ports presetn_i]
set_input_delay -clock pclk -min 0.0 [get_ports presetn_i]

# APB and the stream of the ADC are synchronous to PCLK. A converter with a clock of its own hands its samples over through the
# synchroniser that is part of it, not of this block.
set inputs {psel_i penable_i pwrite_i paddr_i* pwdata_i* pstrb_i* sample_valid_i sample_u_i* sample_v_i* sample_clip_i sample_channel_i*}
set outputs {pready_o prdata_o* pslverr_o sample_ready_o irq_o idle_o}
set_input_delay -clock pclk -max [expr {0.4 * $period}] [get_ports $inputs]
set_input_delay -clock pclk -min 0.0 [get_ports $inputs]
set_output_delay -clock pclk -max [expr {0.4 * $period}] [get_ports $outputs]
set_output_delay -clock pclk -min 0.0 [get_ports $outputs]
