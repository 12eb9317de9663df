// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace shadow_layers {

inline constexpr int kMostMaskSamples = 128;
inline constexpr int kMaskWords = kMostMaskSamples / 32;

/// One bit per sample of a pixel; sample i is bit i % 32 of word i / 32. Bits past the last sample are 0.
struct SampleMask {
    std::array<std::uint32_t, kMaskWords> words{};

    void set(int sample) { words[std::size_t(sample) / 32] |= 1u << (sample % 32); }
    bool has(int sample) const { return (words[std::size_t(sample) / 32] >> (sample % 32)) & 1u; }
    bool is_empty() const { return (words[0] | words[1] | words[2] | words[3]) == 0; }
    int count() const {
        int bits = 0;
        for (const std::uint32_t word : words) bits += std::popcount(word);
        return bits;
    }
    SampleMask& operator&=(const SampleMask& other) {
        for (std::size_t i = 0; i < kMaskWords; ++i) words[i] &= other.words[i];
        return *this;
    }
    SampleMask& operator|=(const SampleMask& other) {
        for (std::size_t i = 0; i < kMaskWords; ++i) words[i] |= other.words[i];
        return *this;
    }
    /// The bits that `other` does not have.
    SampleMask& remove(const SampleMask& other) {
        for (std::size_t i = 0; i < kMaskWords; ++i) words[i] &= ~other.words[i];
        return *this;
    }
    friend SampleMask operator&(SampleMask a, const SampleMask& b) { return a &= b; }
    friend SampleMask operator|(SampleMask a, const SampleMask& b) { return a |= b; }
    friend bool operator==(const SampleMask&, const SampleMask&) = default;
};

enum class SamplePlacement : std::uint8_t {
    Lattice,  ///< a rank-1 lattice: rows and columns of one sample each
    Grid,     ///< rows and columns of a regular grid, as in the paper's measurements
};

/// Where the samples of a pixel lie, from its centre, in pixels: within (-1/2, 1/2). One of them, `centre`, lies at the
/// centre itself, as the validity mask asks for ([Pan09] 3.4). All places are exact in float.
struct SamplePlaces {
    int count = 0, centre = 0;
    alignas(32) std::array<float, kMostMaskSamples> x{}, y{};

    SampleMask all() const;
};

/// `count`: 8, 32, 64 or 128.
SamplePlaces make_sample_places(SamplePlacement placement, int count);

/// The paper's look-up table ([Pan09] 3.4, after [Eisemann07]): the samples on one side of a line, by the line's angle
/// and its distance from the pixel's centre, both rounded to steps.
class HalfPlaneTable {
public:
    explicit HalfPlaneTable(const SamplePlaces& places);

    /// Samples with at + x * by_x + y * by_y >= 0.
    const SampleMask& find(double at, double by_x, double by_y) const;

    static constexpr int kAngles = 256, kOffsets = 128;

private:
    std::vector<SampleMask> masks_;  ///< kAngles rows
};

}  // namespace shadow_layers
