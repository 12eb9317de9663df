// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>

#include "base/thread_pool.h"
#include "frame/frame.h"
#include "techniques/technique.h"

namespace shadow_layers {

/// The channels of one job: takes them from the technique for each sample, crops the overscan, checks them and builds
/// up the mean over the samples.
class LayerSum final : public LayerOutputs {
public:
    LayerSum(ThreadPool& threads, const TechniqueDescriptor& descriptor, int sample_count);

    /// Starts a sample; the outputs that follow have this frame's size.
    void begin_sample(const Frame& frame);
    void set(const std::string& channel, const gl::Texture& texture) override;
    void set(const std::string& channel, Image image) override;
    /// DriverError naming technique and channel if one is missing or holds a value that is not a number.
    void end_sample();

    /// This sample's visibility, of the region's size.
    const std::vector<float>& visibility() const { return sample_.at("visibility").data; }

    /// The means. Ends the sum.
    std::map<std::string, Image> take();

    static std::size_t bytes_needed(const TechniqueDescriptor& descriptor, const PixelRect& region);

private:
    const OutputSpec& find_output(const std::string& channel) const;
    Image& start_channel(const OutputSpec& output);
    void check_values(const std::string& channel, Image& image) const;

    ThreadPool& threads_;
    const TechniqueDescriptor& descriptor_;
    int sample_count_, samples_done_ = 0;
    const Frame* frame_ = nullptr;
    std::map<std::string, Image> sample_, sum_;
};

}  // namespace shadow_layers
