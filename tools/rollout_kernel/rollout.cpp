// Cells that go through a schedule, and the gradients on the way back. A whole rollout is one call, and only
// real updates are computed.
//
// Compiled once for each kind of processor, ROLLOUT_KIND.
#include "kernel.h"

#include <string.h>

#include "matrices.h"
#include "product.h"

namespace rollout {
namespace {

constexpr int kNeighbourhood = 5;

// Of the rows of a tape, in floats.
struct Widths {
    explicit Widths(const Network& network)
        : inputs(padded(kNeighbourhood * network.channels)), hidden1(padded(network.hidden1)),
          hidden2(padded(network.hidden2)), after(padded(network.channels)) {}
    size_t inputs, hidden1, hidden2, after;
};

Tape from_update(const Tape& tape, const Widths& widths, size_t first) {
    return {tape.inputs + first * widths.inputs, tape.hidden1 + first * widths.hidden1,
            tape.hidden2 + first * widths.hidden2, tape.after + first * widths.after};
}

// A tick of the schedule.
struct Tick {
    size_t first; // update
    size_t count; // of updates
    const int32_t* updating;
    const int32_t* perceived;
    const uint8_t* delivered;
};

std::vector<Tick> ticks_of(const Schedule& schedule) {
    std::vector<Tick> ticks;
    size_t first = 0;
    for (int number = 0; number < schedule.ticks; ++number) {
        const size_t count = schedule.counts[number];
        ticks.push_back({first, count, schedule.updating + first, schedule.perceived + first * kNeighbourhood,
                         schedule.delivered + static_cast<size_t>(number) * schedule.cells});
        first += count;
    }
    return ticks;
}

float message(float state, bool rounded) {
    return rounded ? __builtin_floorf(state + 0.5f) : state;
}

// The table of messages (rollout.h), or of their gradients.
class Messages {
  public:
    Messages(int cells, int channels)
        : cells_(cells), channels_(channels), values_((2 * static_cast<size_t>(cells) + 1) * channels) {}

    float* row(size_t number) { return values_.data() + number * channels_; }
    float* received(size_t cell) { return row(cells_ + cell); }
    size_t bytes() const { return sizeof(float) * channels_; }

    void send_all(const float* state, bool rounded) {
        for (size_t i = 0; i < static_cast<size_t>(cells_) * channels_; ++i) {
            values_[i] = message(state[i], rounded);
        }
        memcpy(received(0), row(0), cells_ * bytes());
    }

    // The end of a tick.
    void deliver(const uint8_t* delivered) {
        for (int cell = 0; cell < cells_; ++cell) {
            if (delivered[cell] != 0) {
                memcpy(received(cell), row(cell), bytes());
            }
        }
    }

    // The same backward: the gradient of a received message is that of the cell's own message of then.
    void return_to_senders(const uint8_t* delivered) {
        for (int cell = 0; cell < cells_; ++cell) {
            if (delivered[cell] != 0) {
                add(row(cell), received(cell));
                memset(received(cell), 0, bytes());
            }
        }
    }

    void add(float* to, const float* from) const {
        for (int c = 0; c < channels_; ++c) {
            to[c] += from[c];
        }
    }

