// The network of a cell in integers: docs/PROTOCOL.md section 4, bit for bit.
//
// It works in slices, so that a tile can look after its links between them. The weights may have any size up
// to the limits below, so that the host's simulator runs this very code. core/layers.cpp or avr/layers.cpp
// has the layers.
#pragma once

#include <stdint.h>

#include "core/layer.h"
#include "core/side.h"

namespace tilenca {

constexpr uint8_t kNeighbourhood = 5; // von Neumann: the cell itself, then N, E, S, W
constexpr uint8_t kMaxChannels = 51;
constexpr uint8_t kMaxHidden = 127;
constexpr uint8_t kMaxInputs = kNeighbourhood * kMaxChannels; // 255: counters fit a uint8_t

constexpr int16_t kMessageMax = 127;
constexpr uint8_t kMessageShift = 7; // stored state 2^-13, message 2^-6
constexpr int16_t kStateMax = kMessageMax << kMessageShift;
constexpr int16_t kSeedState = 1 << 13; // 1.0, the start of channel 0
constexpr uint8_t kHiddenShift = 6;     // accumulator 2^-12, activation 2^-6
constexpr int8_t kHiddenMax = 127;
constexpr uint8_t kHiddenRounding = 1 << (kHiddenShift - 1);

// 5 C -> H1 -> H2 -> C. A view: the weights belong to the exported model (or, on the host, to the caller).
struct Network {
    Layer hidden1;
    Layer hidden2;
    Layer output;

    uint8_t channels() const { return output.outputs; }
};

// What a stored state value tells the neighbours: an int8 in -127..127, with an exact zero.
inline int8_t message_of(int16_t state) {
    return static_cast<int8_t>((state + (1 << (kMessageShift - 1))) >> kMessageShift);
}

// The class with the greatest of the stored scores, the lowest among equals.
uint8_t best_class(const int16_t* scores, uint8_t classes);

struct Decision {
    uint8_t best;   // as best_class() says
    uint8_t margin; // how far it is ahead of the second best, in units of a message, rounded: 0..254

    static constexpr uint8_t kNoMargin = 255; // there is only one class
};
Decision decide(const int16_t* scores, uint8_t classes);

constexpr int8_t kMissing = 32; // one half of a score, as a message

// The side on which another tile is missing: that with the greatest of four scores, N E S W, the first among
// equals, if it is above kMissing; else kSides. Twin of host/tilenca/model/directions.py.
uint8_t missing_side(const int8_t* scores);

// The sum of 5 C messages.
int16_t sum_of_messages(const int8_t* messages, uint8_t channels);

// What a layer reads.
struct Inputs {
    const int8_t* values; // as many messages or activations as it has inputs, and kEnd
    int16_t sum;          // of them
};

// Computes outputs [from, to) of a hidden layer, each 0..127, fills the last block up with zeros, and returns
// their sum. `from` is the first output of a block.
int16_t hidden_outputs(const Layer& layer, const Inputs& inputs, uint8_t from, uint8_t to, int8_t* outputs);

// Adds outputs [from, to) of the last layer to the state, saturating at +-kStateMax. `from` is the first
// output of a block.
void add_outputs(const Layer& layer, const Inputs& inputs, uint8_t from, uint8_t to, int16_t* state);

// One update of one cell, a slice at a time.
class Forward {
  public:
    explicit Forward(const Network& network) : network_(network) {}

    // Starts an update: `inputs` (5 C messages, and room for one more) and `state` (C values, changed in
    // place) stay the caller's and must live until done().
    void begin(int8_t* inputs, int16_t* state);

    // Computes some blocks, which takes the chip 1.5 ms at most. No effect when done().
    void step();

    // Abandons the update. The state may be half old, half new.
    void stop() { stage_ = Stage::Done; }

    bool done() const { return stage_ == Stage::Done; }

  private:
    enum class Stage : uint8_t { Hidden1, Hidden2, Output, Done };
    // Whole blocks, and kEnd.
    static constexpr uint8_t kHiddenRoom = (kMaxHidden / kBlockOutputs + 1) * kBlockOutputs;
    static constexpr int16_t kRowsPerSlice = 320; // of kBlockOutputs weights each: 72 cycles at most

    void begin_layer(const Layer& layer, const Inputs& inputs, Stage stage);
    void next_layer();
    int8_t* hidden() { return stage_ == Stage::Hidden1 ? hidden1_ : hidden2_; }

    const Network& network_;
    const Layer* layer_ = nullptr;
    Inputs inputs_ = {};
    int16_t* state_ = nullptr;
    int16_t sum_ = 0; // of the current layer's outputs so far
    Stage stage_ = Stage::Done;
    uint8_t from_ = 0;  // first output of the current layer that is not computed yet
    uint8_t slice_ = 0; // how many are computed at a time
    int8_t hidden1_[kHiddenRoom] = {};
    int8_t hidden2_[kHiddenRoom] = {};
};

} // namespace tilenca
