// SPDX-License-Identifier: GPL-3.0-or-later
#include "scale/setting.h"

#include <cmath>

#include <gtest/gtest.h>

#include "gate.h"
#include "scale/find_scale.h"
#include "shapes.h"

namespace isograft {
namespace {

double scale_found(const shapes::Shape& source, const shapes::Shape& target) {
    MatchOptions options;
    MatchReport report;
    Monitor monitor;
    return prepare_pair(gate(source), gate(target), options, report, monitor, 0.0, 1.0).setting.scale;
}

const shapes::Shape& body() {
    static const shapes::Shape shape = shapes::blob(3);
    return shape;
}

/// The body with holes all over it, the more and the larger ones the lower `level`.
shapes::Shape holed(double frequency, double phase, double level) {
    return shapes::cut(body(), [&](const Eigen::Vector3d& x) {
        const Eigen::Array3d wave = (frequency * x.array() + phase).sin();
        return wave.x() * std::sin(frequency * x.y() + phase + 1.0) + wave.z() < level;
    });
}

shapes::Shape moved(const shapes::Shape& shape) { return shapes::moved(shape, shapes::some_rotation(), {1, 2, 3}); }

TEST(Setting, FindsACommonUnitEitherWayWhereVotesOfTheWholeGoAstray) {
    const shapes::Shape ragged = moved(holed(13.0, 0.0, 1.1));
    Monitor monitor;
    const ScaleVotes astray =
        vote_scale(gate(body()).mesh_with_paths(), gate(ragged).mesh_with_paths(), {}, {}, 4, 2, monitor, 0.0, 1.0);
    ASSERT_GT(std::abs(std::log(astray.by_fit)), 0.5);
    EXPECT_DOUBLE_EQ(scale_found(ragged, body()), 1.0);
    EXPECT_DOUBLE_EQ(scale_found(body(), ragged), 1.0);
}

TEST(Setting, KeepsACommonUnitWhereHolesOnBothSidesMakeAnotherFitALittleBetter) {
    const shapes::Shape one = holed(7.0, 0.0, 0.7), other = moved(holed(8.4, 0.7, 0.7));
    Monitor monitor;
    const ScaleVotes astray =
        vote_scale(gate(one).mesh_with_paths(), gate(other).mesh_with_paths(), {}, {}, 4, 2, monitor, 0.0, 1.0);
    ASSERT_GT(std::abs(std::log(astray.by_fit)), 0.5);
    EXPECT_DOUBLE_EQ(scale_found(one, other), 1.0);
}

TEST(Setting, GivesACommonUnitUpForAnotherThatFitsClearlyBetter) {
    for (const double factor : {0.7, 1.4}) {
        const shapes::Shape one = holed(13.0, 0.0, 1.5);
        shapes::Shape other = moved(holed(15.6, 0.7, 1.5));
        other.vertices *= factor;
        EXPECT_NEAR(std::log(scale_found(one, other) / factor), 0.0, 0.05);
    }
}

}  // namespace
}  // namespace isograft
