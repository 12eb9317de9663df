// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "shadow_layers/session.h"

namespace shadow_layers::cli {

/// Times of Embree's shadow rays over the receivers of the benchmark's frames, one entry a round, beside the rows'.
struct RayRow {
    std::string name;             ///< how Embree's scene is built
    std::vector<double> list_ms;  ///< finding the receivers that face the light
    std::vector<double> build_ms;
    std::vector<double> packets_ms, stream_ms;  ///< all rays, in packets and again as a stream
    std::vector<double> trace_ms;               ///< the shorter of the two, each round
    std::vector<double> processor_ms;           ///< of list, build and packets
    std::size_t receivers = 0, rays = 0;        ///< of all lights, of the last round
};

/// Times rays in the rounds of a benchmark. InputError where this program was built without Embree.
class RayBench {
public:
    explicit RayBench(int threads);
    ~RayBench();

    /// Renders what the camera of `request` sees and times the rays to the samples that its jobs take of their lights,
    /// each way once.
    void measure(Session& session, const RenderRequest& request);
    const std::vector<RayRow>& rows() const { return rows_; }

private:
    struct Rays;
    std::unique_ptr<Rays> rays_;
    std::vector<RayRow> rows_;
};

}  // namespace shadow_layers::cli
