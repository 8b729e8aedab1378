// Cells living through a schedule, and the gradient of where they end up: host/tilenca/training/rollout.py says what
// this computes, in plain PyTorch. Here the whole life is one call, and nothing but real updates is computed.
//
// Compiled once for each kind of processor (LIFE_NAME differs); life_api.cpp picks one.
#include "life.h"

#include <string.h>

#include "matrices.h"
#include "product.h"

namespace training {
namespace {

constexpr int kTaps = 5;

// Of the rows of a tape, in floats.
struct Widths {
    explicit Widths(const Net& net)
        : seen(padded(kTaps * net.channels)), hidden1(padded(net.hidden1)), hidden2(padded(net.hidden2)),
          after(padded(net.channels)) {}
    size_t seen, hidden1, hidden2, after;
};

Tape from_update(const Tape& tape, const Widths& widths, size_t first) {
    return {tape.seen + first * widths.seen, tape.hidden1 + first * widths.hidden1,
            tape.hidden2 + first * widths.hidden2, tape.after + first * widths.after};
}

// The part of a life between two ends of rounds.
struct Round {
    size_t first; // update
    size_t count; // of updates
    const int32_t* who;
    const int32_t* reads;
    const uint8_t* arrives;
};

std::vector<Round> rounds_of(const Life& life) {
    std::vector<Round> rounds;
    size_t first = 0;
    for (int number = 0; number < life.rounds; ++number) {
        const size_t count = life.counts[number];
        rounds.push_back({first, count, life.who + first, life.reads + first * kTaps,
                          life.arrives + static_cast<size_t>(number) * life.cells});
        first += count;
    }
    return rounds;
}

float message(float state, bool rounded) {
    return rounded ? __builtin_floorf(state + 0.5f) : state;
}

// The messages of every cell, own and as heard, and a row of zeros for nobody's; or the gradients of them.
class Messages {
  public:
    Messages(int cells, int channels)
        : cells_(cells), channels_(channels), values_((2 * static_cast<size_t>(cells) + 1) * channels) {}

    float* row(size_t number) { return values_.data() + number * channels_; }
    float* heard(size_t cell) { return row(cells_ + cell); }
    size_t bytes() const { return sizeof(float) * channels_; }

    void say(const float* state, bool rounded) {
        for (size_t i = 0; i < static_cast<size_t>(cells_) * channels_; ++i) {
            values_[i] = message(state[i], rounded);
        }
        memcpy(heard(0), row(0), cells_ * bytes());
    }

    // The end of a round: who arrives is heard.
    void arrive(const uint8_t* arrives) {
        for (int cell = 0; cell < cells_; ++cell) {
            if (arrives[cell] != 0) {
                memcpy(heard(cell), row(cell), bytes());
            }
        }
    }

