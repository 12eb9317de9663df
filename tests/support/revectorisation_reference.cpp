// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/revectorisation_reference.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace shadow_layers::testing {
namespace {

double unit(double value) { return std::clamp(value, 0.0, 1.0); }

/// Which sides a walk follows; a texel carries it on while any of them is a discontinuity.
struct Wanted {
    bool left = false, right = false, top = false, bottom = false;
    bool any_of(const TexelSides& s) const {
        return (left && s.left) || (right && s.right) || (top && s.top) || (bottom && s.bottom);
    }
};

/// alpha of one direction: > 0 the end's distance, < 0 the beginning's.
int walk(const AnswerMap& map, glm::ivec2 texel, glm::ivec2 step, Wanted wanted, int limit) {
    const bool own = map.at(texel.x, texel.y);
    for (int n = 1; n <= limit; ++n) {
        const glm::ivec2 there = texel + n * step;
        if (map.at(there.x, there.y) != own) return n;
        if (!wanted.any_of(find_sides(map, there))) return -n;
    }
    return -(limit + 1);
}

struct Oriented {
    int label = 0;        ///< -1: no end, 0: one end, 1: two ends
    double d = 0, e = 0;  ///< d of [Macedo16] Eq. 1 for label 0; e: way to the nearest end / length for label 1
    double completed() const { return label == 0 ? d : label > 0 ? 1.0 : 0.0; }
};

Oriented orient(const AnswerMap& map, glm::ivec2 texel, glm::ivec2 step, Wanted wanted, double at, int limit) {
    const int first = walk(map, texel, step, wanted, limit), second = walk(map, texel, -step, wanted, limit);
    const double length = std::min(std::abs(first) + std::abs(second) - 1, limit);
    Oriented run;
    run.label = first > 0 && second > 0 ? 1 : first < 0 && second < 0 ? -1 : 0;
    if (run.label == 0) {
        const double oriented_place = first > 0 ? at : 1 - at;
        run.d = 1 - std::max(first, second) / length + oriented_place / length;
    }
    if (run.label == 1) run.e = std::min(first - at, second - (1 - at)) / length;
    return run;
}

Oriented orient_x(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, const TexelSides& sides, int limit) {
    return orient(map, texel, {1, 0}, {.top = sides.top, .bottom = sides.bottom}, place.x, limit);
}

Oriented orient_y(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, const TexelSides& sides, int limit) {
    return orient(map, texel, {0, 1}, {.left = sides.left, .right = sides.right}, place.y, limit);
}

/// The dominance test of corners: is there a horizontal run, is there a vertical one, beyond this texel?
std::pair<bool, bool> test_dominance(const AnswerMap& map, glm::ivec2 texel, const TexelSides& sides) {
    const TexelSides beside = find_sides(map, texel + glm::ivec2(sides.left ? 1 : -1, 0));
    const TexelSides beyond = find_sides(map, texel + glm::ivec2(0, sides.bottom ? -1 : 1));
    return {beside.top || beside.bottom, beyond.left || beyond.right};
}

struct Break {
    int steps = 1 << 20;
    bool left = false, right = false;
};

/// First texel of a vertical channel, upwards or downwards, where left and right are no longer both discontinuities.
Break find_break(const AnswerMap& map, glm::ivec2 texel, int direction, int limit) {
    const bool own = map.at(texel.x, texel.y);
    for (int n = 1; n <= limit; ++n) {
        const glm::ivec2 there = texel + glm::ivec2(0, n * direction);
        if (map.at(there.x, there.y) != own) return {};
        const TexelSides sides = find_sides(map, there);
        if (!(sides.left && sides.right)) return {n, sides.left, sides.right};
    }
    return {};
}

Break nearest_break(const AnswerMap& map, glm::ivec2 texel, const TexelSides& sides, int limit) {
    const Break up = sides.bottom ? Break{} : find_break(map, texel, 1, limit);
    const Break down = sides.top ? Break{} : find_break(map, texel, -1, limit);
    return up.steps <= down.steps ? up : down;
}

/// Light in the corner that a bend opens; `h` runs towards the bend.
double bend(const TexelSides& there, glm::dvec2 place, double h) {
    if (there.left == there.right) return 0;
    return unit((there.left ? place.x : 1 - place.x) + h - 1);
}

RevectorisedSample lit_channel(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit) {
    const TexelSides sides = find_sides(map, texel);
    const Oriented run = orient_y(map, texel, place, sides, limit);
    const bool third = sides.top || sides.bottom;
    const double third_depth = sides.top ? place.y : 1 - place.y;
    if (run.label < 0) return {1, 1};
    if (run.label > 0 && !third) {
        const TexelSides up = find_sides(map, texel + glm::ivec2(0, 1)),
                         down = find_sides(map, texel - glm::ivec2(0, 1));
        double v = 0;
        if (!(up.left && up.right)) v = std::max(v, bend(up, place, place.y));
        if (!(down.left && down.right)) v = std::max(v, bend(down, place, 1 - place.y));
        return {v, 4};
    }
    if (run.label > 0) {
        const TexelSides opposite = find_sides(map, texel + glm::ivec2(0, sides.top ? 1 : -1));
        if (!(opposite.left && opposite.right)) return {bend(opposite, place, third_depth), 5};
        const double d = run.e + 0.5;
        return {std::min({third_depth, unit(1 + place.x - d), unit(2 - place.x - d)}), 5};
    }
    const Break broken = nearest_break(map, texel, sides, limit);
    const double left = unit(1 + place.x - run.d), right = unit(2 - place.x - run.d);
    const int number = third ? 8 : 9;
    if (broken.left) return {third ? std::min(third_depth, left) : left, number};
    if (broken.right) return {third ? std::min(third_depth, right) : right, number};
    return {1 - run.d, number};
}

RevectorisedSample dark_channel(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit) {
    const TexelSides sides = find_sides(map, texel);
    const Oriented run = orient_y(map, texel, place, sides, limit);
    const bool third = sides.top || sides.bottom;
    if (run.label < 0) return {0, 0};
    const double left = run.label > 0 ? 1 - place.x : unit(run.d - place.x);
    const double right = run.label > 0 ? place.x : unit(run.d + place.x - 1);
    const Break broken = nearest_break(map, texel, sides, limit);
    if (!third) return {broken.left ? left : broken.right ? right : run.completed(), 13};
    const double over_third = 1 - (sides.top ? place.y : 1 - place.y);
    const TexelSides opposite = find_sides(map, texel + glm::ivec2(0, sides.top ? 1 : -1));
    if (opposite.left && !opposite.right) return {std::max(over_third, left), 12};
    if (opposite.right && !opposite.left) return {std::max(over_third, right), 12};
    if (!opposite.left) return {run.completed(), 12};
    if (broken.left) return {std::max(over_third, 1 - place.x), 12};
    if (broken.right) return {std::max(over_third, place.x), 12};
    return {run.completed(), 12};
}

double side_depth_x(const TexelSides& sides, glm::dvec2 place) { return sides.left ? place.x : 1 - place.x; }
double side_depth_y(const TexelSides& sides, glm::dvec2 place) { return sides.top ? place.y : 1 - place.y; }
}  // namespace

