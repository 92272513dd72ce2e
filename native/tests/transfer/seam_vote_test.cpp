// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/seam_vote.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"

namespace isograft {
namespace {

// The unit square in steps x steps cells of two triangles, and a map into it.
struct Grid {
    int steps;
    Points vertices;
    Triangles faces;

    explicit Grid(int n) : steps(n), vertices((n + 1) * (n + 1), 3), faces(2 * n * n, 3) {
        for (int i = 0; i <= n; ++i) {
            for (int j = 0; j <= n; ++j) vertices.row(i * (n + 1) + j) << double(i) / n, double(j) / n, 0.0;
        }
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                const int a = i * (n + 1) + j, b = a + n + 1;
                faces.row(2 * (i * n + j)) << a, b, b + 1;
                faces.row(2 * (i * n + j) + 1) << a, b + 1, a + 1;
            }
        }
    }

    // Point (x, y) as a triangle and weights.
    void place(double x, double y, int row, Correspondence& map) const {
        const double u = std::clamp(x, 0.0, 1.0) * steps, v = std::clamp(y, 0.0, 1.0) * steps;
        const int i = std::min(steps - 1, static_cast<int>(u)), j = std::min(steps - 1, static_cast<int>(v));
        const double s = u - i, t = v - j;
        const bool lower = s >= t;
        map.face[row] = 2 * (i * steps + j) + (lower ? 0 : 1);
        if (lower) map.barycentric.row(row) << 1.0 - s, s - t, t;
        if (!lower) map.barycentric.row(row) << 1.0 - t, s, t - s;
        map.vertex[row] = faces(map.face[row], 0);
    }

    // Two islands, left and right of the middle.
    [[nodiscard]] CornerValues halves() const {
        CornerValues uv(3 * faces.rows(), 2);
        for (int f = 0; f < faces.rows(); ++f) {
            const double middle =
                (vertices(faces(f, 0), 0) + vertices(faces(f, 1), 0) + vertices(faces(f, 2), 0)) / 3.0;
            for (int c = 0; c < 3; ++c) {
                uv.row(3 * f + c) = vertices.row(faces(f, c)).head<2>();
                if (middle > 0.5) uv(3 * f + c, 0) += 5.0;
            }
        }
        return uv;
    }
};

struct Scene {
    Grid donor{16};
    Grid receiver;
    CornerValues uv = donor.halves();
    Correspondence map;
    Eigen::VectorXi none;

    // \param jitter how far the map errs, in edges of the receiver.
    Scene(int steps, double jitter) : receiver(steps) {
        const Eigen::Index count = receiver.vertices.rows();
        map.face.resize(count);
        map.vertex.resize(count);
        map.barycentric.resize(count, 3);
        std::mt19937 random(1);
        std::uniform_real_distribution<double> draw(-jitter / steps, jitter / steps);
        for (int i = 0; i < count; ++i) {
            const double dx = draw(random), dy = draw(random);
            donor.place(receiver.vertices(i, 0) + dx, receiver.vertices(i, 1) + dy, i, map);
        }
    }

    struct Read {
        std::vector<Place> places;
        std::vector<int> asked;
        double seam = 0.0;
    };

    [[nodiscard]] Read read(int sweeps, Monitor& monitor) const {
        const DonorView view({donor.vertices, donor.faces}, uv, 1e-6);
        const ReceiverMesh mesh{receiver.vertices, receiver.faces, none};
        const ReceiverImages images(map, mesh, view);
        PatchReader reader(view, 1.0);
        Read result;
        result.places.resize(3 * receiver.faces.rows());
        std::vector<int> root(receiver.faces.rows(), -1);
        for (int f = 0; f < receiver.faces.rows(); ++f) {
            const PolygonCorners corners = polygon_corners(images, f);
            std::vector<Place> places;
            EXPECT_TRUE(reader.read(corners.images, corners.centre, places));
            for (int c = 0; c < 3; ++c) {
                for (std::size_t i = 0; i < places.size(); ++i) {
                    if (corners.vertices[i] == receiver.faces(f, c)) result.places[3 * f + c] = places[i];
                }
            }
            root[f] = reader.root();
            if (reader.parted()) result.asked.push_back(f);
        }
        vote_on_seams(images, view, result.asked, reader, result.places, root, monitor, sweeps);
        result.seam = seam(view, result.places);
        return result;
    }

    // Length of the receiver's edges along which the islands part.
    [[nodiscard]] double seam(const DonorView& view, const std::vector<Place>& places) const {
        std::vector<int> island;
        for (const Place& place : places) island.push_back(view.graph.island[place.face]);
        double sum = 0.0;
        for (int f = 0; f < receiver.faces.rows(); ++f) {
            for (int g = 0; g < f; ++g) {
                if (island[3 * f] == island[3 * g]) continue;
                std::vector<int> shared;
                for (const int v : receiver.faces.row(f)) {
                    if ((receiver.faces.row(g).array() == v).any()) shared.push_back(v);
                }
                if (shared.size() != 2) continue;
                sum += (receiver.vertices.row(shared[0]) - receiver.vertices.row(shared[1])).norm();
            }
        }
        return sum;
    }
};

TEST(SeamVote, ChangesNothingWhereSeamsRunAlongEdges) {
    Monitor monitor;
    const Scene scene(16, 0.0);
    const auto alone = scene.read(0, monitor), voted = scene.read(4, monitor);
    for (std::size_t i = 0; i < alone.places.size(); ++i) EXPECT_EQ(alone.places[i].face, voted.places[i].face);
    EXPECT_DOUBLE_EQ(voted.seam, 1.0);
}

TEST(SeamVote, ShortensTheSeamOfANoisyMap) {
    Monitor monitor;
    const Scene scene(23, 0.4);
    const auto alone = scene.read(0, monitor), voted = scene.read(4, monitor);
    EXPECT_GT(alone.seam, 1.3);
    EXPECT_LT(voted.seam, 0.95 * alone.seam);
    EXPECT_GE(voted.seam, 1.0);
}

TEST(SeamVote, ChangesOnlyPolygonsThatASeamRunsThrough) {
    Monitor monitor;
    const Scene scene(23, 0.4);
    const auto alone = scene.read(0, monitor), voted = scene.read(4, monitor);
    std::vector<char> asked(scene.receiver.faces.rows(), 0);
    for (const int f : alone.asked) asked[f] = 1;
    int changed = 0;
    for (std::size_t i = 0; i < alone.places.size(); ++i) {
        if (alone.places[i].face == voted.places[i].face) continue;
        ++changed;
        EXPECT_TRUE(asked[i / 3]);
    }
    EXPECT_GT(changed, 0);
}

TEST(SeamVote, HasComeToRestAfterAFewSweeps) {
    Monitor monitor;
    const Scene scene(23, 0.4);
    const auto few = scene.read(4, monitor), many = scene.read(50, monitor);
    for (std::size_t i = 0; i < few.places.size(); ++i) EXPECT_EQ(few.places[i].face, many.places[i].face);
}

TEST(SeamVote, StopsWhenCancelled) {
    Monitor monitor;
    const Scene scene(23, 0.4);
    monitor.cancel();
    EXPECT_THROW(scene.read(4, monitor), Cancelled);
}

}  // namespace
}  // namespace isograft
