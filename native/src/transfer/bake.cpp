// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/bake.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "isograft/errors.h"
#include "isograft/frames.h"
#include "transfer/checks.h"
#include "transfer/margin.h"
#include "transfer/projection.h"
#include "transfer/raster.h"
#include "transfer/sampling.h"
#include "transfer/tangents.h"

namespace isograft {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Of the whole: finding and reading, then the margin.
constexpr double share_of_reading = 0.9;
constexpr int largest_image = 1 << 16;

void refuse(const std::string& text) { throw InvalidInput(text); }

void check_channel(const BakeChannel& channel, std::size_t index, Eigen::Index donor_faces,
                   const Eigen::VectorXi& materials) {
    const std::string name = "channel " + std::to_string(index);
    if (channel.components < 1 || channel.components > most_components) {
        refuse(name + " has " + std::to_string(channel.components) + " components, 1 to 4 are possible");
    }
    if (channel.is_normal && channel.components < 3) refuse(name + " is a normal map and has less than 3 components");
    check_corner_values(channel.uv, donor_faces, "the donor's UVs of " + name);
    if ((channel.bytes == nullptr) == (channel.reals == nullptr)) refuse(name + " must have one kind of result");
    for (const Pixels& image : channel.images) {
        if (image.empty()) continue;
        if (image.width < 1 || image.height < 1) refuse(name + " holds an image without pixels");
        if ((image.reals != nullptr) != (channel.reals != nullptr)) refuse(name + " mixes 8-bit and float images");
    }
    const auto count = static_cast<int>(channel.images.size());
    for (Eigen::Index f = 0; f < materials.rows(); ++f) {
        if (materials[f] >= 0 && materials[f] < count) continue;
        refuse("donor_materials is out of range in row " + std::to_string(f) + ": " + std::to_string(materials[f]) +
               ", " + name + " has images for " + std::to_string(count) + " materials");
    }
}

void check_receiver(const ReceiverMesh& receiver, const CornerUV& uv, const Mask& wanted) {
    check_corner_values(uv, receiver.faces.rows(), "receiver_uv");
    if (wanted.rows() != 0 && wanted.rows() != receiver.faces.rows()) {
        refuse("the receiver's mask has " + std::to_string(wanted.rows()) + " rows, expected " +
               std::to_string(receiver.faces.rows()) + ", one per triangle");
    }
}

// What turns a normal of the donor's tangent frames into the receiver's.
class NormalTurner {
  public:
    NormalTurner(const Correspondence& correspondence, const ReceiverMesh& receiver, const CornerUV& receiver_uv,
                 const DonorMesh& donor, int threads, Monitor& monitor)
        : receiver_(receiver),
          donor_(donor),
          own_(tangent_frames(receiver.vertices, receiver.faces, receiver_uv)),
          normals_(vertex_normals(receiver.vertices, receiver.faces)) {
        FrameOptions options;
        options.threads = threads;
        // Frames report no progress of their own here.
        Monitor silent;
        monitor.check();
        frames_ = local_frames(correspondence, receiver, donor, options, &silent);
        monitor.check();
    }

    // `value`: components in [0, 1].
    void turn(int f, const Vector3d& weights, const Place& place, const TangentFrames& donor, float* value) const {
        Matrix3d rotation = Matrix3d::Zero();
        Vector3d normal = Vector3d::Zero(), own = Vector3d::Zero(), there = Vector3d::Zero();
        for (int c = 0; c < 3; ++c) {
            const int v = receiver_.faces(f, c);
            rotation += weights[c] *
                        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(frames_.rotation.row(v).data());
            normal += weights[c] * normals_.row(v).transpose();
            own += weights[c] * own_.tangent.row(3 * f + c).transpose();
            there += place.weights[c] * donor.tangent.row(3 * place.face + c).transpose();
        }
        normal = normal.stableNormalized();
        const Vector3d a = donor_.vertices.row(donor_.faces(place.face, 0)).transpose();
        const Vector3d b = donor_.vertices.row(donor_.faces(place.face, 1)).transpose();
        const Vector3d c = donor_.vertices.row(donor_.faces(place.face, 2)).transpose();
        // Surfaces of opposite winding have opposite normals.
        const bool opposite = normal.dot(rotation * (b - a).cross(c - a)) < 0.0;
        const Vector3d across = normal.cross(own);
        const Vector3d came = rotation * there;
        double cosine = came.dot(own), sine = came.dot(across);
        const double length = std::hypot(cosine, sine);
        if (!(length > 1e-6)) return;
        cosine /= length;
        sine /= length;
        const double side = donor.handedness[place.face] * (opposite ? -1.0 : 1.0);
        const double x = 2.0 * value[0] - 1.0, y = side * (2.0 * value[1] - 1.0);
        value[0] = static_cast<float>(0.5 + 0.5 * (cosine * x - sine * y));
        value[1] = static_cast<float>(0.5 + 0.5 * own_.handedness[f] * (sine * x + cosine * y));
    }

  private:
    const ReceiverMesh& receiver_;
    const DonorMesh& donor_;
    TangentFrames own_;
    Points normals_;
    LocalFrames frames_;
};

// A channel, and what reading it needs.
struct Reader {
    const BakeChannel& channel;
    TangentFrames frames{};

