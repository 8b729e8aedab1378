// Runs the assembly and the portable C++ on the same inputs, block by block, and counts where they differ.
//
// VECTORS for each layer; with HOSTILE, a timer interrupts at random, every 40 cycles at the least, and uses
// all that the kernel uses.
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <string.h>

#include "core/arithmetic.h"
#include "model/model.h"

using namespace tilenca;

// What the test looks at.
volatile uint16_t vectors, calls, differences, done;
volatile uint32_t interrupts;
volatile uint16_t blocks_of_24_bits, zero_outputs, full_outputs, full_states;
#define LOOKED_AT __attribute__((used)) // though the program does not read it
LOOKED_AT int8_t inputs[kMaxInputs + 1];
LOOKED_AT int16_t states[kMaxChannels + kBlockOutputs];
LOOKED_AT int16_t start_states[kMaxChannels + kBlockOutputs];

namespace {

uint32_t random_bits = 1;

uint16_t draw() {
    random_bits ^= random_bits << 13;
    random_bits ^= random_bits >> 17;
    random_bits ^= random_bits << 5;
    return static_cast<uint16_t>(random_bits);
}

int8_t any_input(int8_t least) {
    const int8_t value = static_cast<int8_t>(draw() % 255 - 127);
    return value < least ? -value : value;
}

// Sign or size as `like`, so that sums become extreme.
int8_t along(int8_t like, int8_t least) {
    return like > 0 ? 127 : like < 0 ? least : 0;
}

void draw_inputs(const Layer& layer, int8_t least) {
    const uint8_t kind = draw() % 10;
    const uint8_t output = draw() % layer.outputs;
    auto row = layer.row(output);
    for (uint8_t i = 0; i < layer.inputs; ++i) {
        const int8_t weight = row.next();
        const int8_t any = any_input(least);
        const bool often = draw() & 1;
        const int8_t values[] = {any,
                                 often ? any : static_cast<int8_t>(0),
                                 0,
                                 127,
                                 least,
                                 static_cast<int8_t>(any > 64    ? 1
                                                     : any < -64 ? -1
                                                                 : 0),
                                 along(weight, least),
                                 along(-weight, least),
                                 often ? static_cast<int8_t>(127) : least,
                                 static_cast<int8_t>(i + 1 == layer.inputs ? any : 0)};
        inputs[i] = values[kind];
    }
    inputs[layer.inputs] = kEnd;
}

int16_t sum_of(const int8_t* values, uint8_t count) {
    int16_t sum = 0;
    for (uint8_t i = 0; i < count; ++i) {
        sum += values[i];
    }
    return sum;
}

void differs_if(bool so, const Layer& layer) {
    differences += so || inputs[layer.inputs] != kEnd;
    ++calls;
}

// Up to four blocks in one call.
uint8_t some_outputs(uint8_t left) {
    const uint8_t some = kBlockOutputs * (1 + draw() % 4);
    return some < left ? some : left;
}

void compare_hidden(const Layer& layer, int8_t least) {
    static int8_t outputs[5 * kBlockOutputs], expected[5 * kBlockOutputs];
    draw_inputs(layer, least);
    const Inputs given = {inputs, sum_of(inputs, layer.inputs)};
    for (uint8_t from = 0, count; from < layer.outputs; from += count) {
        // Some bytes on either side must stay.
        memset(outputs, 99, sizeof outputs);
        memset(expected, 99, sizeof expected);
        count = some_outputs(layer.outputs - from);
        const uint8_t whole = (count + kBlockOutputs - 1) / kBlockOutputs * kBlockOutputs;
        const int16_t sum = hidden_outputs(layer, given, from, from + count, outputs + 4 - from);
        hidden_outputs<OneCell>(layer, inputs, from, from + whole, expected + 4 - from);
        differs_if(memcmp(outputs, expected, sizeof outputs) != 0 || sum != sum_of(expected + 4, whole),
                   layer);
        for (uint8_t i = 0; i < count; ++i) {
            zero_outputs += expected[4 + i] == 0;
            full_outputs += expected[4 + i] == 127;
        }
        blocks_of_24_bits += !layer.is_16_bit(from);
    }
}

int16_t any_state() {
    const uint8_t kind = draw() % 4;
    return kind == 0   ? kStateMax
           : kind == 1 ? -kStateMax
                       : static_cast<int16_t>(draw() % (2 * kStateMax + 1u)) - kStateMax;
}

void compare_output(const Layer& layer) {
    static int16_t expected[kMaxChannels + kBlockOutputs];
    draw_inputs(layer, 0);
    const Inputs given = {inputs, sum_of(inputs, layer.inputs)};
    for (uint8_t c = 0; c < kMaxChannels + kBlockOutputs; ++c) {
        states[c] = start_states[c] = expected[c] = any_state();
    }
    for (uint8_t from = 0, count; from < layer.outputs; from += count) {
        count = some_outputs(layer.outputs - from);
        add_outputs(layer, given, from, from + count, states);
        add_outputs<OneCell>(layer, inputs, from, from + count, expected);
        differs_if(memcmp(states, expected, sizeof states) != 0, layer);
        blocks_of_24_bits += !layer.is_16_bit(from);
    }
    for (uint8_t c = 0; c < layer.outputs; ++c) {
        full_states += expected[c] == kStateMax || expected[c] == -kStateMax;
    }
}

} // namespace

#ifdef HOSTILE
const uint8_t in_flash[] PROGMEM = {1, 2, 4, 8, 16, 32, 64, 128};
volatile uint16_t hostile_product;

ISR(TIMER1_COMPA_vect) {
    static uint16_t lot = 1;
    lot = lot * 25173u + 13849u;
    hostile_product = lot * pgm_read_byte(in_flash + lot % sizeof in_flash);
    ++interrupts;
    OCR1A = TCNT1 + 40 + lot % 256;
}
#endif

int main() {
#ifdef HOSTILE
    TCCR1B = 1;
    OCR1A = 1000;
    TIMSK1 = 1 << OCIE1A;
    sei();
#endif
    const Network& network = model::kModel.network;
    for (; vectors < VECTORS; ++vectors) {
        compare_hidden(network.hidden1, -127);
        compare_hidden(network.hidden2, 0);
        compare_output(network.output);
    }
    cli();
    done = 1;
    for (;;) {
    }
}
