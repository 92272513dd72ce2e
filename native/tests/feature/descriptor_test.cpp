// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/descriptor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "feature/curvature.h"
#include "gate.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

const FeatureOptions options;
constexpr double unit_length = 2.0;

struct Described {
    TriangleMesh mesh;
    std::vector<double> curvature;

    explicit Described(const shapes::Shape& shape) : mesh(shapes::mesh_of(shape)) {
        curvature = mean_curvature(mesh, 0.005);
    }
    [[nodiscard]] PolarDescriptor window(const SurfacePoint& p) const {
        Window window(mesh);
        return window_descriptor(mesh, window, p, curvature, unit_length, options);
    }
    [[nodiscard]] PolarDescriptor rays(const SurfacePoint& p, double phase = 0.0) const {
        return ray_descriptor(mesh, p, curvature, options.radius * unit_length, unit_length, phase, options);
    }
};

SurfacePoint centroid(int face) {
    SurfacePoint p;
    p.face = face;
    return p;
}

double at(const std::array<float, 2 * descriptor_cells>& values, int ring, int angle) {
    return values[ring * 2 * descriptor_angles + (angle + descriptor_angles) % descriptor_angles];
}

void expect_near(const PolarDescriptor& a, const PolarDescriptor& b, double tolerance, int shift = 0) {
    for (int r = 0; r < descriptor_rings; ++r) {
        EXPECT_NEAR(a.ring[r], b.ring[r], tolerance);
        for (int k = 0; k < descriptor_angles; ++k) {
            EXPECT_NEAR(at(a.cell, r, k), at(b.cell, r, k + shift), tolerance);
            EXPECT_EQ(at(a.seen, r, k), at(b.seen, r, k + shift));
        }
    }
}

void expect_equal(const DescriptorValues& a, const DescriptorValues& b, double tolerance) {
    for (int r = 0; r < descriptor_rings; ++r) EXPECT_NEAR(a.ring[r], b.ring[r], tolerance);
    for (int c = 0; c < descriptor_cells; ++c) EXPECT_NEAR(a.cell[c], b.cell[c], tolerance);
    EXPECT_EQ(a.seen, b.seen);
}

TEST(Descriptor, IsNearestToItselfAtNoShiftAndElsewhereFarther) {
    const Described blob(shapes::blob(5));
    std::vector<PolarDescriptor> d;
    for (int f = 0; f < blob.mesh.face_count(); f += 1024) d.push_back(blob.window(centroid(f)));
    for (std::size_t i = 0; i < d.size(); ++i) {
        EXPECT_EQ(best_shift(d[i], d[i], options).shift, 0);
        EXPECT_EQ(best_shift(d[i], d[i], options).distance, 0.0);
        EXPECT_EQ(ring_distance(d[i], d[i]), 0.0);
        for (std::size_t j = 0; j < i; ++j) EXPECT_GT(best_shift(d[i], d[j], options).distance, 1e-6);
    }
}

TEST(Descriptor, TurnsWithTheFrameByWholeSectors) {
    const Described blob(shapes::blob(5));
    for (const int shift : {1, 5, 12, 23}) {
        for (int f = 7; f < blob.mesh.face_count(); f += 3000) {
            const PolarDescriptor plain = blob.rays(centroid(f));
            const PolarDescriptor turned = blob.rays(centroid(f), -2.0 * M_PI * shift / descriptor_angles);
            // Rays at the same places: direction k of the first is direction k + shift of the second.
            expect_near(plain, turned, 1e-6, shift);
            const BestShift best = best_shift(plain, turned, options);
            EXPECT_EQ(best.shift, shift);
            EXPECT_LT(best.distance, 1e-10);
        }
    }
}

TEST(Descriptor, ShiftFindsTheRotationBetweenFrames) {
    // The same point in the frames of its triangle's three corners, which renumbering turns.
    const auto shape = shapes::blob(5);
    const auto other = shapes::renumbered(shape, 21);
    const Described a(shape), b(other.shape);
    int right = 0, count = 0;
    for (int f = 3; f < a.mesh.face_count(); f += 700) {
        const SurfacePoint p = centroid(f), q = shapes::same_point(other, p);
        const Complex turn = flatten(b.mesh, q.face, a.mesh.axis_x[p.face]);
        for (const bool window : {false, true}) {
            const PolarDescriptor da = window ? a.window(p) : a.rays(p), db = window ? b.window(q) : b.rays(q);
            ++count;
            right += std::abs(std::arg(rotation_of(best_shift(da, db, options).shift) * std::conj(turn))) <
                     2.0 * M_PI / descriptor_angles;
        }
    }
    EXPECT_GE(right, count - 1);
}

