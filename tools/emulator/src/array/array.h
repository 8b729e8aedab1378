// Many tiles, wired, in step: each runs a turn, then the next; what one sends reaches another only after a
// delay longer than a turn. So nobody can receive what has not been sent yet, and the outcome
// does not depend on the order in which the tiles run, nor on how many threads they share (see wave.h).
#pragma once

#include "array/wave.h"
#include "array/wire.h"
#include "image/image.h"
#include "tile/tile.h"

#include <memory>
#include <string>
#include <vector>

namespace tilenca {

constexpr unsigned kMostTiles = 4096;     // of an array
constexpr double kQuantumTicks = 256;     // time stands still only at multiples of this
constexpr double kUsualDelayTicks = 4160; // of a cable: 260 us
constexpr double kLeastDelayTicks = 320, kMostDelayTicks = 4160;

class Array {
  public:
    using End = Wire::End;

    Array(const Image& image, const avr::Fuses& fuses, const std::vector<Clock>& clocks);

    // Returns the new tile's index.
    unsigned add_tile(const Clock& clock);
    // Joins two sides, both directions; false: one of them is joined already.
    bool link(End one, End other);
    // Takes the cable at that side away; false: there is none.
    bool unlink(End end);
    // Cuts or mends the cable at that side; false: there is none.
    bool set_connected(End end, bool connected);
    // The direction that leaves that side; null: no cable there.
    Wire* wire_from(End end);
    void set_power(unsigned index, bool on);
    // Off for good, and without cables; the other tiles keep their indices.
    void remove_tile(unsigned index);

    // What a cable takes, in ticks; only before time begins. False: it has begun.
    bool set_cable_delay(double ticks);
    double cable_delay() const { return common_.delay; }
    // How far the tiles differ from ideal ones, and what one without power does to its neighbours' inputs;
    // only before time begins, and before cables are laid. False: too late.
    bool set_hardware(const avr::Hardware& hardware, avr::Drive unpowered);
    // Runs on, in whole quanta; turns lie on a fixed grid, so how a caller cuts time into calls changes
    // nothing. A tile that meets a breakpoint ends it early; the next call goes on from there.
    void run_for(double ticks);
    // A whole number of quanta: less than one beyond all that was asked for.
    double now() const { return now_; }
    void set_threads(unsigned threads);

    // Counts instructions from now on; before the array runs.
    void count_instructions();
    // C++ that does what the instructions that were counted most do.
    std::string translated() const;
    // Executes the blocks of a translation in place of instructions: of a shared library, or (null) of those
    // that the emulator was linked with. False: it is of another image.
    bool use_translation(const char* path);

    Tile& tile(unsigned index) { return *tiles_[index]; }
    unsigned size() const { return static_cast<unsigned>(tiles_.size()); }
    bool has_halted() const;
    const Image& image() const { return image_; }
    // What stopped a tile: the program counter, the function, the fact; empty: it runs.
    std::string fault(unsigned index);

    // Everything that decides about the future, in bytes. Loading throws avr::ArchiveError, and may leave the
    // array in no sensible state when it does.
    std::vector<uint8_t> save();
    void load(const uint8_t* bytes, size_t count);

  private:
    // As long as can be. The delay's margin covers the last instruction of a turn.
    static double turn_of(double delay) { return std::floor((delay - 64) / kQuantumTicks) * kQuantumTicks; }
    // How many turns tiles may take from there on, before all have to be looked at.
    double turns_at_once(double begin) const;
    void run_turns(unsigned turns);
    // The end of the turn that a moment lies in.
    double turn_end(double ticks) const { return (std::floor(ticks / turn_) + 1) * turn_; }
    void run_tile(unsigned index, unsigned turn);
    void run_tile_until(unsigned index, double end, double turn_end);
    void pass_faults_on(unsigned index, double end, double turn_end);
    void catch_up();
    bool may_halt() const;
    void connect(End from, End to);
    void rebuild_order();
    avr::Hardware hardware_of(unsigned index) const;
    double idle_until();
    uint32_t image_number() const;

    Image image_; // for its symbols
    avr::Fuses fuses_;
    DataEnd data_end_;
    std::shared_ptr<avr::Program> program_;
    std::vector<std::unique_ptr<Tile>> tiles_;
    std::vector<std::unique_ptr<Wire>> wires_;
    std::vector<std::vector<Wire*>> into_, out_of_; // each tile's wires
    std::vector<std::vector<unsigned>> neighbours_; // each tile's
    // Until when each tile sleeps, unless something comes in: it need not run, and may lag behind, before.
    struct alignas(64) Rest { // so that threads do not write to one cache line in turns
        double until = 0;
    };
    std::vector<Rest> sleeps_until_;
    std::unique_ptr<Wave> wave_; // null: one thread
    Wire::Common common_{kUsualDelayTicks};
    avr::Hardware hardware_;
    double now_ = 0;
    double turn_ = turn_of(kUsualDelayTicks);
    double first_end_ = 0;    // of the first turn under way; the last one ends now
    bool has_faults_ = false; // any of the wires, while time runs
    unsigned list_ = 0;       // of their wires' two that tiles wrote last
    double asked_for_ = 0;
};

} // namespace tilenca
