// The simulator: many grids of cells at once, by the firmware's own arithmetic, bit for bit. Plain C99.
//
// Conventions. A cell is a tile; a run is one grid of cells with its own chance, and knows nothing of other
// runs. Sides are N E S W, 0 to 3. Cells of a run follow each other; `cells` counts those of all runs. Arrays
// are row-major without gaps, and stay the caller's. A function that fails returns null or a negative number,
// and tilenca_simulator_last_error says why in one line. Every number and index given is checked; the
// contents of states and messages need not be.
#ifndef TILENCA_SIMULATOR_H
#define TILENCA_SIMULATOR_H

#include <stddef.h>
#include <stdint.h>

#include "tilenca/api.h"

#ifdef __cplusplus
extern "C" {
#endif

// Grows with every change after which callers must be compiled or written anew.
enum { TILENCA_SIMULATOR_ABI_VERSION = 3 };

// The integer weights of a network 5 C -> H1 -> H2 -> C (docs/PROTOCOL.md section 4), [output][input].
typedef struct tilenca_model {
    uint8_t channels; // C, 1 to 51
    uint8_t hidden1;  // H1, 1 to 127
    uint8_t hidden2;  // H2, 1 to 127
    uint8_t classes;  // 1 to C: the last channels are their scores
    const int8_t* w1;
    const int16_t* b1;
    const int8_t* w2;
    const int16_t* b2;
    const int8_t* w3;
    const int16_t* b3;
} tilenca_model;

// Of a tile of a run: none; dead (silent and dark); stuck (does not update, goes on sending); away (as dead,
// and comes back).
enum { TILENCA_FAULT_NONE, TILENCA_FAULT_DEAD, TILENCA_FAULT_STUCK, TILENCA_FAULT_AWAY };

// Which cells update when, and when their messages arrive. Halves: twice a step a random half of the cells
// updates, and its messages arrive at once. Clocks: every tile has its own phase, period and latencies, as
// docs/PROTOCOL.md says. Listing: as in the paper's listing, in each step of a run of n cells one cell after
// another is drawn, n times, with replacement; it updates, and its neighbours have its message at once.
enum { TILENCA_SCHEDULE_HALVES, TILENCA_SCHEDULE_CLOCKS, TILENCA_SCHEDULE_LISTING };

// Steps on clocks are counted in ticks, and times in parts of a tick, so that clocks drift in whole numbers.
enum { TILENCA_TICKS = 20, TILENCA_UNITS_PER_TICK = 65536 };

// A tile is put down or taken away at the beginning of a step. One that is put down is in the seed state,
// sends it, and counts from then on; one that is taken away counts no more. If it is there already, or not
// there, nothing happens.
typedef struct tilenca_change {
    int32_t step; // from 0
    int32_t cell;
    int32_t on; // 1: put down; 0: taken away
} tilenca_change;

// The runs, and their conditions.
typedef struct tilenca_setup {
    int32_t runs;
    int32_t cells;
    const int32_t* starts;     // [runs + 1], the first cell of each run, and `cells`
    const int32_t* neighbours; // [cells][4], N E S W, of the same run; `cells` for none
    const uint8_t* alive;      // [cells], 0: not there, unless a change puts it down
    const int8_t* target;      // [cells], the class that is right
    const uint64_t* seeds;     // [runs]
    uint64_t loss;             // of 2^32 messages so many are lost
    uint8_t zeros;             // a lost message reads as zeros; else the last one is held
    uint8_t schedule;          // TILENCA_SCHEDULE_...
    // On clocks, in units; other schedules read none of these.
    uint8_t running; // all tiles run already, and their neighbours have their messages
    // When the first tile is switched on: a whole number of ticks, a million steps before 0 to 0.
    int64_t start;
    // [cells], when each updates for the first time. Unless all are running, it is switched on one period
    // before that, and sends its seed state then.
    const int64_t* first;
    const int64_t* period;       // [cells], above 0
    const int64_t* latency;      // [cells][4], of messages by the side that they leave from, from 0, below
                                 // the cell's period
    const int64_t* seed_latency; // the same of the seed state, which no update precedes; null: as `latency`
    const int64_t* line;   // [4], by the same side: how long a message is on its line before it arrives.
                           // A tile that is switched on meanwhile does not hear it. Null: no time
    uint8_t fault;         // TILENCA_FAULT_...
    const int32_t* faulty; // [runs], a cell of the run, or -1 for none; not read without a fault
    int64_t begin;         // the first step of the fault; 0: it is there before all others start
    int64_t end;           // the step at which a tile that was away is back, in the seed state
    const tilenca_change* changes; // [changes_count], in the order of their steps
    int32_t changes_count;
} tilenca_setup;

typedef struct tilenca_event {
    int32_t cell;
    int32_t sides; // bit s: side s
} tilenca_event;

// What happens in a tick, in this order.
typedef struct tilenca_tick {
    const int32_t* switched_off;     // cells that fall silent and dark
    const int32_t* switched_on;      // cells that are switched on in the seed state, and have no messages yet
    const tilenca_event* deliveries; // the cell's message of now arrives at these sides
    const tilenca_event* updates;    // the cell updates, and reads zeros for these sides
    int32_t switched_off_count;
    int32_t switched_on_count;
    int32_t deliveries_count;
    int32_t updates_count;
} tilenca_tick;

typedef struct tilenca_grid_batch tilenca_grid_batch;
typedef struct tilenca_schedule tilenca_schedule;

// --- the library ---

// TILENCA_SIMULATOR_ABI_VERSION of the header that the library was compiled with.
TILENCA_API int tilenca_simulator_abi_version(void);
// The bytes of a structure above, by its name ("tilenca_setup"); 0: there is none of that name.
TILENCA_API size_t tilenca_simulator_size_of(const char* structure);
// Why the last function failed that failed in this thread; valid until the next one fails.
TILENCA_API const char* tilenca_simulator_last_error(void);

// --- updates by themselves ---

// Updates cells in place: `states` [count][C], unit 2^-13; `inputs` [count][5 C], the message of the cell,
// then those of N, E, S, W. `lanes` cells are computed side by side, with the same result: as many as this
// machine can (0); 4, 8 or 16; or one, by the very code of the chip (1). Returns 0, or 1 if this machine
// cannot compute so many side by side.
TILENCA_API int tilenca_update_cells(const tilenca_model* model, int16_t* states, const int8_t* inputs,
                                     size_t count, int lanes);

// --- whole runs ---

// A batch of runs. The model and the structure are copied; the setup's arrays, `states` [cells][C] and
// `shown` [cells], which change in place, must live as long as the batch. `shown` is the class that each
// tile shows, -1 for a dark one. Free the result with tilenca_grid_batch_free.
TILENCA_API tilenca_grid_batch* tilenca_grid_batch_new(const tilenca_model* model, const tilenca_setup* setup,
                                                       int16_t* states, int8_t* shown);
// Null is allowed.
TILENCA_API void tilenca_grid_batch_free(tilenca_grid_batch* batch);
// Goes on for some steps. `right` [steps][runs] receives the share of tiles that are right after each step,
// of those that are counted: not the dead, the stuck and those that are not there. `shown` [steps][cells]
// receives what each shows; null: not wanted. `threads`, from 1, change nothing but the time it takes.
TILENCA_API int tilenca_grid_batch_run(tilenca_grid_batch* batch, int32_t steps, int32_t threads,
                                       float* right, int8_t* shown);
// How many cell updates were computed in all; 0 for null.
TILENCA_API uint64_t tilenca_grid_batch_updates(const tilenca_grid_batch* batch);

// --- schedules, for callers that compute states themselves ---

// The same schedule as a batch with this setup has, tick by tick. The structure is copied; its arrays must
// live as long as the schedule. `target` is not read. Free the result with tilenca_schedule_free.
TILENCA_API tilenca_schedule* tilenca_schedule_new(const tilenca_setup* setup);
// Null is allowed.
TILENCA_API void tilenca_schedule_free(tilenca_schedule* schedule);
// The next tick; its arrays are valid until the next call. Returns 1 when it is the last one of a step,
// else 0.
TILENCA_API int tilenca_schedule_next(tilenca_schedule* schedule, tilenca_tick* tick);

#ifdef __cplusplus
}
#endif

#endif
