// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/image_writer.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>

#include "io/whole_file.h"
#include "shadow_layers/error.h"

namespace shadow_layers::io {
namespace {

const char* channel_letters(int channels) { return channels == 1 ? "X" : channels == 3 ? "RGB" : "RGBA"; }

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& reason) {
    throw FileError("'" + path.string() + "' cannot be written: " + reason);
}

OIIO::ImageSpec make_spec(const ExrLayer& layer, int full_width, int full_height, const PixelRect& region) {
    OIIO::ImageSpec spec(region.width, region.height, layer.channels, OIIO::TypeDesc::FLOAT);
    spec.x = region.x;
    spec.y = full_height - region.y - region.height;  // files count rows from the top
    spec.full_width = full_width;
    spec.full_height = full_height;
    spec.channelnames.clear();
    for (const char* letter = channel_letters(layer.channels); *letter; ++letter) {
        spec.channelnames.push_back(layer.name + "." + *letter);
    }
    spec.alpha_channel = layer.channels == 4 ? 3 : -1;
    spec.attribute("compression", "zip");
    spec.attribute("oiio:subimagename", layer.name);
    for (const auto& [key, value] : layer.metadata) spec.attribute(key, value);
    return spec;
}

std::uint8_t quantise(float value) {
    return std::uint8_t(std::lround(std::clamp(std::isfinite(value) ? value : 0.0f, 0.0f, 1.0f) * 255.0f));
}

// [IEC 61966-2-1] transfer function of sRGB.
float encode_srgb(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

std::vector<std::uint8_t> quantise(const Image& image) {
    std::vector<std::uint8_t> pixels(image.data.size());
    if (image.channels != 4) {
        std::transform(image.data.begin(), image.data.end(), pixels.begin(),
                       [](float value) { return quantise(value); });
        return pixels;
    }
    for (std::size_t i = 0; i < image.data.size(); i += 4) {
        const float alpha = std::clamp(image.data[i + 3], 0.0f, 1.0f);
        for (std::size_t c = 0; c < 3; ++c) {
            const float straight = std::clamp(image.data[i + c] / std::max(alpha, 1e-6f), 0.0f, 1.0f);
            pixels[i + c] = quantise(encode_srgb(straight));
        }
        pixels[i + 3] = quantise(alpha);
    }
    return pixels;
}

}  // namespace

std::string get_channel_list(const ExrLayer& layer) { return layer.name + "." + channel_letters(layer.channels); }

// OpenEXR writes multi-part files by name only, and loses what fails while it closes them. So the file is read back.
struct ExrWriter::Impl {
    std::filesystem::path path;
    TemporaryFile file;
    std::vector<OIIO::ImageSpec> specs;
    std::unique_ptr<OIIO::ImageOutput> output;  // after `file`: it is ended first
    std::size_t next = 0;

    explicit Impl(std::filesystem::path final_path) : path(std::move(final_path)), file(path) {}
    void read_back() const;
};

ExrWriter::ExrWriter(std::filesystem::path path, int full_width, int full_height, const PixelRect& region,
                     std::vector<ExrLayer> layers)
    : impl_(std::make_unique<Impl>(std::move(path))) {
    for (const ExrLayer& layer : layers) impl_->specs.push_back(make_spec(layer, full_width, full_height, region));
    impl_->output = OIIO::ImageOutput::create("layers.exr");
    if (!impl_->output) fail(impl_->path, "OpenImageIO has no EXR writer: " + OIIO::geterror());
    if (!impl_->output->open(impl_->file.name().string(), int(impl_->specs.size()), impl_->specs.data())) {
        fail(impl_->path, impl_->output->geterror());
    }
}

ExrWriter::~ExrWriter() = default;

void ExrWriter::write(const Image& image) {
    Impl& impl = *impl_;
    if (impl.next >= impl.specs.size()) fail(impl.path, "internal: more layers than announced");
    const OIIO::ImageSpec& spec = impl.specs[impl.next];
    if (image.width != spec.width || image.height != spec.height || image.channels != spec.nchannels) {
        fail(impl.path, "internal: layer " + std::to_string(impl.next) + " is not of the announced size");
    }
    OIIO::ImageOutput& output = *impl.output;
    if (impl.next > 0 && !output.open(impl.file.name().string(), spec, OIIO::ImageOutput::AppendSubimage)) {
        fail(impl.path, output.geterror());
    }
    const auto row_bytes = OIIO::stride_t(std::size_t(image.width) * std::size_t(image.channels) * sizeof(float));
    const auto* top_row = reinterpret_cast<const char*>(image.data.data()) + row_bytes * (image.height - 1);
    if (!output.write_image(OIIO::TypeDesc::FLOAT, top_row, OIIO::AutoStride, -row_bytes)) {
        fail(impl.path, output.geterror() + "; choose another folder, or free its disk");
    }
    ++impl.next;
}

void ExrWriter::Impl::read_back() const {
    const std::string remedy = "; choose another folder, or free its disk";
    const auto input = OIIO::ImageInput::open(file.name().string());
    if (!input) fail(path, "what was written cannot be read: " + OIIO::geterror() + remedy);
    std::vector<float> pixels;
    for (std::size_t part = 0; part < specs.size(); ++part) {
        pixels.resize(specs[part].image_pixels() * std::size_t(specs[part].nchannels));
        if (!input->read_image(int(part), 0, 0, specs[part].nchannels, OIIO::TypeDesc::FLOAT, pixels.data())) {
            fail(path, "what was written cannot be read: " + input->geterror() + remedy);
        }
    }
}

void ExrWriter::finish() {
    if (impl_->next != impl_->specs.size()) fail(impl_->path, "internal: fewer layers than announced");
    if (!impl_->output->close()) fail(impl_->path, impl_->output->geterror());
    impl_->output.reset();
    impl_->read_back();
    impl_->file.finish();
}

void write_png(const std::filesystem::path& path, const Image& image) {
    const std::vector<std::uint8_t> pixels = quantise(image);
    OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (image.channels == 4) spec.attribute("oiio:ColorSpace", "sRGB");
    OIIO::Filesystem::IOVecOutput bytes;
    const auto output = OIIO::ImageOutput::create("layer.png");
    if (!output) fail(path, "OpenImageIO has no PNG writer: " + OIIO::geterror());
    output->set_ioproxy(&bytes);
    if (!output->open("layer.png", spec)) fail(path, output->geterror());
    const auto row_bytes = OIIO::stride_t(std::size_t(image.width) * std::size_t(image.channels));
    const std::uint8_t* top_row = pixels.data() + row_bytes * (image.height - 1);
    if (!output->write_image(OIIO::TypeDesc::UINT8, top_row, OIIO::AutoStride, -row_bytes) || !output->close()) {
        fail(path, output->geterror());
    }
    write_whole_file(path, std::as_bytes(std::span(bytes.buffer())));
}

}  // namespace shadow_layers::io
