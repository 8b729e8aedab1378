// Handlers of branches, skips, jumps, calls, bits of SREG, and what stops or rests the core.
#pragma once

#include "avr/ops.h"

namespace tilenca::avr::ops {

TILENCA_OP(rjmp);
TILENCA_OP(jmp);
TILENCA_OP(ijmp);
TILENCA_OP(eijmp);
TILENCA_OP(rcall);
TILENCA_OP(call);
TILENCA_OP(icall);
TILENCA_OP(eicall);
TILENCA_OP(ret);
TILENCA_OP(reti);
TILENCA_OP(cpse);
TILENCA_OP(sbrc);
TILENCA_OP(sbrs);
TILENCA_OP(sbic);
TILENCA_OP(sbis);
TILENCA_OP(brcs);
TILENCA_OP(brcc);
TILENCA_OP(breq);
TILENCA_OP(brne);
TILENCA_OP(brmi);
TILENCA_OP(brpl);
TILENCA_OP(brvs);
TILENCA_OP(brvc);
TILENCA_OP(brlt);
TILENCA_OP(brge);
TILENCA_OP(brhs);
TILENCA_OP(brhc);
TILENCA_OP(brts);
TILENCA_OP(brtc);
TILENCA_OP(brie);
TILENCA_OP(brid);
TILENCA_OP(bset);
TILENCA_OP(sei);
TILENCA_OP(cli);
TILENCA_OP(bclr);
TILENCA_OP(bst);
TILENCA_OP(bld);
TILENCA_OP(nop);
TILENCA_OP(sleep);
TILENCA_OP(wdr);
TILENCA_OP(break_);
TILENCA_OP(trap);
TILENCA_OP(illegal);
TILENCA_OP(erased);
TILENCA_OP(beyond_flash);

} // namespace tilenca::avr::ops
