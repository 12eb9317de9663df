// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "shadow_layers/names.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace shadow_layers {
namespace {

TEST(Names, EveryEnumeratorHasItsOwnAndIsFoundByIt) {
    std::set<std::string> names;
    for (const LightKind kind : {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area}) {
        EXPECT_EQ(find_light_kind(get_name(kind)), kind);
        EXPECT_NE(std::string(kLightKindNames).find(get_name(kind)), std::string::npos);
        names.insert(get_name(kind));
    }
    for (const PixelFilterKind filter :
         {PixelFilterKind::Box, PixelFilterKind::Gaussian, PixelFilterKind::BlackmanHarris}) {
        EXPECT_EQ(find_pixel_filter(get_name(filter)), filter);
        EXPECT_NE(std::string(kPixelFilterNames).find(get_name(filter)), std::string::npos);
        names.insert(get_name(filter));
    }
    for (const ParameterType type :
         {ParameterType::Bool, ParameterType::Int, ParameterType::Float, ParameterType::Enum})
        names.insert(get_name(type));
    for (const TruthKind truth : {TruthKind::Hard, TruthKind::Filtered, TruthKind::Soft, TruthKind::Pixel})
        names.insert(get_name(truth));
    for (const CasterMeshes meshes : {CasterMeshes::Any, CasterMeshes::MeshEdges, CasterMeshes::Closed})
        names.insert(get_name(meshes));
    for (const LightSize size : {LightSize::Ignored, LightSize::Followed}) names.insert(get_name(size));
    EXPECT_EQ(names.size(), 20u);
    EXPECT_EQ(names.count("unknown"), 0u);
}

TEST(Names, OthersAreNotFound) {
    for (const char* name : {"", "sun", "SUN ", "MOON", "unknown"}) {
        EXPECT_FALSE(find_light_kind(name)) << name;
        EXPECT_FALSE(find_pixel_filter(name)) << name;
    }
    EXPECT_STREQ(get_name(LightKind(9)), "unknown");
}

}  // namespace
}  // namespace shadow_layers
