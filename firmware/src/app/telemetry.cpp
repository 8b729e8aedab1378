#include "app/telemetry.h"

namespace tilenca {

void write_hello(const Tile& tile, uint8_t reset_cause, Sentence* sentence) {
    sentence->begin("HELLO");
    sentence->number(kProtocolVersion);
    sentence->number(tile.settings().tile_id);
    sentence->hex(tile.model().id, 4);
    sentence->number(tile.model().network.channels());
    sentence->number(tile.model().classes);
    sentence->number(tile.settings().period_ms);
    sentence->number(tile.settings().updates);
    sentence->hex(reset_cause, 2);
    sentence->end();
}

void write_tile(const Tile& tile, uint32_t now_ms, Sentence* sentence) {
    sentence->begin("TILE");
    sentence->number(tile.settings().tile_id);
    sentence->number(now_ms);
    sentence->number(tile.updates());
    sentence->nothing();
    if (tile.shown() != Tile::kNothing) {
        sentence->more(tile.model().looks[tile.shown()].label);
    }
    sentence->nothing();
    for (uint8_t i = 0; i < kSides; ++i) {
        sentence->more(tile.link(side_at(i)).alive() ? kSideLetters[i] : '-');
    }
    sentence->nothing();
    for (uint8_t c = 0; c < tile.model().network.channels(); ++c) {
        sentence->more_hex(static_cast<uint8_t>(tile.message()[c]) + kMessageOffset);
    }
    sentence->end();
}

void write_link(const Tile& tile, Side side, uint32_t now_ms, Sentence* sentence) {
    const Link& link = tile.link(side);
    sentence->begin("LINK");
    sentence->number(tile.settings().tile_id);
    sentence->number(now_ms);
    sentence->nothing();
    sentence->more(kSideLetters[index_of(side)]);
    sentence->number(link.counters().sent);
    sentence->number(link.counters().received);
    sentence->number(link.counters().corrupt);
    sentence->number(link.counters().lost);
    sentence->number(link.counters().foreign);
    if (link.ever_received()) {
        sentence->number(link.age_ms(now_ms));
    } else {
        sentence->nothing();
    }
    sentence->end();
}

void Telemetry::period_ended(const Tile& tile) {
    const uint32_t ended_ms = tile.period_ended_ms();
    const bool label_changed = tile.shown() != last_shown_;
    if (any_yet_ && !label_changed && ended_ms - last_ms_ < kTilePeriodMs) {
        return;
    }
    any_yet_ = true;
    last_ms_ = ended_ms;
    last_shown_ = tile.shown();
    tile_due_ = true;
}

bool Telemetry::next(const Tile& tile, uint32_t now_ms, Sentence* sentence) {
    if (tile_due_) {
        tile_due_ = false;
        link_due_ = true;
        write_tile(tile, now_ms, sentence);
        return true;
    }
    if (link_due_) {
        link_due_ = false;
        write_link(tile, side_at(next_side_), now_ms, sentence);
        next_side_ = (next_side_ + 1) % kSides;
        return true;
    }
    return false;
}

} // namespace tilenca
