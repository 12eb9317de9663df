// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The rule that gives receivers their view (shaders/shared/view_choice.h), as C++ and as GLSL.
#include <gtest/gtest.h>

#include <random>

#include "lights/light_views.h"
#include "support/glsl_lib_runner.h"

namespace shadow_layers::testing {
namespace {

/// Random directions, and all with components -1, 0 and 1, which lie between faces.
std::vector<glm::vec3> list_directions() {
    std::vector<glm::vec3> directions;
    for (int k = 0; k < 27; ++k) directions.emplace_back(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    std::mt19937 random(3);
    std::normal_distribution<float> part;
    for (int k = 0; k < 10000; ++k) directions.emplace_back(part(random), part(random), part(random));
    return directions;
}

std::vector<LightView> make_faces(std::initializer_list<int> faces) {
    std::vector<LightView> views;
    for (const int face : faces) views.emplace_back().face = std::uint8_t(face);
    return views;
}

TEST(ViewChoiceTest, OneViewServesAll) {
    for (const glm::vec3& direction : list_directions()) {
        ASSERT_EQ(choose_view(make_view_choice(kOneView, make_faces({0})), direction), 0);
        ASSERT_EQ(choose_view(make_view_choice(kOneView, {}), direction), kNoView);
        ASSERT_EQ(choose_view(LightSample().choice, direction), kNoView);
    }
}

TEST(ViewChoiceTest, CubeFacesAreThoseWhoseAxisIsNearest) {
    const std::vector<LightView> views = make_faces({5, 0, 3, 2});
    const ViewChoice choice = make_view_choice(kCubeFaces, views);
    for (const glm::vec3& direction : list_directions()) {
        const int view = choose_view(choice, glm::dvec3(direction));
        float best = 0, found = -1;  // along the axes of all faces, and of the view that was chosen
        for (int face = 0; face < 6; ++face) {
            const float along = (face % 2 ? -1.0f : 1.0f) * direction[face / 2];
            best = std::max(best, along);
            if (view != kNoView && views[std::size_t(view)].face == face) found = along;
        }
        if (view != kNoView) {
            ASSERT_EQ(found, best);
        } else {  // a face without a view is among the nearest
            ASSERT_TRUE(-direction.x == best || direction.z == best);
        }
    }
}

TEST(ViewChoiceTest, ShadersChooseAlike) {
    std::vector<glm::vec4> inputs;
    for (const glm::vec3& direction : list_directions()) inputs.emplace_back(direction, 0);
    GlslLibRunner runner;
    const auto out =
        runner.run("shared/view_choice.h",
                   "ViewChoice one = ViewChoice(ivec4(kOneView, 1, 0, 0), ivec4[2](ivec4(0), ivec4(0)));\n"
                   "ViewChoice cube = ViewChoice(ivec4(kCubeFaces, 4, 0, 0),\n"
                   "    ivec4[2](ivec4(1, -1, 3, 2), ivec4(-1, 0, -1, -1)));\n"
                   "outputs[i] = vec4(choose_view(one, inputs[i].xyz), choose_view(cube, inputs[i].xyz), 0, 0);",
                   inputs, int(inputs.size()), 1);
    const ViewChoice choice = make_view_choice(kCubeFaces, make_faces({5, 0, 3, 2}));
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        ASSERT_EQ(out[i].x, 0);
        ASSERT_EQ(out[i].y, float(choose_view(choice, glm::vec3(inputs[i]))));
        ASSERT_EQ(out[i].y, float(choose_view(choice, glm::dvec3(inputs[i]))));
    }
}

}  // namespace
}  // namespace shadow_layers::testing
