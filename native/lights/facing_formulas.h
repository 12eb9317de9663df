// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a receiver stands to a light, for one receiver (T = double) or for several at once (T: SIMD lanes), with the same
// bits. Plain data and templates on T only: files that are compiled for different processors share this.

#include <cmath>

namespace shadow_layers::facing {

template <class T>
struct Vector {
    T x, y, z;
};

template <class T>
T dot(const double (&a)[3], const Vector<T>& b) {
    return T(a[0]) * b.x + T(a[1]) * b.y + T(a[2]) * b.z;
}

template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A light position as the rule needs it; places are relative to the frame's origin.
struct Source {
    bool directional = false;
    double to_light[3] = {0, 0, 1};      ///< of a sun: unit
    double place[3] = {0, 0, 0};         ///< else
    double axes[3][3] = {};              ///< x, y, z of the light
    double cone_cos = -2, cone_sin = 0;  ///< as in LightSample; cos <= -1: no cone
    double cone_shrink[2] = {1, 1};      ///< 1 / LightSample::cone_scale: what makes the cone round
};

/// From the receiver to the light: a unit vector for a sun, else the unscaled difference.
template <class T>
Vector<T> find_to_light(const Source& source, const Vector<T>& receiver) {
    if (source.directional) return {T(source.to_light[0]), T(source.to_light[1]), T(source.to_light[2])};
    return {T(source.place[0]) - receiver.x, T(source.place[1]) - receiver.y, T(source.place[2]) - receiver.z};
}

/// A direction as the cone takes it: its components across and along the axis, in the space of the lamp's own scale,
/// where the cone is round. Cycles (4.0 on) divides the local direction by the scale as well.
template <class T>
struct ConeParts {
    T across, along;
};

template <class T>
ConeParts<T> find_cone_parts(const Source& source, const Vector<T>& to_light) {
    using std::sqrt;
    const T across_x = dot(source.axes[0], to_light) * T(source.cone_shrink[0]);
    const T across_y = dot(source.axes[1], to_light) * T(source.cone_shrink[1]);
    return {sqrt(across_x * across_x + across_y * across_y), dot(source.axes[2], to_light)};
}

/// By how much a move of a direction may grow in that space.
inline double find_cone_stretch(const Source& source) {
    return std::fmax(1.0, std::fmax(source.cone_shrink[0], source.cone_shrink[1]));
}

/// Is the direction inside the source's cone? The rim is inside. Decided by the component across the axis, not by
/// the cosine: a spot as narrow as 1e-6 keeps its rim. `slack` widens the cone by that part of it.
template <class T>
auto is_in_cone(const Source& source, const Vector<T>& to_light, double slack = 0) {
    using std::sqrt;
    ConeParts<T> parts = find_cone_parts(source, to_light);
    if (slack != 0) parts.along = parts.along + T(slack * find_cone_stretch(source)) * sqrt(dot(to_light, to_light));
    return parts.across * T(source.cone_cos) <= parts.along * T(source.cone_sin);
}

}  // namespace shadow_layers::facing
