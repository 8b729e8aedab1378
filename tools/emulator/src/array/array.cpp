#include "array/array.h"

#include <algorithm>
#include <cstdio>

namespace tilenca {

namespace {

constexpr double kMostTurns = 64;

} // namespace

Array::Array(const Image& image, const avr::Fuses& fuses, const std::vector<Clock>& clocks)
    : image_(image), fuses_(fuses), program_(std::make_shared<avr::Program>()) {
    for (const Block& block : image.flash) {
        program_->write(block.address, block.bytes.data(), static_cast<uint32_t>(block.bytes.size()));
    }
    data_end_.fixed = static_cast<uint16_t>(std::max<uint32_t>(image.data_end(), avr::kSramStart));
    if (const Symbol* heap = image.find("__brkval"); heap != nullptr) {
        data_end_.heap_pointer = static_cast<uint16_t>(heap->address & 0xFFFF);
    }
    for (const Clock& clock : clocks) {
        add_tile(clock);
    }
}

unsigned Array::add_tile(const Clock& clock) {
    tiles_.push_back(std::make_unique<Tile>(program_, fuses_, clock, data_end_));
    tiles_.back()->set_hardware(hardware_of(size() - 1));
    tiles_.back()->use_list(list_);
    for (const Block& block : image_.eeprom) {
        std::copy(block.bytes.begin(), block.bytes.end(),
                  tiles_.back()->chip().eeprom().memory().begin() + block.address);
    }
    rebuild_order();
    return size() - 1;
}

// --- cables ---

void Array::connect(End from, End to) {
    wires_.push_back(std::make_unique<Wire>(tile(from.tile), tile(to.tile), from, to, common_, now_));
}

void Array::rebuild_order() {
    into_.assign(tiles_.size(), {});
    out_of_.assign(tiles_.size(), {});
    neighbours_.assign(tiles_.size(), {});
    for (const auto& wire : wires_) { // a cable has one in each direction
        into_[wire->to().tile].push_back(wire.get());
        out_of_[wire->from().tile].push_back(wire.get());
        neighbours_[wire->to().tile].push_back(wire->from().tile);
    }
}

bool Array::link(End one, End other) {
    if (wire_from(one) != nullptr || wire_from(other) != nullptr) {
        return false;
    }
    connect(one, other);
    connect(other, one);
    rebuild_order();
    return true;
}

Wire* Array::wire_from(End end) {
    for (Wire* wire : out_of_[end.tile]) {
        if (wire->from().side == end.side) {
            return wire;
        }
    }
    return nullptr;
}

bool Array::set_connected(End end, bool connected) {
    Wire* there = wire_from(end);
    if (there == nullptr) {
        return false;
    }
    there->set_connected(connected, now_);
    if (Wire* back = wire_from(there->to()); back != nullptr) {
        back->set_connected(connected, now_);
    }
    return true;
}

bool Array::unlink(End end) {
    Wire* there = wire_from(end);
    if (there == nullptr) {
        return false;
    }
    Wire* back = wire_from(there->to());
    for (Wire* wire : {there, back}) { // what is on its way is lost, and the line is open
        if (wire == nullptr) {
            continue;
        }
        Tile& to = tile(wire->to().tile);
        to.chip().push_edge(Tile::receive_pin(wire->to().side), to.clock().to_cycle(now_ + common_.delay),
                            avr::Drive::Open);
    }
    wires_.erase(std::remove_if(wires_.begin(), wires_.end(),
                                [&](const auto& wire) { return wire.get() == there || wire.get() == back; }),
                 wires_.end());
    rebuild_order();
    return true;
}

void Array::set_power(unsigned index, bool on) {
    tile(index).set_power(on);
    for (Wire* wire : out_of_[index]) {
        wire->power_changed(now_);
    }
}

void Array::remove_tile(unsigned index) {
    set_power(index, false);
    for (unsigned side = 0; side < kSides; side++) {
        unlink({index, side});
    }
}

// --- time ---

bool Array::set_hardware(const avr::Hardware& hardware, avr::Drive unpowered) {
    if (now_ > 0 || !wires_.empty()) {
        return false;
    }
    hardware_ = hardware;
    common_.unpowered = unpowered;
    for (unsigned index = 0; index < size(); index++) {
        tile(index).set_hardware(hardware_of(index));
    }
    return true;
}

// Each tile is another specimen.
avr::Hardware Array::hardware_of(unsigned index) const {
    avr::Hardware own = hardware_;
    avr::Random random(hardware_.seed);
    own.seed = random.next() + index;
    own.seed = avr::Random(own.seed).next();
    return own;
}

bool Array::set_cable_delay(double ticks) {
    if (now_ > 0) {
        return false;
    }
    common_.delay = ticks;
    turn_ = turn_of(ticks);
    return true;
}

// The time until which every tile sleeps; the present if one does not.
double Array::idle_until() {
    double soonest = HUGE_VAL;
    for (const Rest& rest : sleeps_until_) {
        soonest = std::min(soonest, std::max(now_, rest.until));
        if (soonest <= now_) {
            return soonest;
        }
    }
    for (const auto& wire : wires_) { // what is on its way wakes somebody up, perhaps
        soonest = std::min(soonest, std::max(now_, wire->pending()));
    }
    return soonest;
}

void Array::run_tile_until(unsigned index, double end, double its_turn_end) {
    bool has_mail = false;
    for (Wire* wire : into_[index]) {
        has_mail = wire->deliver() || has_mail;
    }
    if (has_mail || sleeps_until_[index].until < end) {
        Tile& tile = *tiles_[index];
        tile.run_until(end, its_turn_end);
        sleeps_until_[index].until = tile.wakes_at();
        if (tile.clock().drifts()) { // it tells the time of waking until its next step only
            const double step = (std::floor(end / kDriftTicks) + 1) * kDriftTicks;
            sleeps_until_[index].until = std::min(sleeps_until_[index].until, step);
        }
    }
    if (has_faults_) {
        pass_faults_on(index, end, its_turn_end);
    }
}

void Array::pass_faults_on(unsigned index, double end, double its_turn_end) {
    for (Wire* wire : out_of_[index]) {
        if (wire->has_fault()) {
            wire->settle(end);
        }
    }
    for (Wire* wire : into_[index]) {
        if (wire->has_fault()) {
            wire->note_receiver(end == its_turn_end);
        }
    }
}

void Array::run_tile(unsigned index, unsigned turn) {
    const double its_turn_end = first_end_ + turn * turn_;
    tiles_[index]->use_list(list_ ^ ((turn + 1) & 1));
    run_tile_until(index, std::min(now_, its_turn_end), its_turn_end);
}

// Every tile is brought to the present; from here on anything may be done to it.
void Array::catch_up() {
    for (auto& tile : tiles_) {
        tile->run_until(now_, turn_end(now_ - 1));
    }
    sleeps_until_.assign(tiles_.size(), {});
}

void Array::run_turns(unsigned turns) {
    if (wave_ != nullptr) {
        wave_->run(neighbours_, turns);
    } else {
        for (unsigned i = 0; i < size(); i++) {
            for (unsigned turn = 0; turn < turns; turn++) {
                run_tile(i, turn);
            }
        }
    }
    list_ ^= turns & 1;
}

// One, where a turn may be the last, or where all tiles will sleep again after it. On one thread, tiles that
// have neighbours need what these sent in the turn before.
double Array::turns_at_once(double begin) const {
    const bool at_once = wires_.empty() || (wave_ != nullptr && begin <= now_);
    return at_once && !may_halt() ? kMostTurns : 1;
}

bool Array::has_halted() const {
    return std::any_of(tiles_.begin(), tiles_.end(),
                       [](const auto& tile) { return tile->chip().cpu().halted; });
}

bool Array::may_halt() const {
    return std::any_of(tiles_.begin(), tiles_.end(),
                       [](const auto& tile) { return tile->chip().may_halt(); });
}

void Array::run_for(double ticks) {
    asked_for_ += ticks;
    const double end = std::ceil(asked_for_ / kQuantumTicks) * kQuantumTicks;
    catch_up(); // one that was halted has to
    has_faults_ =
        std::any_of(wires_.begin(), wires_.end(), [](const auto& wire) { return wire->has_fault(); });
    while (now_ < end && !has_halted()) {
        const double begin = std::floor(idle_until() / kQuantumTicks) * kQuantumTicks;
        const double most = turns_at_once(begin);
        first_end_ = turn_end(std::min(end - kQuantumTicks, begin));
        now_ = std::min(end, first_end_ + (most - 1) * turn_);
        run_turns(1 + static_cast<unsigned>(std::ceil(std::max(0.0, now_ - first_end_) / turn_)));
    }
    catch_up();
    asked_for_ = now_ < end ? now_ : asked_for_;
    if (wave_ != nullptr) {
        wave_->rest();
    }
}

void Array::set_threads(unsigned threads) {
    const auto run_turn = [this](unsigned tile, unsigned turn) { run_tile(tile, turn); };
    wave_ = threads > 1 ? std::make_unique<Wave>(threads, run_turn) : nullptr;
}

std::string Array::fault(unsigned index) {
    const avr::Cpu& cpu = tile(index).chip().cpu();
    if (cpu.fault.empty()) {
        return "";
    }
    const uint32_t address = 2 * cpu.pc();
    const bool own = !tile(index).chip().has_changed_flash();
    const std::string function = own ? image_.function_at(address) : "";
    char text[64];
    std::snprintf(text, sizeof text, "tile %u stopped at 0x%05X", index + 1, address);
    return text + (function.empty() ? "" : " in " + function) + ": " + cpu.fault;
}

} // namespace tilenca
