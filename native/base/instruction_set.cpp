// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/instruction_set.h"

#include <cstdlib>
#include <string_view>

namespace shadow_layers {

bool is_supported(InstructionSet set) {
    if (set == InstructionSet::Base) return true;
#if defined(SHADOW_LAYERS_HAS_AVX2)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    return false;
#endif
}

InstructionSet choose_instruction_set() {
    static const InstructionSet chosen = [] {
        const char* wanted = std::getenv("SHADOW_LAYERS_INSTRUCTION_SET");
        const bool may_choose = !wanted || std::string_view(wanted) != "base";
        return may_choose && is_supported(InstructionSet::Avx2) ? InstructionSet::Avx2 : InstructionSet::Base;
    }();
    return chosen;
}

const char* get_name(InstructionSet set) { return set == InstructionSet::Avx2 ? "avx2" : "base"; }

}  // namespace shadow_layers
