// Handlers of loads, stores, the stack, I/O space and program memory.
#pragma once

#include "avr/ops.h"

namespace tilenca::avr::ops {

TILENCA_OP(ld_x);
TILENCA_OP(ld_x_plus);
TILENCA_OP(ld_minus_x);
TILENCA_OP(ldd_y);
TILENCA_OP(ld_y_plus);
TILENCA_OP(ld_minus_y);
TILENCA_OP(ldd_z);
TILENCA_OP(ld_z_plus);
TILENCA_OP(ld_minus_z);
TILENCA_OP(lds);
TILENCA_OP(st_x);
TILENCA_OP(st_x_plus);
TILENCA_OP(st_minus_x);
TILENCA_OP(std_y);
TILENCA_OP(st_y_plus);
TILENCA_OP(st_minus_y);
TILENCA_OP(std_z);
TILENCA_OP(st_z_plus);
TILENCA_OP(st_minus_z);
TILENCA_OP(sts);
TILENCA_OP(push);
TILENCA_OP(pop);
TILENCA_OP(in);
TILENCA_OP(out);
TILENCA_OP(in_status);
TILENCA_OP(out_status);
TILENCA_OP(sbi);
TILENCA_OP(cbi);
TILENCA_OP(lpm);
TILENCA_OP(lpm_plus);
TILENCA_OP(elpm);
TILENCA_OP(elpm_plus);
TILENCA_OP(spm);
TILENCA_OP(spm_plus);

} // namespace tilenca::avr::ops