    void write(std::size_t texel, int f, const Vector3d& weights, const Place& place, int material,
               const NormalTurner* turner) const {
        const Pixels& image = channel.images[material];
        if (image.empty()) return;
        const Eigen::RowVector2d uv = place.weights.transpose() * channel.uv.middleRows<3>(3 * place.face);
        float value[most_components];
        read_pixels(image, channel.components, channel.extension, channel.closest, uv[0], uv[1], value);
        if (channel.is_normal) turner->turn(f, weights, place, frames, value);
        const std::size_t at = texel * channel.components;
        if (channel.reals != nullptr) {
            std::copy(value, value + channel.components, channel.reals + at);
            return;
        }
        for (int k = 0; k < channel.components; ++k) {
            channel.bytes[at + k] =
                static_cast<std::uint8_t>(std::clamp(std::floor(255.0F * value[k] + 0.5F), 0.0F, 255.0F));
        }
    }
};

struct Baker {
    const CornerUV& uv;
    const Eigen::VectorXi& materials;
    const BakeOptions& options;
    const Bands& bands;
    const std::vector<Reader>& readers;
    const NormalTurner* turner;
    std::uint8_t* mask;

    void bake_band(int band, Projection& projection) const {
        const int first_row = band * bands.rows;
        const int end_row = std::min(options.height, first_row + bands.rows);
        for (Eigen::Index i = bands.first[band]; i < bands.first[band + 1]; ++i) {
            const int f = bands.triangle[i];
            const TexelTriangle triangle(uv, f, options.width, options.height);
            projection.enter(f);
            for (int y = std::max(first_row, triangle.first_row()); y < std::min(end_row, triangle.end_row()); ++y) {
                bake_span(f, y, triangle.span(y), projection);
            }
        }
    }

    void bake_span(int f, int y, const Span& span, Projection& projection) const {
        // Where a row starts does not depend on the rows before.
        projection.restart();
        for (int x = span.from; x < span.to; ++x) {
            const std::size_t texel = static_cast<std::size_t>(y) * options.width + x;
            if (mask[texel] == static_cast<std::uint8_t>(Texel::baked)) continue;
            Vector3d weights = (span.at + x * span.step).cwiseMax(0.0);
            weights /= weights.sum();
            const Place place = projection.find(weights);
            for (const Reader& reader : readers) {
                reader.write(texel, f, weights, place, materials[place.face], turner);
            }
            mask[texel] = static_cast<std::uint8_t>(Texel::baked);
        }
    }
};

}  // namespace

void BakeOptions::validate() const {
    const auto check = [](const char* field, int value, int low, int high) {
        if (value >= low && value <= high) return;
        refuse(std::string(field) + " must be from " + std::to_string(low) + " to " + std::to_string(high) + ", got " +
               std::to_string(value));
    };
    check("width", width, 1, largest_image);
    check("height", height, 1, largest_image);
    check("margin", margin, 0, 1024);
    check("threads", threads, 0, std::numeric_limits<int>::max());
}

Mask bake(const Correspondence& correspondence, const ReceiverMesh& receiver, const CornerUV& receiver_uv,
          const Mask& wanted, const DonorMesh& donor, const Eigen::VectorXi& materials,
          const std::vector<BakeChannel>& channels, const BakeOptions& options, std::uint8_t* mask, Monitor* monitor) {
    options.validate();
    const Eigen::VectorXi no_polygons;
    const ReceiverMesh alone{receiver.vertices, receiver.faces, no_polygons};
    const CornerValues no_values = no_corner_values(donor.faces);
    check_placement(correspondence, alone, donor, no_values);
    check_receiver(receiver, receiver_uv, wanted);
    if (materials.rows() != donor.faces.rows()) {
        refuse("donor_materials has " + std::to_string(materials.rows()) + " rows, expected " +
               std::to_string(donor.faces.rows()) + ", one per triangle of the donor");
    }
    for (std::size_t i = 0; i < channels.size(); ++i) check_channel(channels[i], i, donor.faces.rows(), materials);
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.check();

    const DonorView view(donor, no_values, 0.0);
    watched.check();
    const ReceiverImages images(correspondence, alone, view);
    watched.check();
    const Points normals = image_normals(images);
    std::vector<Reader> readers;
    bool any_normals = false;
    for (const BakeChannel& channel : channels) {
        readers.push_back({channel});
        if (!channel.is_normal) continue;
        any_normals = true;
        readers.back().frames = tangent_frames(donor.vertices, donor.faces, channel.uv);
        watched.check();
    }
    std::optional<NormalTurner> turner;
    if (any_normals) turner.emplace(correspondence, alone, receiver_uv, donor, options.threads, watched);
    std::vector<char> used(receiver.faces.rows(), 0);
    for (std::size_t f = 0; f < used.size(); ++f) {
        const auto row = static_cast<Eigen::Index>(f);
        used[f] = images.extent[f] < infinity && (wanted.rows() == 0 || wanted[row]) ? 1 : 0;
    }
    const Bands bands = make_bands(receiver_uv, used, options.width, options.height);
    std::memset(mask, 0, static_cast<std::size_t>(options.width) * options.height);

    const Baker baker{receiver_uv, materials, options, bands, readers, turner ? &*turner : nullptr, mask};
    std::vector<std::unique_ptr<Projection>> projections(worker_count(options.threads));
    const auto read = [&](int band, int worker) {
        if (!projections[worker]) projections[worker] = std::make_unique<Projection>(view, images, normals);
        baker.bake_band(band, *projections[worker]);
    };
    parallel_for(bands.count(), options.threads, read, watched, "bake", 0.0, share_of_reading);
    const auto copy = [&](std::size_t from, std::size_t to) {
        for (const BakeChannel& channel : channels) copy_texel(channel, channel.components, from, to);
    };
    dilate_bands(bands, mask, options, copy, watched, share_of_reading, 1.0);
    return Eigen::Map<const Eigen::Array<char, Eigen::Dynamic, 1>>(used.data(), receiver.faces.rows()).cast<bool>();
}

}  // namespace isograft
