// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/sample_pattern.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace shadow_layers {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

// Roots of x^(d + 1) = x + 1: their inverse powers make the additive sequence of least discrepancy known in d
// dimensions.
constexpr double kRootOfPlane = 1.32471795724474602596;
constexpr double kRootOfSpace = 1.22074408460575947536;

// Irrational numbers that turn one coordinate of a lattice against another.
constexpr double kGolden = std::numbers::phi;
// [Alexa22] gives this pair for spirals over the sphere of four dimensions.
constexpr double kFirstSpiral = std::numbers::sqrt2, kSecondSpiral = 1.533751168755204288118041;

// How much longer a turn is than the way from the middle to the rim: on the sphere of four dimensions 2 pi times a
// radius of 0 to 1; measured as well, by the areas on both sides of straight borders.
constexpr double kTurnLength = 3;

double hash_to_unit(int i, int dimension) {
    std::uint64_t bits = (std::uint64_t(i) * 3 + std::uint64_t(dimension) + 1) * 0x9E3779B97F4A7C15u;
    bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
    bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
    return double((bits ^ (bits >> 31)) >> 11) * 0x1p-53;
}

/// Even over the unit disc, by area and angle; rows of the square become rings.
glm::dvec2 map_to_rings(const glm::dvec2& square) {
    const double radius = std::sqrt(square.x), angle = kTurn * square.y;
    return radius * glm::dvec2(std::cos(angle), std::sin(angle));
}

/// [Shirley97] Even over the unit disc; squares about the middle become circles, so that cells stay compact.
glm::dvec2 map_concentric(const glm::dvec2& square) {
    const glm::dvec2 p = 2.0 * square - 1.0;
    if (p.x == 0 && p.y == 0) return p;
    const bool steep = std::abs(p.y) > std::abs(p.x);
    const double radius = steep ? p.y : p.x;
    const double angle = steep ? 0.25 * kTurn - kTurn / 8 * (p.x / p.y) : kTurn / 8 * (p.y / p.x);
    return radius * glm::dvec2(std::cos(angle), std::sin(angle));
}

/// The square of the least distance between two points of the lattice of j steps (part, turns...), or less than
/// `enough`.
double find_least_square(double part, const std::vector<double>& turns, double turn_length, double enough) {
    double least = 1;
    for (int j = 1; j * part * j * part < least && least > enough; ++j) {
        double square = j * part * j * part;
        for (const double turn : turns) {
            const double ahead = glm::fract(j * turn), across = turn_length * std::min(ahead, 1 - ahead);
            square += across * across;
        }
        least = std::min(least, square);
    }
    return least;
}

/// Of all that give every shift_count-th point of the new lattice the old `turns`, those with the largest distance.
std::vector<double> find_lattice_turns(double part, int shift_count, const std::vector<double>& turns,
                                       double turn_length) {
    int combinations = 1;
    for (std::size_t axis = 0; axis < turns.size(); ++axis) combinations *= shift_count;
    std::vector<double> best;
    double largest = 0;
    for (int combination = 0; combination < combinations; ++combination) {
        std::vector<double> tried;
        int rest = combination;
        for (const double turn : turns) {
            tried.push_back((turn + rest % shift_count) / shift_count);
            rest /= shift_count;
        }
        const double least = find_least_square(part, tried, turn_length, largest);
        if (least > largest) largest = least, best = tried;
    }
    return best;
}

}  // namespace

/// Middle of cell i, where the square is cut into rows of cells that all have the same area, whatever their number.
glm::dvec2 SamplePattern::get_in_cell(int i) const {
    const int rows = std::max(1, int(std::lround(std::sqrt(double(count_)))));
    const auto row_begin = [&](int row) { return int(std::int64_t(row) * count_ / rows); };
    int row = int(std::int64_t(i) * rows / count_);
    while (row + 1 < rows && i >= row_begin(row + 1)) ++row;
    while (row > 0 && i < row_begin(row)) --row;
    const int begin = row_begin(row), end = row_begin(row + 1);
    return {(i - begin + 0.5) / (end - begin), 0.5 * (begin + end) / count_};
}