bool AnswerMap::at(int x, int y) const {
    return lit[std::size_t(std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1))] != 0;
}

AnswerMap AnswerMap::transposed() const {
    AnswerMap other(height, width);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) other.set(y, x, at(x, y));
    return other;
}

AnswerMap AnswerMap::healed() const {
    AnswerMap other = *this;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (find_sides(*this, {x, y}).count() == 4) other.set(x, y, !at(x, y));
    return other;
}

TexelSides find_sides(const AnswerMap& map, glm::ivec2 texel) {
    const bool own = map.at(texel.x, texel.y);
    return {map.at(texel.x - 1, texel.y) != own, map.at(texel.x + 1, texel.y) != own,
            map.at(texel.x, texel.y - 1) != own, map.at(texel.x, texel.y + 1) != own};
}

RevectorisedSample smsr_by_cases(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit) {
    if (!map.at(texel.x, texel.y)) return {0, 0};
    const TexelSides sides = find_sides(map, texel);
    if ((sides.left && sides.right) || (sides.top && sides.bottom)) return {0, 3};
    bool across_y = sides.top || sides.bottom, across_x = sides.left || sides.right;
    const Oriented x = orient_x(map, texel, place, sides, limit), y = orient_y(map, texel, place, sides, limit);
    if ((across_y && x.label < 0) || (across_x && y.label < 0)) return {1, 1};
    if ((across_y && x.label > 0) || (across_x && y.label > 0)) return {0, 2};
    const bool bottom_or_top = sides.bottom ? 1 - place.y < x.d : place.y < x.d;
    const bool left_or_right = sides.left ? place.x < y.d : 1 - place.x < y.d;
    if (across_x && across_y) {
        const auto [horizontal, vertical] = test_dominance(map, texel, sides);
        if (vertical && !horizontal) return {left_or_right ? 0.0 : 1.0, 4};
        if (horizontal && !vertical) return {bottom_or_top ? 0.0 : 1.0, 5};
        if (horizontal && vertical) return {bottom_or_top || left_or_right ? 0.0 : 1.0, 8};
        if (sides.bottom) return {1 - x.d < place.y ? 0.0 : 1.0, 6};
        return {1 - x.d < 1 - place.y ? 0.0 : 1.0, 7};
    }
    if (across_y) return {bottom_or_top ? 0.0 : 1.0, sides.bottom ? 9 : 10};
    return {across_x && left_or_right ? 0.0 : 1.0, across_x ? (sides.left ? 11 : 12) : 0};
}

