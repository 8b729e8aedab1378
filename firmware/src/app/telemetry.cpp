#include "app/telemetry.h"

namespace tilenca {

namespace {

const char* const kErrorCodes[kErrors] = {"SETTINGS", "WATCHDOG", "STACK", "SUPPLY"};

} // namespace

void write_hello(const Tile& tile, const Boot& boot, Sentence* sentence) {
    sentence->begin("HELLO");
    sentence->number(kProtocolVersion);
    sentence->number(tile.settings().tile_id);
    sentence->hex(tile.model().id, 4);
    sentence->number(tile.model().network.channels());
    sentence->number(tile.model().classes);
    sentence->number(tile.settings().period_ms);
    sentence->number(tile.settings().updates);
    sentence->hex(boot.reset_cause, 2);
    sentence->hex(boot.firmware_id, 8);
    sentence->number(tile.settings().brightness);
    if (tile.model().directions) {
        sentence->number(tile.model().directions);
    }
    sentence->end();
}

void write_chip(const Tile& tile, const Boot& boot, Sentence* sentence) {
    sentence->begin("CHIP");
    sentence->number(tile.settings().tile_id);
    for (uint8_t byte : boot.fuses) {
        sentence->hex(byte, 2);
    }
    const Settings& board = tile.settings();
    board.revision != 0 ? sentence->number(board.revision) : sentence->nothing();
    board.revision != 0 ? sentence->number(board.serial) : sentence->nothing();
    sentence->end();
}

void write_tile(const Tile& tile, uint32_t now_ms, Sentence* sentence) {
    sentence->begin("TILE");
    sentence->number(tile.settings().tile_id);
    sentence->number(now_ms);
    sentence->number(tile.updates());
    const bool decided = tile.shown() != Tile::kNothing;
    sentence->nothing();
    if (decided) {
        sentence->more(tile.model().looks[tile.shown()].label);
    }
    decided ? sentence->number(tile.shown()) : sentence->nothing();
    tile.margin() != Decision::kNoMargin ? sentence->number(tile.margin()) : sentence->nothing();
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

void write_link(const Tile& tile, Side side, uint16_t overruns, uint32_t now_ms, Sentence* sentence) {
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
    const bool heard = link.ever_received();
    heard ? sentence->number(link.age_ms(now_ms)) : sentence->nothing();
    sentence->number(overruns);
    heard ? sentence->number(link.neighbour()) : sentence->nothing();
    sentence->nothing();
    if (heard) {
        sentence->more(kSideLetters[index_of(link.neighbour_side())]);
    }
    sentence->end();
}

void write_time(const Tile& tile, const Health& health, uint32_t dropped, uint32_t now_ms,
                Sentence* sentence) {
    sentence->begin("TIME");
    sentence->number(tile.settings().tile_id);
    sentence->number(now_ms);
    sentence->number(health.compute_us);
    sentence->number(health.awake_permille);
    sentence->number(health.gap_us);
    sentence->number(health.stack_unused);
    sentence->number(dropped);
    sentence->end();
}

void write_board(const Tile& tile, const Health& health, uint32_t now_ms, Sentence* sentence) {
    sentence->begin("BOARD");
    sentence->number(tile.settings().tile_id);
    sentence->number(now_ms);
    health.supply_mv != 0 ? sentence->number(health.supply_mv) : sentence->nothing();
    for (uint16_t errors : health.framing_errors) {
        sentence->number(errors);
    }
    for (uint32_t low_ms : health.low_ms) {
        sentence->number(low_ms);
    }
    sentence->end();
}

void write_error(const Tile& tile, Error error, uint32_t detail, uint32_t now_ms, Sentence* sentence) {
    sentence->begin("ERROR");
    sentence->number(tile.settings().tile_id);
    sentence->number(now_ms);
    sentence->text(kErrorCodes[static_cast<uint8_t>(error)]);
    switch (error) {
    case Error::Settings:
        sentence->text("defaults in force");
        break;
    case Error::Watchdog:
        sentence->text(detail == 0 ? "hung" : "hung at 0x");
        if (detail != 0) {
            sentence->more_hex(detail, 5);
        }
        break;
    case Error::Stack:
        sentence->text("almost full");
        break;
    case Error::Supply:
        sentence->number(detail);
        sentence->more(" mV");
        break;
    }
    sentence->end();
}

void Telemetry::period_ended(const Tile& tile) {
    const uint32_t ended_ms = tile.period_ended_ms();
    const bool label_changed = tile.shown() != last_shown_;
    if (any_yet_ && !label_changed && ended_ms - last_ms_ < kTilePeriodMs) {
        return;
    }
    dropped_ += tile_due_ + link_due_;
    any_yet_ = true;
    last_ms_ = ended_ms;
    last_shown_ = tile.shown();
    tile_due_ = true;
    link_due_ = true;
}

void Telemetry::failed(Error error, uint32_t detail) {
    if (error == Error::Watchdog) {
        hung_at_ = detail;
    } else if (error == Error::Supply && !(errors_told_ & mask_of(error))) {
        sagged_mv_ = static_cast<uint16_t>(detail);
    }
    errors_due_ |= mask_of(error) & ~errors_told_;
    errors_told_ |= mask_of(error);
}

Telemetry::Next Telemetry::next(uint32_t now_ms) const {
    if (errors_due_ != 0) {
        return Next::Error;
    }
    if (tile_due_) {
        return Next::Tile;
    }
    if (link_due_) {
        return Next::Link;
    }
    const uint32_t since_time_ms = now_ms - last_time_ms_;
    if (since_time_ms >= kTimePeriodMs) {
        return Next::Time;
    }
    return board_due_ && since_time_ms >= kBoardAfterMs ? Next::Board : Next::Nothing;
}

bool Telemetry::write(const Tile& tile, const Health& health, uint32_t now_ms, Sentence* sentence) {
    switch (next(now_ms)) {
    case Next::Error:
        write_error(tile, first_error(), first_error() == Error::Supply ? sagged_mv_ : hung_at_, now_ms,
                    sentence);
        errors_due_ &= ~mask_of(first_error());
        break;
    case Next::Tile:
        tile_due_ = false;
        write_tile(tile, now_ms, sentence);
        break;
    case Next::Link:
        link_due_ = false;
        write_link(tile, side_at(next_side_), health.overruns[next_side_], now_ms, sentence);
        next_side_ = (next_side_ + 1) % kSides;
        break;
    case Next::Time:
        // The next one is due a second after this one was due, not after it was written.
        last_time_ms_ += (now_ms - last_time_ms_) / kTimePeriodMs * kTimePeriodMs;
        write_time(tile, health, dropped_, now_ms, sentence);
        board_due_ = true;
        return true;
    case Next::Board:
        board_due_ = false;
        write_board(tile, health, now_ms, sentence);
        break;
    case Next::Nothing:
        break;
    }
    return false;
}

Error Telemetry::first_error() const {
    uint8_t error = 0;
    while (!(errors_due_ >> error & 1)) {
        ++error;
    }
    return static_cast<Error>(error);
}

} // namespace tilenca