glm::dvec2 SamplePattern::get_unshifted_in_square(int i) const {
    switch (pattern_) {
        case LightPattern::Spiral:
            return {(i + 0.5) / count_, glm::fract(i / kGolden)};
        case LightPattern::Grid:
            return get_in_cell(i);
        case LightPattern::Random:
            return {hash_to_unit(i, 0), hash_to_unit(i, 1)};
        case LightPattern::Sequence:
            break;
    }
    return glm::fract((i + 1.0) / glm::dvec2(kRootOfPlane, kRootOfPlane * kRootOfPlane) + 0.5);
}

glm::dvec3 SamplePattern::get_unshifted_in_cube(int i) const {
    switch (pattern_) {
        case LightPattern::Spiral:
            return {(i + 0.5) / count_, glm::fract((i + 0.5) / kFirstSpiral), glm::fract((i + 0.5) / kSecondSpiral)};
        case LightPattern::Grid:
            return {get_in_cell(i), glm::fract((i + 0.5) / kGolden)};
        case LightPattern::Random:
            return {hash_to_unit(i, 0), hash_to_unit(i, 1), hash_to_unit(i, 2)};
        case LightPattern::Sequence:
            break;
    }
    const double step = 1 / kRootOfSpace;
    return glm::fract((i + 1.0) * glm::dvec3(step, step * step, step * step * step) + 0.5);
}

glm::dvec2 SamplePattern::get_in_square(int i) const {
    const glm::dvec2 place = get_unshifted_in_square(i);
    return shift_.in_square == glm::dvec2(0.0) ? place : glm::fract(place + shift_.in_square);
}

glm::dvec3 SamplePattern::get_in_cube(int i) const {
    const glm::dvec3 place = get_unshifted_in_cube(i);
    return shift_.in_cube == glm::dvec3(0.0) ? place : glm::fract(place + shift_.in_cube);
}

glm::dvec2 SamplePattern::get_in_disc(int i) const {
    const glm::dvec2 square = get_in_square(i);
    return pattern_ == LightPattern::Spiral ? map_to_rings(square) : map_concentric(square);
}

/// An even distribution over the sphere of four dimensions loses one coordinate to become this ball, and a second one
/// to become the even disc. [Shoemake92] maps a cube to that sphere.
glm::dvec3 SamplePattern::get_in_ball(int i) const {
    const glm::dvec3 cube = get_in_cube(i);
    const glm::dvec2 disc = map_to_rings({cube.x, cube.y});
    return {disc, std::sqrt(1 - cube.x) * std::cos(kTurn * cube.z)};
}

// The spiral's points are i steps of (1 / count, turn, ...). Shifts by k steps of a part of that, modulo 1, make one
// lattice of all points together; of the parts that do, those are taken whose points keep the largest distance.
std::vector<PatternShift> find_pattern_shifts(LightPattern pattern, int count, int shift_count) {
    std::vector<PatternShift> shifts;
    if (pattern == LightPattern::Spiral) {
        const double part = 1.0 / (double(count) * shift_count);
        const glm::dvec2 in_square(part, find_lattice_turns(part, shift_count, {1 / kGolden}, 1)[0]);
        const std::vector<double> turns =
            find_lattice_turns(part, shift_count, {1 / kFirstSpiral, 1 / kSecondSpiral}, kTurnLength);
        for (int k = 0; k < shift_count; ++k)
            shifts.push_back({double(k) * in_square, double(k) * glm::dvec3(part, turns[0], turns[1])});
        return shifts;
    }
    const double step = 1 / kRootOfSpace;
    for (int k = 0; k < shift_count; ++k) {
        const glm::dvec3 place = glm::fract(double(k) * glm::dvec3(step, step * step, step * step * step));
        shifts.push_back({glm::dvec2(place), place});
    }
    return shifts;
}

}  // namespace shadow_layers
