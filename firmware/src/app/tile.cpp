#include "app/tile.h"

namespace tilenca {

namespace {

Link make_link(const Model& model, const Settings& settings) {
    return Link(model.id, model.network.channels(), settings.period_ms);
}

} // namespace

Tile::Tile(const Model& model, const Settings& settings, uint32_t now_ms)
    : model_(model), settings_(settings), cell_(model.network),
      links_{make_link(model, settings), make_link(model, settings), make_link(model, settings),
             make_link(model, settings)},
      due_ms_(now_ms + settings.period_ms) {
    tell();
}

void Tile::restart() {
    cell_.seed();
    updates_ = 0;
    decided_ = {kNothing, Decision::kNoMargin};
    tell();
}

void Tile::apply(const Settings& settings) {
    due_ms_ = period_ended_ms() + settings.period_ms;
    settings_ = settings;
    for (Link& link : links_) {
        link.set_period(settings.period_ms);
    }
}

void Tile::receive(Side side, uint8_t byte, uint32_t now_ms) {
    links_[index_of(side)].receive(byte, now_ms);
}

bool Tile::tick(uint32_t now_ms) {
    if (cell_.updating()) {
        if (!cell_.update_slice()) {
            return false;
        }
        ++updates_;
        decided_ = cell_.decide(model_.classes);
        tell();
        return true;
    }
    for (Link& link : links_) {
        link.tick(now_ms);
    }
    if (!period_ends(now_ms)) {
        return false;
    }
    if (stopped()) {
        tell();
        return true;
    }
    begin_update();
    return false;
}

bool Tile::period_ends(uint32_t now_ms) {
    const int32_t late_ms = static_cast<int32_t>(now_ms - due_ms_);
    if (late_ms < 0) {
        return false;
    }
    // The phase stays the same, however late the call: whole periods that were missed are skipped.
    const uint32_t missed = static_cast<uint32_t>(late_ms) / settings_.period_ms;
    due_ms_ += (missed + 1) * settings_.period_ms;
    return true;
}

void Tile::begin_update() {
    const int8_t* messages[kSides];
    for (uint8_t i = 0; i < kSides; ++i) {
        messages[i] = links_[i].message();
    }
    cell_.perceive(messages);
}

uint8_t Tile::take_frame(Side side, uint8_t* wire) {
    untold_ &= ~mask_of(side);
    return links_[index_of(side)].send(side, settings_.tile_id, cell_.message(), wire);
}

} // namespace tilenca
