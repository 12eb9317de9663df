// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/options.h"
#include "io/scene_file.h"
#include "shadow_layers/request.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers::cli {

/// How far layers are from an exact one, over the pixels whose visibility is decided by what lies between them and the
/// light. Visibility is 0 to 1.
struct LayerErrors {
    std::size_t pixels = 0;
    double mean_absolute = 0, root_mean_square = 0, bias = 0;  ///< of layer minus truth; bias > 0: too light
    double wrong_fraction = 0;                                 ///< of pixels on the wrong side of one half
    std::size_t border_pixels = 0;                             ///< with a truth between 0 and 1
    double border_mean_absolute = 0;                           ///< over these
};

/// A soft layer against rays to the very samples of the light that it takes. A bit is a receiver and a sample that it
/// faces.
struct SampleErrors {
    int light_samples = 0;
    std::size_t bits = 0;          ///< of all pixels whose samples were looked at
    std::size_t wrong_bits = 0;    ///< at least so many, outside of ties and of what float weights may change
    std::size_t wrong_pixels = 0;  ///< with wrong bits
    std::size_t penumbra_pixels = 0;
    std::size_t ties = 0;  ///< bits that rounding may decide either way
};

/// The errors of a row: against the light's hard mask, and against what the technique itself approximates.
struct RowErrors {
    LayerErrors hard, own;
    TruthSpec truth;
    std::optional<double> truth_standard_error;  ///< of a soft one: its mean over the pixels that have one
};

/// One row of a benchmark: a technique with its settings on all chosen lights, and what was measured. Times have one
/// entry a round, so that two rows can be compared round by round.
struct BenchRow {
    std::string name;  ///< as the rows' file has it, or the settings
    std::string technique;
    ParameterValues given, resolved;
    RenderRequest request;
    std::vector<double> render_ms, frame_ms, layers_ms;
    std::vector<double> processor_ms;  ///< of all threads, the software rasteriser's too: a busy machine blurs it less
    std::map<std::string, std::vector<double>> cpu_ms, gl_ms;  ///< by stage: "frame: ..." or the layer's stage
    /// By stage, the longer of both: a software rasteriser works on after the call has returned.
    std::map<std::string, std::vector<double>> stage_ms;
    std::map<std::string, std::int64_t> counters;  ///< summed over the lights
    std::optional<RowErrors> errors;
    std::optional<SampleErrors> bits;
};

/// The rows that the command line asks for: those of --rows, else the techniques by the grid of --set and --map-size.
/// InputError naming file, row and what is wrong, or that no technique serves any of the lights.
std::vector<BenchRow> make_bench_rows(const Options& options, const io::SceneFile& file,
                                      const std::vector<std::uint32_t>& lights);

/// The row that `row` is compared with: sm with the same map size and lights, else the first sm on these lights; null
/// if there is none.
const BenchRow* find_reference_row(const std::vector<BenchRow>& rows, const BenchRow& row);

/// Per round the time of `row` by that of `reference`, which were measured one after the other. Empty without one.
std::vector<double> compute_ratios(const std::vector<double>& row_ms, const std::vector<double>& reference_ms);

}  // namespace shadow_layers::cli
