// Handlers of arithmetic, logic, moves and multiplication.
#pragma once

#include "avr/ops.h"

namespace tilenca::avr::ops {

TILENCA_OP(add);
TILENCA_OP(adc);
TILENCA_OP(sub);
TILENCA_OP(subi);
TILENCA_OP(sbc);
TILENCA_OP(sbci);
TILENCA_OP(cp);
TILENCA_OP(cpc);
TILENCA_OP(cpi);
TILENCA_OP(and_);
TILENCA_OP(andi);
TILENCA_OP(or_);
TILENCA_OP(ori);
TILENCA_OP(eor);
TILENCA_OP(com);
TILENCA_OP(neg);
TILENCA_OP(inc);
TILENCA_OP(dec);
TILENCA_OP(lsr);
TILENCA_OP(ror);
TILENCA_OP(asr);
TILENCA_OP(swap);
TILENCA_OP(adiw);
TILENCA_OP(sbiw);
TILENCA_OP(ldi);
TILENCA_OP(mov);
TILENCA_OP(movw);
TILENCA_OP(mul);
TILENCA_OP(muls);
TILENCA_OP(mulsu);
TILENCA_OP(fmul);
TILENCA_OP(fmuls);
TILENCA_OP(fmulsu);

} // namespace tilenca::avr::ops