RevectorisedSample rsmss_by_cases(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit) {
    const bool lit = map.at(texel.x, texel.y);
    const TexelSides sides = find_sides(map, texel);
    if (sides.count() == 0) return {lit ? 1.0 : 0.0, 0};
    if (sides.count() == 4) return lit ? RevectorisedSample{0, 2} : RevectorisedSample{1, 3};
    if (sides.left && sides.right)
        return lit ? lit_channel(map, texel, place, limit) : dark_channel(map, texel, place, limit);
    if (sides.top && sides.bottom) {  // the cases of horizontal channels are two numbers on
        const glm::ivec2 turned(texel.y, texel.x);
        const glm::dvec2 turned_place(place.y, place.x);
        RevectorisedSample sample = lit ? lit_channel(map.transposed(), turned, turned_place, limit)
                                        : dark_channel(map.transposed(), turned, turned_place, limit);
        if (sample.case_number > 1) sample.case_number += 2;
        return sample;
    }
    const int exiting = lit ? 0 : 8;
    const Oriented x = orient_x(map, texel, place, sides, limit), y = orient_y(map, texel, place, sides, limit);
    const double qx = side_depth_x(sides, place), qy = side_depth_y(sides, place);
    const double over_x = lit ? unit(1 + qy - x.completed()) : unit(x.completed() - qy);  // the run along x
    const double over_y = lit ? unit(1 + qx - y.completed()) : unit(y.completed() - qx);
    const bool across_y = sides.top || sides.bottom, across_x = sides.left || sides.right;
    if (across_x && across_y) {
        const auto [horizontal, vertical] = test_dominance(map, texel, sides);
        if (horizontal && !vertical) return {over_x, 16 + exiting};
        if (vertical && !horizontal) return {over_y, 17 + exiting};
        if (!horizontal) return {over_x, 18 + exiting};
        return {lit ? std::min(over_x, over_y) : std::max(over_x, over_y), 19 + exiting};
    }
    const Oriented& run = across_y ? x : y;
    const double q = across_y ? qy : qx;
    if (run.label < 0) return {lit ? 1.0 : 0.0, lit ? 1 : 0};
    if (run.label > 0) return {lit ? q : 1 - q, (across_y ? 20 : 21) + exiting};
    return {lit ? unit(1 + q - run.d) : unit(run.d - q), (across_y ? 22 : 23) + exiting};
}

