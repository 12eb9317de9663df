// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What one sample of a light brings to a receiver against the light's other samples, compiled by C++ and by GLSL. THE
// definition of the weights that soft shadows are averaged with: light with shadows by light without them, as Cycles
// has it.

#ifdef __cplusplus
#include <algorithm>
namespace shadow_layers {
/// Real: float, double, or SIMD lanes that have max and min.
template <class Real>
inline Real
#else
#define Real float
Real
#endif
/// In units of a light of the same power at the light's centre that shines straight on the receiver: near 1 at any
/// scale of the scene. `up`: the receiver's unit normal times the vector to the sample, > 0; `apart`: that vector's
/// length (of a sun: 1). Of an area light only: `along`, that vector along the light's z axis, and `centre_apart`, the
/// distance of the light's centre; for it is brighter face on, and near parts of it more than far ones.
find_light_weight(Real up, Real apart, bool is_area, Real along, Real centre_apart) {
#ifdef __cplusplus
    using std::max, std::min;
#endif
    Real weight = up / max(apart, Real(1e-30));
    if (is_area) {
        Real nearness = min(centre_apart / max(apart, Real(1e-30)), Real(1e4));
        weight *= along / max(apart, Real(1e-30)) * nearness * nearness;
    }
    return weight;
}

#ifdef __cplusplus
}  // namespace shadow_layers
#else
#undef Real
#endif
