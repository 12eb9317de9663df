// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "shadow_layers/parameters.h"

#include <gtest/gtest.h>

#include <limits>

#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

std::vector<ParameterSpec> make_specs() {
    ParameterSpec size{"map_size", "Map Size", ParameterType::Int, std::int64_t(1024), 1, 16384, "texels", "",
                       {},         true};
    ParameterSpec kernel{"kernel", "Kernel", ParameterType::Int, std::int64_t(3), 1, 9, "texels", "", {}, false, 2};
    ParameterSpec softness{"softness", "Softness", ParameterType::Float, 0.0, 0, 8, "texels", "", {}};
    ParameterSpec smooth{"smooth", "Smooth", ParameterType::Bool, true, 0, 0, "", "", {}};
    ParameterSpec order{"order",
                        "Order",
                        ParameterType::Enum,
                        std::string("depth"),
                        0,
                        0,
                        "",
                        "",
                        {{"depth", "Depth", ""}, {"stream", "Stream", ""}}};
    return {size, kernel, softness, smooth, order};
}

ParameterValues resolve(const char* id, ParameterValue value) {
    ParameterValues given;
    given.set(id, std::move(value));
    return resolve_parameters("pcf", make_specs(), given);
}

std::string message_of(const char* id, ParameterValue value) {
    try {
        resolve(id, std::move(value));
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(Parameters, FillsInDefaults) {
    const ParameterValues values = resolve_parameters("pcf", make_specs(), {});
    EXPECT_EQ(values.get_int("map_size"), 1024);
    EXPECT_EQ(values.get_float("softness"), 0.0);
    EXPECT_TRUE(values.get_bool("smooth"));
    EXPECT_EQ(values.get_enum("order"), "depth");
}

TEST(Parameters, TakesWholeNumbersForFloats) {
    EXPECT_EQ(resolve("softness", std::int64_t(2)).get_float("softness"), 2.0);
}

TEST(Parameters, NamesTechniqueParameterValueAndRange) {
    const std::string text = message_of("map_size", std::int64_t(20000));
    for (const char* part : {"pcf", "map_size", "20000", "1", "16384", "texels"})
        EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(Parameters, RefusesWhatIsNotAllowed) {
    EXPECT_NE(message_of("kernel", std::int64_t(4)), "");
    EXPECT_EQ(message_of("kernel", std::int64_t(5)), "");
    EXPECT_NE(message_of("softness", std::numeric_limits<double>::quiet_NaN()), "");
    EXPECT_NE(message_of("softness", -0.1), "");
    EXPECT_NE(message_of("map_size", 512.0), "");
    EXPECT_NE(message_of("smooth", std::int64_t(1)), "");
    EXPECT_NE(message_of("order", std::string("random")).find("stream"), std::string::npos);
    EXPECT_NE(message_of("unknown", true).find("map_size"), std::string::npos);
}

TEST(Parameters, ReadingAsAnotherTypeIsAnError) {
    const ParameterValues values = resolve_parameters("pcf", make_specs(), {});
    EXPECT_THROW(values.get_float("map_size"), Error);
    EXPECT_THROW(values.get_int("missing"), Error);
}

}  // namespace
}  // namespace shadow_layers