TEST(Descriptor, ShiftAndRotationAreEachOthersInverse) {
    for (int s = 0; s < descriptor_angles; ++s) {
        EXPECT_EQ(shift_of(rotation_of(s)), s);
        EXPECT_EQ(shift_of(rotation_of(s) * std::polar(1.0, 0.4 * 2.0 * M_PI / descriptor_angles)), s);
    }
}

TEST(Descriptor, IsTheSameAfterRigidMotionAndRenumbering) {
    const auto shape = shapes::blob(4);
    const auto other = shapes::renumbered(shape, 22);
    const Described a(shape), b(shapes::moved(other.shape, shapes::some_rotation(), {3, 2, 1}));
    Window a_window(a.mesh), b_window(b.mesh);
    int count = 0;
    for (int f = 11; f < a.mesh.face_count(); f += 100) {
        if (other.first_corner[f] != 0) continue;  // another frame: the test above
        const SurfacePoint p = centroid(f), q = shapes::same_point(other, p);
        ++count;
        expect_equal(window_values(a.mesh, a_window, p, a.curvature, unit_length, options),
                     window_values(b.mesh, b_window, q, b.curvature, unit_length, options), 1e-9);
        const double radius = options.radius * unit_length;
        expect_equal(ray_values(a.mesh, p, a.curvature, radius, unit_length, 0.3, options),
                     ray_values(b.mesh, q, b.curvature, radius, unit_length, 0.3, options), 1e-9);
    }
    EXPECT_GT(count, 10);
}

TEST(Descriptor, IsStoredAsNearAsSinglePrecisionComes) {
    const Described blob(shapes::blob(4));
    Window window(blob.mesh);
    for (int f = 11; f < blob.mesh.face_count(); f += 400) {
        const DescriptorValues values =
            window_values(blob.mesh, window, centroid(f), blob.curvature, unit_length, options);
        const PolarDescriptor stored = packed(values);
        EXPECT_EQ(stored.cell, blob.window(centroid(f)).cell);
        for (int r = 0; r < descriptor_rings; ++r) {
            EXPECT_FLOAT_EQ(stored.ring[r], static_cast<float>(values.ring[r]));
            for (int k = 0; k < 2 * descriptor_angles; ++k) {
                const int c = r * descriptor_angles + k % descriptor_angles;
                EXPECT_EQ(stored.cell[r * 2 * descriptor_angles + k], static_cast<float>(values.cell[c]));
                EXPECT_EQ(stored.seen[r * 2 * descriptor_angles + k] > 0.5F, values.seen[c]);
            }
        }
    }
}

TEST(Descriptor, ScalesWithTheUnitLength) {
    const auto shape = shapes::blob(4);
    const Described a(shape);
    const TriangleMesh large = scaled(a.mesh, 37.0);
    const auto curvature = mean_curvature(large, 0.005 * 37.0 * 37.0);
    Window window(large);
    for (int f = 11; f < a.mesh.face_count(); f += 500) {
        expect_near(a.window(centroid(f)),
                    window_descriptor(large, window, centroid(f), curvature, 37.0 * unit_length, options), 1e-6);
    }
}

TEST(Descriptor, OfASphereHasTheSameCurvatureInEveryCellAndLessAreaInTheOuterRings) {
    const Described ball(shapes::sphere(5));
    const double radius = options.radius * unit_length;
    for (int f = 0; f < ball.mesh.face_count(); f += 2000) {
        const PolarDescriptor d = ball.window(centroid(f));
        EXPECT_TRUE(d.whole);
        EXPECT_NEAR(d.visible, 1.0, 1e-6);
        for (int r = 0; r < descriptor_rings; ++r) {
            for (int k = 0; k < descriptor_angles; ++k) {
                EXPECT_NEAR(at(d.cell, r, k), std::atan(options.squash * unit_length), 2e-3);
            }
            if (r == 0) continue;
            // A ring's weights make a hat over three ring widths: the mean of sin(x) / x at its middle, nearly.
            const double x = (r + 0.5) / descriptor_rings * radius;
            EXPECT_NEAR(d.ring[r], std::sin(x) / x, 0.03);
        }
    }
}

TEST(Descriptor, OfAWindowAndOfRaysAreAlike) {
    const Described blob(shapes::blob(5));
    double same = 0.0, different = 0.0;
    int count = 0;
    for (int f = 5; f + 5000 < blob.mesh.face_count(); f += 600) {
        const PolarDescriptor d = blob.window(centroid(f));
        same += descriptor_distance(d, blob.rays(centroid(f)), 0, options);
        different += best_shift(d, blob.rays(centroid(f + 5000)), options).distance;
        ++count;
    }
    EXPECT_LT(same, 0.05 * different);
}

