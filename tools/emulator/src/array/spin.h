// Waiting for another thread, which takes microseconds at most.
#pragma once

namespace tilenca {

// So often a thread looks out before it lets another program have its processor.
constexpr int kSpins = 2000;
// So often it looks out before it does what another thread was to do. Tiles that change their thread have to
// change caches, too, so this takes longer than a tile's turn.
constexpr int kPatience = 30;

// Leaves the other thread of the same core more of it.
inline void relax() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

} // namespace tilenca
