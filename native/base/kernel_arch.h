// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// For *_kernel.cpp only, which are compiled once per instruction set (base/instruction_set.h): the set's registers, and
// names for what a set's build hands out. All else in a kernel lies in an anonymous namespace, so that no function that
// is compiled for one set is ever linked into another's.

#include <xsimd/xsimd.hpp>

#if !defined(SHADOW_LAYERS_SET)
#error "kernel_arch.h is for kernels; name the file *_kernel.cpp"
#endif

#define SHADOW_LAYERS_JOIN_NAMES(name, set) name##set
#define SHADOW_LAYERS_JOIN(name, set) SHADOW_LAYERS_JOIN_NAMES(name, set)
/// kBuild is kBuildBase or kBuildAvx2.
#define SHADOW_LAYERS_OF_SET(name) SHADOW_LAYERS_JOIN(name, SHADOW_LAYERS_SET)

namespace shadow_layers {
namespace {

#if defined(__AVX2__)
using Arch = xsimd::fma3<xsimd::avx2>;
#elif defined(__x86_64__)
using Arch = xsimd::sse2;
#else
using Arch = xsimd::default_arch;
#endif

}  // namespace
}  // namespace shadow_layers
