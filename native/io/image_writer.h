// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "shadow_layers/request.h"

namespace shadow_layers::io {

/// A layer of an EXR: a part of its own. Channels are "NAME.X", or "NAME.R" … for 3 and 4.
struct ExrLayer {
    std::string name;  ///< without dots; unique in the file
    int channels = 1;
    std::map<std::string, std::string> metadata;
};

/// The channels of a layer as the add-on lists them: "NAME.X", "NAME.RGB", "NAME.RGBA".
std::string get_channel_list(const ExrLayer& layer);

/// A multi-part EXR (float, ZIP), written layer by layer, so that a picture can be dropped once it is given. It grows
/// under a temporary name beside its own; finish() reads it back, to be sure that all of it reached the disk, and gives
/// it its name. Everything throws FileError.
class ExrWriter {
public:
    /// `region` is the part of the full picture that the layers hold (row 0 at the bottom).
    ExrWriter(std::filesystem::path path, int full_width, int full_height, const PixelRect& region,
              std::vector<ExrLayer> layers);
    ~ExrWriter();
    ExrWriter(const ExrWriter&) = delete;
    ExrWriter& operator=(const ExrWriter&) = delete;

    /// The next layer, in the order given. Its size is the region's, its channels as announced.
    void write(const Image& image);
    void finish();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// 8 bits, row 0 at the bottom. One or three channels as they are (linear, clamped: a mask is data); four as a picture:
/// linear premultiplied to sRGB with straight alpha. FileError.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace shadow_layers::io
