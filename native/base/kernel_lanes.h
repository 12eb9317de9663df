// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// For *_kernel.cpp only: eight floats side by side, in one register or in two, so that a kernel is written once
// whatever the width of the set's registers.

#include <cstdint>

#include "base/kernel_arch.h"

namespace shadow_layers {
namespace {

class Floats8 {
public:
    using Batch = xsimd::batch<float, Arch>;
    static constexpr int kBatches = 8 / int(Batch::size);
    static_assert(kBatches * int(Batch::size) == 8);

    Floats8() = default;
    explicit Floats8(float value) {
        for (Batch& b : parts_) b = Batch(value);
    }
    /// 32-byte aligned.
    static Floats8 load(const float* values) {
        Floats8 result;
        for (int i = 0; i < kBatches; ++i) result.parts_[i] = Batch::load_aligned(values + i * int(Batch::size));
        return result;
    }
    void store(float* values) const {
        for (int i = 0; i < kBatches; ++i) parts_[i].store_aligned(values + i * int(Batch::size));
    }

    template <class Operation>
    static Floats8 map(const Floats8& a, const Floats8& b, const Operation& operation) {
        Floats8 result;
        for (int i = 0; i < kBatches; ++i) result.parts_[i] = operation(a.parts_[i], b.parts_[i]);
        return result;
    }
    friend Floats8 operator+(const Floats8& a, const Floats8& b) {
        return map(a, b, [](const Batch& x, const Batch& y) { return x + y; });
    }
    friend Floats8 operator-(const Floats8& a, const Floats8& b) {
        return map(a, b, [](const Batch& x, const Batch& y) { return x - y; });
    }
    friend Floats8 operator*(const Floats8& a, const Floats8& b) {
        return map(a, b, [](const Batch& x, const Batch& y) { return x * y; });
    }
    friend Floats8 operator/(const Floats8& a, const Floats8& b) {
        return map(a, b, [](const Batch& x, const Batch& y) { return x / y; });
    }
    friend Floats8 min(const Floats8& a, const Floats8& b) {
        return map(a, b, [](const Batch& x, const Batch& y) { return xsimd::min(x, y); });
    }
    friend Floats8 max(const Floats8& a, const Floats8& b) {
        return map(a, b, [](const Batch& x, const Batch& y) { return xsimd::max(x, y); });
    }
    /// By the bits: of 0 and -0 as well.
    friend Floats8 with_sign_of(const Floats8& a, const Floats8& b) {
        return map(a, b, [](const Batch& x, const Batch& y) { return x ^ (y & Batch(-0.0f)); });
    }
    friend Floats8 abs(const Floats8& a) {
        return map(a, a, [](const Batch& x, const Batch&) { return xsimd::abs(x); });
    }
    friend Floats8 sqrt(const Floats8& a) {
        return map(a, a, [](const Batch& x, const Batch&) { return xsimd::sqrt(x); });
    }
    /// a * b + c, rounded once where the set can.
    friend Floats8 fma(const Floats8& a, const Floats8& b, const Floats8& c) {
        Floats8 result;
        for (int i = 0; i < kBatches; ++i) result.parts_[i] = xsimd::fma(a.parts_[i], b.parts_[i], c.parts_[i]);
        return result;
    }

    /// Bit i: a[i] > b[i]. Never for what is not a number.
    friend std::uint32_t find_greater(const Floats8& a, const Floats8& b) {
        std::uint32_t bits = 0;
        for (int i = 0; i < kBatches; ++i) bits |= gather_bits(a.parts_[i] > b.parts_[i]) << (i * int(Batch::size));
        return bits;
    }

private:
    static std::uint32_t gather_bits(const Batch::batch_bool_type& flags) {
#if defined(__AVX2__)
        return std::uint32_t(_mm256_movemask_ps(flags.data));
#elif defined(__x86_64__)
        return std::uint32_t(_mm_movemask_ps(flags.data));
#else
        bool stored[Batch::size];
        flags.store_unaligned(stored);
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < Batch::size; ++i) bits |= std::uint32_t(stored[i]) << i;
        return bits;
#endif
    }

    Batch parts_[kBatches];
};

}  // namespace
}  // namespace shadow_layers