TEST(Descriptor, HiddenSectorDoesNotChangeTheVisibleCells) {
    const auto shape = shapes::blob(5);
    const Described whole(shape);
    const int face = 9000;
    const Eigen::Vector3d x = position(whole.mesh, centroid(face));
    const Eigen::Vector3d side = whole.mesh.axis_y[face];
    // Everything farther than a quarter of the radius to one side is gone.
    const double near = 0.25 * options.radius * unit_length;
    const auto cut = shapes::cut(shape, [&](const Eigen::Vector3d& c) { return (c - x).dot(side) < near; });
    const Surface surface = gate(cut);
    const TriangleMesh& mesh = surface.mesh_with_paths();
    const auto found = std::find_if(mesh.input_face.begin(), mesh.input_face.end(),
                                    [&](int f) { return cut.faces.row(f) == shape.faces.row(face); });
    ASSERT_NE(found, mesh.input_face.end());
    std::vector<double> curvature(mesh.vertex_count());
    for (int v = 0; v < mesh.vertex_count(); ++v) curvature[v] = whole.curvature[mesh.input_vertex[v]];
    const SurfacePoint p = centroid(static_cast<int>(found - mesh.input_face.begin()));
    Window window(mesh);
    const PolarDescriptor a = whole.window(centroid(face));
    const PolarDescriptor b = window_descriptor(mesh, window, p, curvature, unit_length, options);
    const PolarDescriptor c =
        ray_descriptor(mesh, p, curvature, options.radius * unit_length, unit_length, 0.0, options);
    const PolarDescriptor r = whole.rays(centroid(face));
    EXPECT_FALSE(b.whole);
    EXPECT_LT(b.visible, 0.9);
    EXPECT_GT(b.visible, 0.5);
    int inner = 0;
    for (int ring = 0; ring < descriptor_rings; ++ring) {
        for (int k = 0; k < descriptor_angles; ++k) {
            if (at(c.seen, ring, k) > 0.0F) {
                EXPECT_EQ(at(c.cell, ring, k), at(r.cell, ring, k));
            }
            // Vertices are shared between neighbouring cells, so those beside hidden ones lose some; so may the last
            // ring, which shares with what lies beyond the window.
            bool clear = ring + 1 < descriptor_rings;
            for (int dr = -1; dr <= 1; ++dr) {
                for (int dk = -1; dk <= 1; ++dk) {
                    const int q = std::clamp(ring + dr, 0, descriptor_rings - 1);
                    clear = clear && at(b.seen, q, k + dk) > 0.0F;
                }
            }
            if (!clear) continue;
            ++inner;
            EXPECT_NEAR(at(a.cell, ring, k), at(b.cell, ring, k), 1e-6) << ring << " " << k;
        }
    }
    EXPECT_GT(inner, 60);
    EXPECT_EQ(best_shift(a, b, options).shift, 0);
    EXPECT_NEAR(descriptor_distance(a, b, 0, options), options.hidden_penalty * (1.0 - b.visible), 2e-4);
}

TEST(Descriptor, CannotBeComparedWhereTooLittleIsShared) {
    const Described blob(shapes::blob(4));
    PolarDescriptor a = blob.window(centroid(3)), b = a;
    b.whole = false;
    b.seen.fill(0.0F);
    EXPECT_EQ(descriptor_distance(a, b, 0, options), not_comparable);
    EXPECT_EQ(best_shift(a, b, options).distance, not_comparable);
}

TEST(Descriptor, OfManyPointsIsEqualBitForBitForAnyNumberOfThreads) {
    const Described blob(shapes::blob(4));
    std::vector<SurfacePoint> points;
    for (int f = 0; f < blob.mesh.face_count(); f += 50) points.push_back(centroid(f));
    const auto run = [&](int threads) {
        Monitor monitor;
        return window_descriptors(blob.mesh, points, blob.curvature, unit_length, options, threads, monitor, 0.0, 1.0);
    };
    const auto one = run(1), three = run(3);
    ASSERT_EQ(one.size(), points.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].cell, three[i].cell);
        EXPECT_EQ(one[i].seen, three[i].seen);
        EXPECT_EQ(one[i].ring, three[i].ring);
        EXPECT_EQ(one[i].cell, blob.window(points[i]).cell);
    }
    Monitor cancelled;
    cancelled.cancel();
    EXPECT_THROW(window_descriptors(blob.mesh, points, blob.curvature, unit_length, options, 2, cancelled, 0.0, 1.0),
                 Cancelled);
}

}  // namespace
}  // namespace isograft
