// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace shadow_layers {

/// Instruction sets that kernels are compiled for (native/CMakeLists.txt, `kernel_sources`): every file named
/// *_kernel.cpp is compiled once per set (base/kernel_arch.h) and hands out its functions in a table, as plain data.
enum class InstructionSet {
    Base,  ///< what every processor of the target runs
    Avx2,  ///< x86-64 with AVX2 and FMA
};

/// The best that this processor runs; Base if SHADOW_LAYERS_INSTRUCTION_SET=base is in the environment. Decided once.
InstructionSet choose_instruction_set();
/// Can this processor, and this build, run it?
bool is_supported(InstructionSet set);
const char* get_name(InstructionSet set);  ///< "base", "avx2"

/// The table of the set in use. Where nothing is compiled for AVX2 its table is never asked for.
template <class Build>
const Build& choose_build(const Build& base, const Build& avx2) {
    return choose_instruction_set() == InstructionSet::Avx2 ? avx2 : base;
}

}  // namespace shadow_layers