double smsr_by_rule(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit) {
    if (!map.at(texel.x, texel.y)) return 0;
    const TexelSides sides = find_sides(map, texel);
    if (sides.is_channel()) return 0;
    const Oriented x = orient_x(map, texel, place, sides, limit), y = orient_y(map, texel, place, sides, limit);
    bool use_x = sides.top || sides.bottom, use_y = sides.left || sides.right;
    if (use_x && use_y) {
        if (x.label > 0 || y.label > 0) return 0;
        const auto [horizontal, vertical] = test_dominance(map, texel, sides);
        use_x = horizontal || !vertical;
        use_y = vertical;
    }
    const bool dark =
        (use_x && x.completed() > side_depth_y(sides, place)) || (use_y && y.completed() > side_depth_x(sides, place));
    return dark ? 0 : 1;
}

double rsmss_by_rule(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit) {
    const bool lit = map.at(texel.x, texel.y);
    const TexelSides sides = find_sides(map, texel);
    if (sides.count() == 4) return lit ? 0.0 : 1.0;
    const auto ramp = [&](double depth, const Oriented& run) {
        return lit ? unit(1 + depth - run.completed()) : unit(run.completed() - depth);
    };
    if (sides.is_channel()) {
        const bool upright = sides.left && sides.right;
        const glm::ivec2 step = upright ? glm::ivec2(0, 1) : glm::ivec2(1, 0);
        const double at = upright ? place.y : place.x, across = upright ? place.x : place.y;
        const Wanted low = upright ? Wanted{.left = true} : Wanted{.top = true};
        const Wanted high = upright ? Wanted{.right = true} : Wanted{.bottom = true};
        const double sum = ramp(across, orient(map, texel, step, low, at, limit)) +
                           ramp(1 - across, orient(map, texel, step, high, at, limit));
        return unit(lit ? sum - 1 : sum);
    }
    bool use_x = sides.top || sides.bottom, use_y = sides.left || sides.right;
    if (use_x && use_y) {
        const auto [horizontal, vertical] = test_dominance(map, texel, sides);
        use_x = horizontal || !vertical;
        use_y = vertical;
    }
    double result = lit ? 1 : 0;
    const auto combine = [&](double part) { result = lit ? std::min(result, part) : std::max(result, part); };
    if (use_x) combine(ramp(side_depth_y(sides, place), orient_x(map, texel, place, sides, limit)));
    if (use_y) combine(ramp(side_depth_x(sides, place), orient_y(map, texel, place, sides, limit)));
    return result;
}

glm::dvec2 reduced_distances(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit) {
    const Wanted all{true, true, true, true};
    if (find_sides(map, texel).count() == 0) return glm::dvec2(0);
    const auto way = [&](glm::ivec2 step, double at) {  // of one axis
        const int ahead = walk(map, texel, step, all, limit), back = walk(map, texel, -step, all, limit);
        const double to_ahead = std::abs(ahead) - 1 + (1 - at), to_back = std::abs(back) - 1 + at;
        const double length = std::min(to_ahead + to_back, double(limit));
        if (ahead > 0 && back > 0) return unit(2 * std::min(to_ahead, to_back) / length);
        return ahead > 0 ? unit(to_ahead / length) : back > 0 ? unit(to_back / length) : 0.0;
    };
    return {way({1, 0}, place.x), way({0, 1}, place.y)};
}

double reduced_by_rule(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit) {
    if (!map.at(texel.x, texel.y) || find_sides(map, texel).is_channel()) return 0;
    const glm::dvec2 distances = reduced_distances(map, texel, place, limit);
    return distances.x * distances.y > 0 && distances.x + distances.y < 1 ? 0 : 1;
}

double half_level_by_rule(const AnswerMap& map, glm::ivec2 texel, glm::dvec2 place, int limit) {
    const glm::dvec2 distances = reduced_distances(map, texel, place, limit);
    return map.at(texel.x, texel.y) != (distances.x * distances.y > 0 && distances.x + distances.y < 0.5) ? 1 : 0;
}

}  // namespace shadow_layers::testing