  private:
    int cells_;
    int channels_;
    std::vector<float> values_;
};

} // namespace

void ROLLOUT_KIND::forward(const Network& network, const Schedule& schedule, float* state, const Tape& tape) {
    const Widths widths(network);
    const int channels = network.channels;
    const bool rounded = network.rounded != 0;
    const float half = rounded ? 0.5f : 0.0f; // floor(x + 1/2) of an activation, the half added with the bias
    const Packed w1(network.w1, network.hidden1, kNeighbourhood * channels, true);
    const Packed w2(network.w2, network.hidden2, network.hidden1, true);
    const Packed w3(network.w3, channels, network.hidden2, true);
    const std::vector<float> b1 = padded_bias(network.b1, network.hidden1, half);
    const std::vector<float> b2 = padded_bias(network.b2, network.hidden2, half);
    const std::vector<float> b3 = padded_bias(network.b3, channels, 0.0f);
    const auto activate = [&](const std::vector<float>& bias, float* outputs, size_t width) {
        return [&bias, outputs, width, rounded, limit = network.limit](Lanes sum, size_t row, int column) {
            sum += load(bias.data() + column);
            store(outputs + row * width + column, clamp(rounded ? floor(sum) : sum, 0.0f, limit));
        };
    };

    Messages messages(schedule.cells, channels);
    messages.send_all(state, rounded);
    for (const Tick& tick : ticks_of(schedule)) {
        const Tape now = from_update(tape, widths, tick.first);
        for (size_t i = 0; i < tick.count; ++i) {
            for (int neighbour = 0; neighbour < kNeighbourhood; ++neighbour) {
                memcpy(now.inputs + i * widths.inputs + neighbour * channels,
                       messages.row(tick.perceived[i * kNeighbourhood + neighbour]), messages.bytes());
            }
            memcpy(now.after + i * widths.after, state + static_cast<size_t>(tick.updating[i]) * channels,
                   messages.bytes());
            memset(now.after + i * widths.after + channels, 0, sizeof(float) * (widths.after - channels));
        }
        product(now.inputs, widths.inputs, tick.count, w1.matrix(),
                activate(b1, now.hidden1, widths.hidden1));
        product(now.hidden1, widths.hidden1, tick.count, w2.matrix(),
                activate(b2, now.hidden2, widths.hidden2));
        product(now.hidden2, widths.hidden2, tick.count, w3.matrix(), [&](Lanes sum, size_t row, int column) {
            float* to = now.after + row * widths.after + column;
            store(to, clamp(load(to) + sum + load(b3.data() + column), -network.limit, network.limit));
        });
        for (size_t i = 0; i < tick.count; ++i) {
            const float* after = now.after + i * widths.after;
            float* own = messages.row(tick.updating[i]);
            for (int c = 0; c < channels; ++c) {
                own[c] = message(after[c], rounded);
            }
            memcpy(state + static_cast<size_t>(tick.updating[i]) * channels, after, messages.bytes());
        }
        messages.deliver(tick.delivered);
    }
}

void ROLLOUT_KIND::backward(const Network& network, const Schedule& schedule, float* d_state,
                            const Tape& tape, const Tape& gradients) {
    const Widths widths(network);
    const int channels = network.channels;
    const Packed w1(network.w1, network.hidden1, kNeighbourhood * channels, false);
    const Packed w2(network.w2, network.hidden2, network.hidden1, false);
    const Packed w3(network.w3, channels, network.hidden2, false);

    Messages d_messages(schedule.cells, channels);
    std::vector<float> d_inputs;
    std::vector<Tick> ticks = ticks_of(schedule);
    for (auto tick = ticks.rbegin(); tick != ticks.rend(); ++tick) {
        d_messages.return_to_senders(tick->delivered);
        const Tape then = from_update(tape, widths, tick->first);
        const Tape d_then = from_update(gradients, widths, tick->first);
        for (size_t i = 0; i < tick->count; ++i) {
            float* of_state = d_state + static_cast<size_t>(tick->updating[i]) * channels;
            float* own = d_messages.row(tick->updating[i]);
            float* of_sum = d_then.after + i * widths.after;
            for (int c = 0; c < channels; ++c) {
                const float after = then.after[i * widths.after + c];
                const bool inside = after > -network.limit && after < network.limit;
                of_sum[c] = of_state[c] = inside ? of_state[c] + own[c] : 0.0f;
                own[c] = 0.0f;
            }
            memset(of_sum + channels, 0, sizeof(float) * (widths.after - channels));
        }
        product(d_then.after, widths.after, tick->count, w3.matrix(), [&](Lanes sum, size_t row, int column) {
            const size_t at = row * widths.hidden2 + column;
            store(d_then.hidden2 + at, through_clamp(sum, load(then.hidden2 + at), 0.0f, network.limit));
        });
        product(
            d_then.hidden2, widths.hidden2, tick->count, w2.matrix(), [&](Lanes sum, size_t row, int column) {
                const size_t at = row * widths.hidden1 + column;
                store(d_then.hidden1 + at, through_clamp(sum, load(then.hidden1 + at), 0.0f, network.limit));
            });
        d_inputs.resize(tick->count * widths.inputs);
        product(
            d_then.hidden1, widths.hidden1, tick->count, w1.matrix(),
            [&](Lanes sum, size_t row, int column) { store(&d_inputs[row * widths.inputs + column], sum); });
        for (size_t i = 0; i < tick->count; ++i) {
            for (int neighbour = 0; neighbour < kNeighbourhood; ++neighbour) {
                d_messages.add(d_messages.row(tick->perceived[i * kNeighbourhood + neighbour]),
                               &d_inputs[i * widths.inputs + neighbour * channels]);
            }
        }
    }
}

} // namespace rollout
