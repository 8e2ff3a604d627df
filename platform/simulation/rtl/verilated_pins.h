// The pins of the coprocessor between rtl_abi.h and a class that Verilator made.
#pragma once

#include "rtl/rtl_abi.h"

namespace capsoc::rtl {

template <typename Top>
void drive_pins(Top& top, const capsoc_rtl_pins& p) {
  top.presetn_i = p.presetn;
  top.psel_i = p.psel;
  top.penable_i = p.penable;
  top.pwrite_i = p.pwrite;
  top.pstrb_i = p.pstrb;
  top.paddr_i = p.paddr;
  top.pwdata_i = p.pwdata;
  top.sample_valid_i = p.sample_valid;
  top.sample_clip_i = p.sample_clip;
  top.sample_channel_i = p.sample_channel;
  top.sample_u_i = p.sample_u;
  top.sample_v_i = p.sample_v;
}

template <typename Top>
void fetch_pins(const Top& top, capsoc_rtl_pins& p) {
  p.pready = top.pready_o;
  p.pslverr = top.pslverr_o;
  p.prdata = top.prdata_o;
  p.sample_ready = top.sample_ready_o;
  p.irq = top.irq_o;
  p.idle = top.idle_o;
}

}  // namespace capsoc::rtl
