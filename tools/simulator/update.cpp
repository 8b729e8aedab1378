#include "update.h"

#include <string.h>

#include "copy.h"
#include "core/arithmetic.h"
#include "core/side.h"

namespace tilenca {

namespace {

typedef int8_t Bytes __attribute__((vector_size(16)));
typedef int16_t Words __attribute__((vector_size(16)));

// Elements of two vectors, by their numbers; the first GCC that knows clang's name for it is 12.
#ifdef __clang__
#define TILENCA_SHUFFLE(Vector, a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define TILENCA_SHUFFLE(Vector, a, b, ...) __builtin_shuffle(a, b, Vector{__VA_ARGS__})
#endif

Bytes low_halves(Bytes a, Bytes b) {
    return TILENCA_SHUFFLE(Bytes, a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
}
Bytes high_halves(Bytes a, Bytes b) {
    return TILENCA_SHUFFLE(Bytes, a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
}
Words low_halves(Words a, Words b) {
    return TILENCA_SHUFFLE(Words, a, b, 0, 8, 1, 9, 2, 10, 3, 11);
}
Words high_halves(Words a, Words b) {
    return TILENCA_SHUFFLE(Words, a, b, 4, 12, 5, 13, 6, 14, 7, 15);
}

// Takes W vectors of n values for one sequence and shuffles it like cards, `times` over. log2(W) times it
// turns rows of cells into columns; log2(n) times on the result turns them back.
template <int W, class Vector>
void shuffle(Vector (&v)[W], int times) {
#pragma GCC unroll 4
    for (int time = 0; time < times; ++time) {
        Vector shuffled[W];
#pragma GCC unroll 8
        for (int k = 0; k < W / 2; ++k) {
            shuffled[2 * k] = low_halves(v[k], v[k + W / 2]);
            shuffled[2 * k + 1] = high_halves(v[k], v[k + W / 2]);
        }
        memcpy(v, shuffled, sizeof v);
    }
}

template <int W>
constexpr int log2_of() {
    return W == 4 ? 2 : W == 8 ? 3 : 4;
}

// W cells at a time: gathered into columns, updated, scattered.
template <int W>
class Block {
    using L = Lanes<W>;
    using Floats = typename L::Floats;
    using Integers = typename L::Integers;
    typedef int8_t ByteColumn __attribute__((vector_size(W)));
    typedef int16_t WordColumn __attribute__((vector_size(2 * W)));
    static constexpr int kBytes = sizeof(Bytes);
    static constexpr int kWords = sizeof(Words) / sizeof(int16_t);

  public:
    explicit Block(const PackedNetwork& network) : network_(network) {}

    // 1 <= count <= W; unused lanes compute what is left over from before.
    void update(const CellUpdate* updates, int count) {
        const int channels = network_.channels;
        for (int lane = 0; lane < count; ++lane) {
            copy(messages_[lane], updates[lane].inputs, kNeighbourhood * channels);
            for (int side = 0; updates[lane].absent >> side; ++side) {
                if (updates[lane].absent >> side & 1) {
                    memset(messages_[lane] + (1 + side) * channels, 0, channels);
                }
            }
            copy(states_[lane], updates[lane].state, channels * 2);
        }
        read_columns();
        hidden_outputs<L>(network_.hidden1, inputs_, 0, network_.hidden1.outputs, hidden1_);
        hidden_outputs<L>(network_.hidden2, rows_of(hidden1_), 0, network_.hidden2.outputs, hidden2_);
        add_outputs<L>(network_.output, rows_of(hidden2_), 0, network_.output.outputs, state_);
        write_columns();
        for (int lane = 0; lane < count; ++lane) {
            copy(updates[lane].state, states_[lane], channels * 2);
        }
    }

  private:
    static const Floats* rows_of(const typename L::Outputs* outputs) { return outputs->row; }

    void read_columns() {
        for (int from = 0; from < kNeighbourhood * network_.channels; from += kBytes) {
            Bytes v[W];
#pragma GCC unroll 16
            for (int lane = 0; lane < W; ++lane) {
                memcpy(&v[lane], messages_[lane] + from, sizeof(Bytes));
            }
            shuffle<W>(v, log2_of<W>());
            ByteColumn columns[kBytes];
            memcpy(columns, v, sizeof v);
#pragma GCC unroll 16
            for (int i = 0; i < kBytes; ++i) {
                inputs_[from + i] = __builtin_convertvector(columns[i], Floats);
            }
        }
        Integers* state = state_->row;
        for (int from = 0; from < network_.channels; from += kWords) {
            Words v[W];
#pragma GCC unroll 16
            for (int lane = 0; lane < W; ++lane) {
                memcpy(&v[lane], states_[lane] + from, sizeof(Words));
            }
            shuffle<W>(v, log2_of<W>());
            WordColumn columns[kWords];
            memcpy(columns, v, sizeof v);
#pragma GCC unroll 8
            for (int i = 0; i < kWords; ++i) {
                state[from + i] = __builtin_convertvector(columns[i], Integers);
            }
        }
    }

    void write_columns() {
        const Integers* state = state_->row;
        for (int from = 0; from < network_.channels; from += kWords) {
            WordColumn columns[kWords];
#pragma GCC unroll 8
            for (int i = 0; i < kWords; ++i) {
                columns[i] = __builtin_convertvector(state[from + i], WordColumn);
            }
            Words v[W];
            memcpy(v, columns, sizeof v);
            shuffle<W>(v, log2_of<kWords>());
#pragma GCC unroll 16
            for (int lane = 0; lane < W; ++lane) {
                memcpy(states_[lane] + from, &v[lane], sizeof(Words));
            }
        }
    }

    static constexpr int kHiddenBlocks = (kMaxHidden + kRows - 1) / kRows;
    static constexpr int kStateBlocks = (kMaxChannels + kRows - 1) / kRows;

    const PackedNetwork& network_;
    int8_t messages_[W][kMaxInputs + 1 + kBytes] = {}; // not a multiple of a page, nor of a cache's way
    int16_t states_[W][kStateBlocks * kRows] = {};
    // Written before they are read, so not worth zeroing at each call.
    Floats inputs_[kMaxInputs + kBytes];
    typename L::Outputs hidden1_[kHiddenBlocks];
    typename L::Outputs hidden2_[kHiddenBlocks];
    typename L::State state_[kStateBlocks];
};

template <int W>
inline void update_all(const PackedNetwork& network, const CellUpdate* updates, size_t count) {
    Block<W> block(network);
    for (size_t from = 0; from < count; from += W) {
        block.update(updates + from, static_cast<int>(count - from < W ? count - from : W));
    }
}

using Update = void (*)(const PackedNetwork&, const CellUpdate*, size_t);

// `flatten` pulls all of the above in, to be compiled for the processor that the function is for.
#ifdef __x86_64__
__attribute__((target("avx512f,avx512bw,avx512vl,avx512dq"), flatten)) void
update_by_16(const PackedNetwork& network, const CellUpdate* updates, size_t count) {
    update_all<16>(network, updates, count);
}

__attribute__((target("avx2,fma"), flatten)) void update_by_8(const PackedNetwork& network,
                                                              const CellUpdate* updates, size_t count) {
    update_all<8>(network, updates, count);
}
#endif

__attribute__((flatten)) void update_by_4(const PackedNetwork& network, const CellUpdate* updates,
                                          size_t count) {
    update_all<4>(network, updates, count);
}

struct Width {
    int lanes;
    Update update;
    bool here; // whether this processor can
};

// The widest first.
const Width kWidths[] = {
#ifdef __x86_64__
    {16, update_by_16,
     __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512dq")},
    {8, update_by_8, __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")},
#endif
    {4, update_by_4, true},
};

} // namespace

bool update_cells(const PackedNetwork& network, const CellUpdate* updates, size_t count, int lanes) {
    for (const Width& width : kWidths) {
        if (width.here && (lanes == kWidest || lanes == width.lanes)) {
            width.update(network, updates, count);
            return true;
        }
    }
    return false;
}

} // namespace tilenca
