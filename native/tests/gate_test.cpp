// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/gate.h"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "clouds.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

SurfaceParts mesh(const std::string& name, const shapes::Shape& shape) { return {name, shape.vertices, shape.faces}; }

std::vector<SurfaceParts> three() {
    std::vector<SurfaceParts> parts{mesh("body", shapes::blob(3)), {}, mesh("ring", shapes::torus(40, 20, 1.0, 0.4))};
    parts[1].vertices = clouds::sampled(clouds::sphere(), 800, 0.1, 1);
    parts[1].is_cloud = true;
    return parts;
}

TEST(MakeSurfaces, AreTheSameInTheSameOrderForAnyNumberOfThreads) {
    const std::vector<Surface> one = make_surfaces(three(), 1);
    ASSERT_EQ(one.size(), 3U);
    EXPECT_EQ(one[0].vertices(), shapes::blob(3).vertices);
    for (const int threads : {2, 3}) {
        const std::vector<Surface> many = make_surfaces(three(), threads);
        ASSERT_EQ(many.size(), one.size());
        for (std::size_t i = 0; i < one.size(); ++i) {
            EXPECT_EQ(many[i].mesh().position, one[i].mesh().position);
            EXPECT_EQ(many[i].mesh().face, one[i].mesh().face);
            EXPECT_EQ(many[i].warnings(), one[i].warnings());
        }
    }
}

TEST(MakeSurfaces, TellProgressFromTheirOwnThreadThatEndsAtOne) {
    double last = 0.0;
    Monitor monitor([&](const std::string& stage, double fraction) {
        EXPECT_EQ(stage, "surface");
        EXPECT_GE(fraction, last);
        last = fraction;
        return true;
    });
    make_surfaces(three(), 2, &monitor);
    EXPECT_EQ(last, 1.0);
    monitor.cancel();
    EXPECT_THROW(make_surfaces(three(), 2, &monitor), Cancelled);
}

TEST(MakeSurfaces, SayWhichOfThemIsRefused) {
    for (const int threads : {1, 2}) {
        std::vector<SurfaceParts> parts = three();
        parts[1].vertices.conservativeResize(49, 3);
        parts[2].faces(0, 0) = -1;
        try {
            make_surfaces(std::move(parts), threads);
            FAIL();
        } catch (const InvalidInput& error) {
            // The cloud has no name.
            EXPECT_EQ(std::string(error.what()).find("body"), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("49 rows"), std::string::npos) << error.what();
        }
        parts = three();
        parts[2].faces(0, 0) = -1;
        try {
            make_surfaces(std::move(parts), threads);
            FAIL();
        } catch (const InvalidInput& error) {
            EXPECT_EQ(std::string(error.what()).find("ring: "), 0U) << error.what();
        }
    }
}

}  // namespace
}  // namespace isograft
