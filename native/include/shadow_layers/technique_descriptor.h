// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "shadow_layers/parameters.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {

/// One output channel group. "visibility" (1 channel, 1 = lit) is always the first.
struct OutputSpec {
    std::string id;     ///< snake_case
    std::string label;  ///< pass name part; empty for "visibility"
    int channels = 1;   ///< 1, 3 or 4
    std::string help;
};

inline OutputSpec describe_visibility() { return {"visibility", "", 1, "1 = lit, 0 = in shadow"}; }

/// How samples are spread over a light's shape.
enum class LightPattern : std::uint8_t {
    Sequence,  ///< additive sequence: even at any count
    Spiral,    ///< a lattice made for the count: sunflower on discs
    Grid,      ///< middles of cells of equal area
    Random,    ///< independent points, the same each time
};

/// What a technique needs around it, as a function of its parameters.
struct TechniqueNeeds {
    int map_size = 0;           ///< texels per side of each view's map, without border; 0: no views are made
    int map_border_texels = 0;  ///< extra texels on each side of each view, for kernels that reach over its rim
    int overscan_px = 0;        ///< extra frame pixels on each side of the region (camera-space stages)
    int light_samples = 1;      ///< points sampled on the light's shape; 1 = its centre
    LightPattern light_pattern = LightPattern::Sequence;
    bool sees_moved_frames = false;  ///< asks for other frames about the pixel's centre, which may see other receivers
    bool samples_itself = false;     ///< works all samples of the light at once: it is given the centre alone
    bool shifts_samples = false;     ///< does so at each pixel with another shift of the pattern (SamplePattern)

    /// Samples that the technique is called for, one by one.
    int separate_samples() const { return samples_itself ? 1 : light_samples; }
};

/// Which exact picture a technique's layer stands for.
enum class TruthKind : std::uint8_t {
    Hard,      ///< the mask of a light without size
    Filtered,  ///< that mask, averaged over a square in the map or on the receiver's plane
    Soft,      ///< the light in its real size
    Pixel,     ///< the hard mask, averaged over the pixel's square: of every point what the camera sees there
};

/// The truth of a layer with given parameters. A filter of another shape names the square of the same variance (a
/// Gaussian: its standard deviation times the root of 12).
struct TruthSpec {
    TruthKind kind = TruthKind::Hard;
    double footprint_texels = 0;  ///< Filtered: side of the square in texels of a view's map, in the map's plane
    double footprint_world = 0;   ///< Filtered: if not 0, side of the square in scene units on the receiver's plane
};

/// Which casters a technique shows the shadows of.
enum class CasterMeshes : std::uint8_t {
    Any,        ///< open and closed ones, also where surfaces cut each other
    MeshEdges,  ///< any, but borders are refined at edges of meshes alone: not where surfaces cut each other
    Closed,     ///< those in which every edge is shared evenly; a render warns of others, whose shadows may be wrong
};

/// What a technique makes of a light's size, with its parameters at their defaults.
enum class LightSize : std::uint8_t { Ignored, Followed };

/// A technique as data: everything that the rest of the product knows of it. The defaults are what most techniques
/// have, so that a descriptor names only what is its own.
struct TechniqueDescriptor {
    std::string id{};         ///< lower case; names folder, shaders, passes, docs page, benchmark row
    std::string label{};      ///< short name for menus
    std::string summary{};    ///< one sentence
    std::string reference{};  ///< bib key and section in docs/references.bib
    std::string limits{};     ///< one sentence: when it fails
    std::vector<ParameterSpec> parameters{};
    std::vector<OutputSpec> outputs = {describe_visibility()};  ///< outputs[0].id == "visibility"
    std::vector<LightKind> lights = {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area};  ///< served
    CasterMeshes meshes = CasterMeshes::Any;
    LightSize light_size = LightSize::Ignored;
    bool alpha_cutouts = false;  ///< light passes where a material's alpha cuts a hole; false: it counts as opaque
    bool test_only = false;      ///< not offered to users (probe)
    std::function<TechniqueNeeds(const ParameterValues&)> needs{};
    /// What the layer approximates; empty: the hard mask.
    std::function<TruthSpec(const ParameterValues&)> truth{};
    /// Throws InputError, made by `refuse_parameter`, for values that are wrong only together; may be empty.
    std::function<void(const ParameterValues&)> check{};
};

/// Fills in defaults and checks `given`, each value alone and then all together: InputError names technique, parameter,
/// value and range.
ParameterValues resolve_parameters(const TechniqueDescriptor& technique, const ParameterValues& given);

/// The truth of a layer with these resolved parameters.
TruthSpec find_truth(const TechniqueDescriptor& technique, const ParameterValues& values);

/// What the capabilities leave out (meshes, sizes and kinds of light, alpha), a sentence each. `limits` says the rest.
std::vector<std::string> list_restrictions(const TechniqueDescriptor& technique);

/// Throws the InputError of `check`: technique, parameter, value and what is allowed ("a number from 0.1 to 42 with
/// bits = 16").
[[noreturn]] void refuse_parameter(std::string_view technique, std::string_view parameter, const ParameterValue& value,
                                   std::string_view allowed);

/// All registered techniques in menu order.
const std::vector<TechniqueDescriptor>& technique_descriptors();

/// InputError listing the known ids if there is none.
const TechniqueDescriptor& find_technique_descriptor(std::string_view id);
const TechniqueDescriptor& find_technique_descriptor(const std::vector<TechniqueDescriptor>& among,
                                                     std::string_view id);

}  // namespace shadow_layers
