// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "isograft/monitor.h"
#include "isograft/transfer.h"

namespace isograft {

/// Pixels of 8 bits or of single precision, rows from the bottom (v = 0) up, components side by side. One of the two
/// pointers is set. Not owned.
struct Pixels {
    const std::uint8_t* bytes = nullptr;
    const float* reals = nullptr;
    int width = 0;
    int height = 0;

    [[nodiscard]] bool empty() const { return bytes == nullptr && reals == nullptr; }
};

/// What lies beyond the borders of an image.
enum class Extension {
    repeat,
    extend,  ///< the border's pixels
    clip,    ///< zeros
};

/// One image-textured property of the donor's materials, and the image that it is baked into.
struct BakeChannel {
    /// One per material; empty = the texel is left as it is. An image of 1 by 1 pixels is a constant.
    std::vector<Pixels> images;
    int components = 4;
    /// 3 #F(donor) by 2.
    CornerUV uv;
    Extension extension = Extension::repeat;
    /// Read the pixel under the point rather than between four.
    bool closest = false;
    /// Components 0 to 2 are a normal in the tangent frame of `uv`, 0.5 standing for 0.
    bool is_normal = false;
    /// BakeOptions::height by width by components, of the images' type; what is not baked keeps its value. Not owned.
    std::uint8_t* bytes = nullptr;
    float* reals = nullptr;
};

/// Options of bake().
struct BakeOptions {
    int width = 1024;
    int height = 1024;
    /// Texels around what is baked that take the nearest baked one's value.
    int margin = 16;
    /// Worker threads; 0 takes all cores. The result does not depend on it.
    int threads = 0;

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

/// The meaning of a texel of the mask that bake() and paint() write.
enum class Texel : std::uint8_t { nothing = 0, baked = 1, margin = 2, filled = 3 };

/// Bake the donor's images into the receiver's UVs.
///
/// Every texel whose centre lies in a receiver triangle is the point of the flat image of that triangle with the same
/// weights, moved along the interpolated normals of the images to the donor's surface: a walk from triangle to
/// triangle, continuous across the receiver's edges, that does not see the donor's seams. Where the walk ends nowhere
/// (a border, a fold), the nearest point of the triangles near by. Then the donor's UVs and a bilinear read. Normals
/// are turned from the donor's tangent frames (as of MikkTSpace) to the receiver's by the local rotation between the
/// surfaces, UVs of both may be mirrored. Where receiver triangles overlap in UV, the first has the texel; what lies
/// outside of the unit square is not baked. Nothing is baked in triangles that are unmatched or torn (see
/// place_corners()). O(texels + #F); memory beyond the results is O(#F).
/// \param receiver_uv 3 #F(receiver) by 2. \param wanted #F(receiver): which triangles, or empty for all.
/// \param materials #F(donor): index into BakeChannel::images. \param mask height by width of Texel.
/// \param monitor may be null.
/// \return #F(receiver): the triangles that were baked, in whatever texels they have.
/// \throw InvalidInput on sizes, indices or values that do not fit; Cancelled, with some texels written.
Mask bake(const Correspondence& correspondence, const ReceiverMesh& receiver, const CornerUV& receiver_uv,
          const Mask& wanted, const DonorMesh& donor, const Eigen::VectorXi& materials,
          const std::vector<BakeChannel>& channels, const BakeOptions& options, std::uint8_t* mask,
          Monitor* monitor = nullptr);

}  // namespace isograft