    // The same for gradients: what was heard was the cell's own message of then.
    void return_to_sender(const uint8_t* arrives) {
        for (int cell = 0; cell < cells_; ++cell) {
            if (arrives[cell] != 0) {
                add(row(cell), heard(cell));
                memset(heard(cell), 0, bytes());
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

void LIFE_NAME::forward(const Net& net, const Life& life, float* state, const Tape& tape) {
    const Widths widths(net);
    const int channels = net.channels;
    const bool rounded = net.rounded != 0;
    const float half = rounded ? 0.5f : 0.0f; // floor(x + 1/2) of an activation, the half added with the bias
    const Packed w1(net.w1, net.hidden1, kTaps * channels, true);
    const Packed w2(net.w2, net.hidden2, net.hidden1, true);
    const Packed w3(net.w3, channels, net.hidden2, true);
    const std::vector<float> b1 = padded_bias(net.b1, net.hidden1, half);
    const std::vector<float> b2 = padded_bias(net.b2, net.hidden2, half);
    const std::vector<float> b3 = padded_bias(net.b3, channels, 0.0f);
    const auto activate = [&](const std::vector<float>& bias, float* outputs, size_t width) {
        return [&bias, outputs, width, rounded, limit = net.limit](Lanes sum, size_t row, int column) {
            sum += load(bias.data() + column);
            store(outputs + row * width + column, clamp(rounded ? floor(sum) : sum, 0.0f, limit));
        };
    };

    Messages messages(life.cells, channels);
    messages.say(state, rounded);
    for (const Round& round : rounds_of(life)) {
        const Tape now = from_update(tape, widths, round.first);
        for (size_t i = 0; i < round.count; ++i) {
            for (int tap = 0; tap < kTaps; ++tap) {
                memcpy(now.seen + i * widths.seen + tap * channels,
                       messages.row(round.reads[i * kTaps + tap]), messages.bytes());
            }
            memcpy(now.after + i * widths.after, state + static_cast<size_t>(round.who[i]) * channels,
                   messages.bytes());
            memset(now.after + i * widths.after + channels, 0, sizeof(float) * (widths.after - channels));
        }
        product(now.seen, widths.seen, round.count, w1.matrix(), activate(b1, now.hidden1, widths.hidden1));
        product(now.hidden1, widths.hidden1, round.count, w2.matrix(),
                activate(b2, now.hidden2, widths.hidden2));
        product(now.hidden2, widths.hidden2, round.count, w3.matrix(),
                [&](Lanes sum, size_t row, int column) {
                    float* to = now.after + row * widths.after + column;
                    store(to, clamp(load(to) + sum + load(b3.data() + column), -net.limit, net.limit));
                });
        for (size_t i = 0; i < round.count; ++i) {
            const float* after = now.after + i * widths.after;
            float* own = messages.row(round.who[i]);
            for (int c = 0; c < channels; ++c) {
                own[c] = message(after[c], rounded);
            }
            memcpy(state + static_cast<size_t>(round.who[i]) * channels, after, messages.bytes());
        }
        messages.arrive(round.arrives);
    }
}

void LIFE_NAME::backward(const Net& net, const Life& life, float* d_state, const Tape& tape, const Tape& d) {
    const Widths widths(net);
    const int channels = net.channels;
    const Packed w1(net.w1, net.hidden1, kTaps * channels, false);
    const Packed w2(net.w2, net.hidden2, net.hidden1, false);
    const Packed w3(net.w3, channels, net.hidden2, false);

    Messages d_messages(life.cells, channels);
    std::vector<float> d_seen;
    std::vector<Round> rounds = rounds_of(life);
    for (auto round = rounds.rbegin(); round != rounds.rend(); ++round) {
        d_messages.return_to_sender(round->arrives);
        const Tape then = from_update(tape, widths, round->first);
        const Tape d_then = from_update(d, widths, round->first);
        for (size_t i = 0; i < round->count; ++i) {
            float* of_state = d_state + static_cast<size_t>(round->who[i]) * channels;
            float* own = d_messages.row(round->who[i]);
            float* of_sum = d_then.after + i * widths.after;
            for (int c = 0; c < channels; ++c) {
                const float after = then.after[i * widths.after + c];
                const bool inside = after > -net.limit && after < net.limit;
                of_sum[c] = of_state[c] = inside ? of_state[c] + own[c] : 0.0f;
                own[c] = 0.0f;
            }
            memset(of_sum + channels, 0, sizeof(float) * (widths.after - channels));
        }
        product(d_then.after, widths.after, round->count, w3.matrix(),
                [&](Lanes sum, size_t row, int column) {
                    const size_t at = row * widths.hidden2 + column;
                    store(d_then.hidden2 + at, through_clamp(sum, load(then.hidden2 + at), 0.0f, net.limit));
                });
        product(d_then.hidden2, widths.hidden2, round->count, w2.matrix(),
                [&](Lanes sum, size_t row, int column) {
                    const size_t at = row * widths.hidden1 + column;
                    store(d_then.hidden1 + at, through_clamp(sum, load(then.hidden1 + at), 0.0f, net.limit));
                });
        d_seen.resize(round->count * widths.seen);
        product(d_then.hidden1, widths.hidden1, round->count, w1.matrix(),
                [&](Lanes sum, size_t row, int column) { store(&d_seen[row * widths.seen + column], sum); });
        for (size_t i = 0; i < round->count; ++i) {
            for (int tap = 0; tap < kTaps; ++tap) {
                d_messages.add(d_messages.row(round->reads[i * kTaps + tap]),
                               &d_seen[i * widths.seen + tap * channels]);
            }
        }
    }
}

} // namespace training
